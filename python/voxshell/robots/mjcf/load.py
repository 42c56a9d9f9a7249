"""Loading an MJCF file into a world."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from voxshell.base.arguments import as_flag, as_text
from voxshell.base.calls import explain_calls
from voxshell.robots.assembly import Assembly, check_place
from voxshell.robots.description import shorten_names
from voxshell.robots.lumps import find_lumps
from voxshell.robots.matter import complete_matter
from voxshell.robots.mjcf.carriers import share_matter
from voxshell.robots.mjcf.frictionless import remove_frictions
from voxshell.robots.mjcf.keyframes import begin_at_keyframe
from voxshell.robots.mjcf.left_out import LeftOut
from voxshell.robots.mjcf.overlaps import keep_overlaps_apart
from voxshell.robots.mjcf.reading import read_mjcf
from voxshell.robots.robot_warning import warn_of_robot
from voxshell.robots.shapes import MeshSettings, Shaper
from voxshell.robots.starts import as_starts, begin_at

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from voxshell.robots.robot import Robot
    from voxshell.simulation.world import World


@explain_calls
def load_mjcf(
    world: World,
    path: str | os.PathLike[str],
    *,
    pose: ArrayLike | None = None,
    tolerance: float | None = None,
    voxel_size: float | None = None,
    resolution: int | None = None,
    mesh_as: Literal["model", "hull"] = "model",
    open: Literal["auto", "solid", "sheet"] = "auto",  # noqa: A002
    sheet_thickness: float | None = None,
    friction: float | None = None,
    self_collision: bool = True,
    positions: Mapping[str, float] | None = None,
    keyframe: str | None = None,
) -> Robot:
    """Add the bodies of an MJCF file, the XML format of MuJoCo, to a world.

    The result is one robot, even if the file has several root bodies, such as a table with objects:
    MuJoCo also compiles a file to one model, with unique names. Every body becomes a link of the
    same name. The link "world" is the content of ``<worldbody>`` itself: its planes, and bodies
    without joints in it, are static bodies. Elsewhere, a body without joints becomes part of the
    body that contains it. A body with several joints becomes a chain of links: joint "hip_x" moves
    "torso/hip_x", and the last joint moves "torso". Each link in between gets a tenth of the body's
    mass, such that masses, centers and inertias are MuJoCo's.

    Positions of joints are MuJoCo's ``qpos``, and all begin as in ``qpos0``, unless ``positions`` says otherwise; those whose ``ref`` is beyond
    their limits begin at the nearest limit, with a :class:`RobotWarning`. Bodies have the largest friction of
    their geoms; note that Bullet multiplies the frictions of two bodies, and MuJoCo takes the larger. A body whose
    contacts are all without friction (``condim="1"``) has friction 0, if it is static or meets another tree.
    Bodies of one tree that overlap from the beginning, by over 2 % of the smaller one, do not collide.
    Geoms whose ``contype`` and ``conaffinity`` are 0 are only seen, and have a mass as in MuJoCo.
    Actuators, tendons and equalities are not simulated; a :class:`RobotWarning` lists what the
    file has of them, and names another gravity or time step than the world's, which apply. Elements and attributes that MuJoCo does not know are
    refused.

    Args:
        world: The world.
        path: The file's path. Meshes and included files are searched relative to its folder, and to
            that of the file that names them.
        pose: ``world_from_file``, in any form that :func:`pose` lists; the identity by
            default.
        tolerance: Largest accepted error of the models, meters, such as 0.0002: see
            :meth:`Model.from_mesh`. By default models are uniform instead, because the first load then
            takes a half to an eighth of the time.
        voxel_size: Alternative to ``tolerance``: voxel size of uniform models, meters; at most a geom's
            longest side.
        resolution: Alternative to both: voxels along the longest side of each uniform model. The default
            is 100.
        mesh_as: "model" for any mesh as it is, or "hull" for its convex hull, which MuJoCo uses.
        open: How to treat meshes with open edges: closed as a "solid", as a "sheet" that collides from both
            sides, or by "auto", as described for :meth:`Model.from_mesh`.
        sheet_thickness: Thickness of sheets, meters. The default is a 200th of the longest side, and at
            least two voxels; for meshes that lie in a plane, at most 5 mm.
        friction: Coulomb's coefficient of all bodies, instead of the file's.
        self_collision: Let the bodies of one tree collide with each other, as the file specifies.
            Those of different trees can always collide.
        positions: Positions at which hinges and slides begin, radians, even if the file states degrees,
            or meters, by name.
        keyframe: The name of a ``<key>`` of the file, in whose ``qpos`` all joints begin, free bodies
            and balls, too, except those in ``positions``. Positions beyond limits begin at the nearest
            limit, with a :class:`RobotWarning`. The rest of a keyframe is not read.

    Returns:
        The robot.

    Raises:
        MissingFileError: The file does not exist.
        FileAccessError: The file cannot be read.
        MissingExtraError: An inertia must be computed from a convex hull and scipy is not
            installed.
        RobotError: The file cannot be simulated; the message names the file, the line, the body or
            geom, and a remedy.
        SettingsError: A setting is out of range. Or ``positions`` names an unknown joint, or is
            beyond its limits. Or the file has no such ``keyframe``.
        PoseError: ``pose`` is in no form that :func:`pose` lists, is not rigid, or is not finite.
        MemoryLimitError: A model would be too large.
        InputTypeError: ``world`` is not a world, or ``path`` is not a path, or ``keyframe`` is not a
            text, or ``positions`` does not map names to numbers.

    Warns:
        RobotWarning: The file contains something that is not simulated, or lacks a mass. Or meshes have
            faults, models miss their tolerance, or a ``ref`` is beyond limits. The message lists it.
        MeshWarning: A mesh without a scale is longer than 10 m, and its file states no unit.

    After an exception, the world has none of the file's bodies.

    Example:
        >>> import pathlib, tempfile
        >>> import voxshell as vx
        >>> text = '''
        ... <mujoco model="table">
        ...   <worldbody>
        ...     <geom name="floor" type="plane" size="1 1 0.1"/>
        ...     <body name="door" pos="0 0 0.5">
        ...       <joint name="hinge" axis="0 0 1" range="0 90" damping="0.1"/>
        ...       <geom type="box" pos="0.2 0 0" size="0.2 0.01 0.4"/>
        ...     </body>
        ...     <body name="ball" pos="0 0.5 0.3"><freejoint/><geom size="0.1"/></body>
        ...   </worldbody>
        ... </mujoco>'''
        >>> world = vx.World()
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     path = pathlib.Path(folder, "table.xml")
        ...     _ = path.write_text(text)
        ...     robot = vx.load_mjcf(world, path)
        >>> list(robot.links)
        ['world/floor', 'world', 'door', 'ball']
        >>> robot.set_targets({"hinge": 1.0}, max_force=20.0)
        >>> world.step(400)
        >>> round(robot.positions["hinge"], 2)
        1.0
        >>> round(float(robot.links["ball"].pose[2, 3]), 2)
        0.1
    """
    world_from_file = check_place(world, pose, 0.5 if friction is None else friction)
    as_flag(self_collision, "self_collision")
    starts = as_starts(positions)
    settings = MeshSettings(voxel_size, resolution, mesh_as, tolerance, open, sheet_thickness)
    model = read_mjcf(path, world.gravity, world.time_step)
    robot, filters = model.robot, model.filters
    if keyframe is not None:
        begin_at_keyframe(robot, model.root, as_text(keyframe, "keyframe"))
    begin_at(robot, starts)
    lump_of = find_lumps(robot)
    lumps = list(dict.fromkeys(lump_of.values()))
    static = {lump_of[root] for root in robot.roots}
    carriers = {lump_of[name] for name in model.carriers}
    matter = complete_matter(robot, (it for it in lumps if it not in static | carriers))
    share_matter(matter, model.carriers, lump_of)
    shaper = Shaper(robot, settings)
    shapes = {lump: shaper.shape_of(lump) for lump in lumps}
    meeting = [lump for lump, shape in shapes.items() if shape is not None]
    pairs = filters.sort_pairs(lump_of, static, meeting)
    apart, own = pairs.apart, [it.lumps for it in pairs.meetings if it.is_own]
    if not self_collision:
        apart = apart + own
    left_out = LeftOut()
    for pair in filters.find_lost_pairs():
        left_out.note("<pair> of geoms that are not there, or not read", pair.place)
    if friction is None:
        met = [it for it in pairs.meetings if self_collision or not it.is_own]
        remove_frictions(robot, filters, met, static, left_out)
    robot.left_out.extend(left_out.list())
    assembly = Assembly(
        robot,
        lump_of,
        matter,
        shapes,
        world_from_file,
        friction=friction,
        apart=apart,
        joints_collide=True,
    )
    made = assembly.add(world)
    if self_collision:
        bodies = {lump: made.links[lump.first].body for lump in meeting}
        pairs = ((bodies[a], bodies[b]) for a, b in own)
        try:
            found = keep_overlaps_apart(world, ((a, b) for a, b in pairs if a and b))
        except BaseException:  # also an interrupt: large models take long
            made.remove()
            raise
        if found:
            robot.left_out.append(
                f"collisions of links that overlap at the start ({shorten_names(found)})"
            )
    warn_of_robot(robot, matter)
    return made
