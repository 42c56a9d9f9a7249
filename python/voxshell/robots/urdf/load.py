"""Loading a URDF file into a world."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, Literal

from voxshell.base.arguments import as_choice, as_flag
from voxshell.base.calls import explain_calls
from voxshell.robots.assembly import Assembly, check_place
from voxshell.robots.inertia_doubts import find_large_inertias
from voxshell.robots.lumps import find_lumps
from voxshell.robots.matter import complete_matter
from voxshell.robots.robot_warning import warn_of_robot
from voxshell.robots.shapes import MeshSettings, Shaper
from voxshell.robots.starts import as_starts, begin_at
from voxshell.robots.urdf.reading import read_urdf

if TYPE_CHECKING:
    import os
    from collections.abc import Mapping

    from numpy.typing import ArrayLike

    from voxshell.robots.robot import Robot
    from voxshell.simulation.world import World


@explain_calls
def load_urdf(
    world: World,
    path: str | os.PathLike[str],
    *,
    pose: ArrayLike | None = None,
    fixed_base: bool = True,
    tolerance: float | None = None,
    voxel_size: float | None = None,
    resolution: int | None = None,
    mesh_as: Literal["model", "hull"] = "model",
    open: Literal["auto", "solid", "sheet"] = "auto",  # noqa: A002
    sheet_thickness: float | None = None,
    friction: float | None = None,
    self_collision: bool = False,
    positions: Mapping[str, float] | None = None,
    inertia: Literal["file", "shape"] = "file",
) -> Robot:
    """Add the robot of a URDF file to a world, with its joints at 0 or at positions that you give.

    Collision meshes become models, which the cache keeps; boxes, spheres, cylinders and capsules
    become analytic shapes. Links that fixed joints hold together become one body, so frames without
    a mass, such as a tool's, are valid. If the file lacks a mass or inertia, it is computed from
    the collision geometry, and a :class:`RobotWarning` names the links. Joints have their limits,
    friction and damping. They move freely until they are driven, except those that mimic others,
    which follow them.

    Args:
        world: The world.
        path: The file's path. Meshes are searched from its folder upward, those of ``package://``
            with and without the name of the package, and in the folders of ``ROS_PACKAGE_PATH``.
        pose: ``world_from_root`` of the root link, in any form that :func:`pose` lists; the identity by
            default.
        fixed_base: Fix the root to the world; then it needs no mass.
        tolerance: Largest accepted error of the models, meters, such as 0.0002: see
            :meth:`Model.from_mesh`. By default models are uniform instead, because the first load then
            takes a half to an eighth of the time.
        voxel_size: Alternative to ``tolerance``: voxel size of uniform models, meters; at most a link's
            longest side.
        resolution: Alternative to both: voxels along the longest side of each uniform model. The default
            is 100.
        mesh_as: "model" for any mesh as it is, or "hull" for its convex hull.
        open: How to treat meshes with open edges: closed as a "solid", as a "sheet" that collides from both
            sides, or by "auto", as described for :meth:`Model.from_mesh`.
        sheet_thickness: Thickness of sheets, meters. The default is a 200th of the longest side, and at
            least two voxels; for meshes that lie in a plane, at most 5 mm.
        friction: Coulomb's coefficient of all links, instead of the file's. By default a body has the
            largest ``lateral_friction``, ``restitution``, ``rolling_friction`` and ``spinning_friction``
            that pybullet's ``<contact>`` states for its links, and friction 0.5 without one.
        self_collision: Let links that no joint connects collide with each other.
        positions: Positions at which joints begin, radians or meters, by name. The others begin at 0,
            except that joints which mimic one of these begin where it puts them, and that joints whose
            limits exclude 0 begin at the nearest limit, with a :class:`RobotWarning`.
        inertia: "file" for the inertias of the file, or "shape" for those of the convex hulls of the
            collision geometry with the masses and centers of the file, as pybullet does by default. Links
            without collision geometry keep theirs.

    Returns:
        The robot.

    Raises:
        MissingFileError: The file does not exist.
        FileAccessError: The file cannot be read.
        MissingExtraError: A mesh is a COLLADA file and pycollada is not installed, or an inertia
            must be computed from a mesh and scipy is not installed.
        RobotError: The file cannot be simulated; the message names the file, the line, the link or
            joint, and a remedy.
        SettingsError: A setting is out of range. Or ``positions`` names an unknown joint, or is
            beyond its limits.
        PoseError: ``pose`` is in no form that :func:`pose` lists, is not rigid, or is not finite.
        MemoryLimitError: A model would be too large.
        InputTypeError: ``world`` is not a world, or ``path`` is not a path, or
            ``positions`` does not map names to numbers.

    Warns:
        RobotWarning: The file lacks what a simulation needs: masses, inertias, limits, collisions of
            links that are seen, or the effort of a joint that mimics another. The message says what was
            used instead. Or an inertia is far beyond that of any body of the size of the collision
            geometry. Or the file has elements that are not simulated, or that URDF does not have. Or meshes have faults, models miss their tolerance, or joints cannot begin at 0;
            the message names links and meshes, or joints.
        MeshWarning: A mesh without a scale is longer than 10 m, and its file states no unit.

    After an exception, the world has none of the robot's bodies.

    Example:
        >>> import pathlib, tempfile
        >>> import voxshell as vx
        >>> text = '''
        ... <robot name="pendulum">
        ...   <link name="hook"/>
        ...   <link name="bob">
        ...     <inertial>
        ...       <origin xyz="0 0 -0.5"/><mass value="1"/>
        ...       <inertia ixx="0.004" iyy="0.004" izz="0.004" ixy="0" ixz="0" iyz="0"/>
        ...     </inertial>
        ...     <collision>
        ...       <origin xyz="0 0 -0.5"/><geometry><sphere radius="0.1"/></geometry>
        ...     </collision>
        ...   </link>
        ...   <joint name="pivot" type="continuous">
        ...     <parent link="hook"/><child link="bob"/><axis xyz="0 1 0"/>
        ...   </joint>
        ... </robot>'''
        >>> world = vx.World()
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     path = pathlib.Path(folder, "pendulum.urdf")
        ...     _ = path.write_text(text)
        ...     robot = vx.load_urdf(world, path, positions={"pivot": 0.1})
        >>> robot
        Robot('pendulum', 2 links, 1 joint that moves)
        >>> round(robot.positions["pivot"], 6)
        0.1
        >>> robot.set_targets({"pivot": 0.5}, max_force=10.0)
        >>> world.step(200)
        >>> round(robot.positions["pivot"], 2)
        0.5
    """
    world_from_root = check_place(world, pose, 0.5 if friction is None else friction)
    as_choice(inertia, "inertia", ("file", "shape"))
    is_fixed = as_flag(fixed_base, "fixed_base")
    collides_itself = as_flag(self_collision, "self_collision")
    starts = as_starts(positions)
    settings = MeshSettings(voxel_size, resolution, mesh_as, tolerance, open, sheet_thickness)
    robot = read_urdf(path)
    begin_at(robot, starts)
    lumps = find_lumps(robot)
    (root,) = robot.roots
    unique = list(dict.fromkeys(lumps.values()))
    moving = [it for it in unique if not (is_fixed and it is lumps[root])]
    matter = complete_matter(robot, moving, inertia=inertia)
    if inertia == "file":
        matter.with_large_inertia = find_large_inertias(robot, moving)
    shaper = Shaper(robot, settings)
    shapes = {lump: shaper.shape_of(lump) for lump in unique}
    robot.intangible.extend(
        name
        for lump, shape in shapes.items()
        if shape is None
        for name in lump.links
        if robot.links[name].is_seen
    )
    meeting = [lump for lump, shape in shapes.items() if shape is not None]
    assembly = Assembly(
        robot,
        lumps,
        matter,
        shapes,
        world_from_root,
        friction=friction,
        apart=() if collides_itself else combinations(meeting, 2),
        joints_collide=False,
    )
    made = assembly.add(world)
    warn_of_robot(robot, matter)
    return made
