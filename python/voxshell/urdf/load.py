"""Loading a URDF file into a world."""

from __future__ import annotations

import warnings
from itertools import combinations
from typing import TYPE_CHECKING, Literal

import numpy as np

from voxshell.base.arguments import as_floats, as_integer, as_positive
from voxshell.errors import (
    InputTypeError,
    MemoryLimitError,
    MeshError,
    PoseError,
    RobotError,
    SettingsError,
)
from voxshell.model.model import Model
from voxshell.model.shapes import Box, Capsule, Cylinder, Sphere
from voxshell.simulation.comparison_shapes import ConvexHull
from voxshell.simulation.compound import Compound, Part
from voxshell.simulation.joint_kinds import HingeJoint, PointJoint, SliderJoint
from voxshell.simulation.joints import Joint
from voxshell.urdf.description import Collision, MeshFile, Primitive, RobotDescription
from voxshell.urdf.lumps import Lump, find_lumps
from voxshell.urdf.matter import DENSITY, GHOST_MASS, Matter, complete_matter
from voxshell.urdf.mesh_files import read_link_mesh, refuse_mesh
from voxshell.urdf.reading import read_urdf, shorten_names
from voxshell.urdf.robot import Link, Robot, RobotWarning, Strength

if TYPE_CHECKING:
    import os

    from numpy.typing import ArrayLike, NDArray

    from voxshell.simulation.body import Body
    from voxshell.simulation.world import World
    from voxshell.urdf.description import JointDescription

_DEFAULT_RESOLUTION = 100
_MARKER_RADIUS = 0.005
"""Of the ball that stands for a body without a surface, metres; it meets nothing."""

_MIMIC_EFFORT = 1000.0
"""Of a joint that follows another where the file names none for either, newtons or newton metres: beyond
what robots' joints can do, so that it follows as gears do."""


def load_urdf(
    world: World,
    path: str | os.PathLike[str],
    *,
    pose: ArrayLike | None = None,
    fixed_base: bool = True,
    voxel_size: float | None = None,
    resolution: int | None = None,
    mesh_as: Literal["model", "hull"] = "model",
    friction: float = 0.5,
    self_collision: bool = False,
) -> Robot:
    """Adds the robot of a URDF file to a world, all joints at position 0.

    Collision meshes become models, which the cache keeps; boxes, spheres, cylinders and capsules stay
    what they are. Links that fixed joints hold together become one body, so that frames without a mass, such as a
    tool's, are welcome. A mass or inertia that the file leaves out is computed from the collision
    geometry, with a :class:`RobotWarning` that names the links. Joints have their limits, friction and damping; they move freely until they are
    driven, but for those that mimic others, which follow them. Grippers of light fingers that hold on
    firmly want short steps: ``World(time_step=1 / 1000)``.

    Args:
        world: Where to.
        path: Of the file. Meshes are looked for from its folder upwards, those of ``package://`` with and
            without the name of the package, and in the folders of ``ROS_PACKAGE_PATH``.
        pose: (4, 4) ``world_from_root`` of the root link; the identity by default.
        fixed_base: Whether the root is fixed to the world; it then needs no mass.
        voxel_size: Of the models, metres; of smaller links their longest side.
        resolution: Instead: voxels along the longest side of each model. Without either, models
            are built to the default tolerance of :meth:`Model.from_mesh`.
        mesh_as: "model", any mesh as it is, or "hull", its convex hull.
        friction: Coulomb coefficient of all links.
        self_collision: Whether links that no joint connects collide with each other.

    Returns:
        The robot.

    Raises:
        FileAccessError: The file cannot be read.
        MissingExtraError: A mesh is a COLLADA file and pycollada is not installed, or an inertia must be
            computed from a mesh and scipy is not installed.
        RobotError: The file does not describe a robot that can be simulated; the message names the
            file, the line, the link or joint, and what to do.
        SettingsError: A setting is out of range.
        PoseError: ``pose`` is not a rigid transform.
        MemoryLimitError: A model would be too large.
        InputTypeError: ``world`` is no world, or ``path`` no path.

    Warns:
        RobotWarning: The file leaves out what a simulation needs: masses, inertias, limits, or the effort
            of a joint that mimics another. The message says what was taken instead.

    Where it raises, the world has none of the robot's bodies.

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
        ...     robot = vx.load_urdf(world, path)
        >>> robot
        Robot('pendulum', 2 links, 1 joint that moves)
        >>> robot.set_targets({"pivot": 0.5}, max_force=10.0)
        >>> world.step(200)
        >>> round(robot.positions["pivot"], 2)
        0.5
    """
    if mesh_as not in ("model", "hull"):
        raise SettingsError(f"mesh_as must be 'model' or 'hull', not {mesh_as!r}")
    if voxel_size is not None:
        as_positive(voxel_size, "voxel_size")
    if resolution is not None:
        as_integer(resolution, "resolution", 2, 2**31 - 1)
    if voxel_size is None and resolution is None:
        resolution = _DEFAULT_RESOLUTION
    world_from_root = np.eye(4) if pose is None else as_floats(pose, "pose", (4, 4), PoseError)
    from voxshell.simulation.world import World  # which imports robots

    if not isinstance(world, World):
        raise InputTypeError(f"world must be a World, not {type(world).__name__}")
    # Says what is wrong with the arguments before anything is blamed on the file.
    World().add(Sphere(_MARKER_RADIUS), mass=0.0, pose=world_from_root, friction=friction)
    robot = read_urdf(path)
    lumps = find_lumps(robot)
    matter = complete_matter(
        robot,
        (
            it
            for it in dict.fromkeys(lumps.values())
            if not (fixed_base and it is lumps[robot.root])
        ),
    )
    shaper = _Shaper(robot, voxel_size, resolution, mesh_as)
    shapes = {lump: shaper.shape_of(lump) for lump in dict.fromkeys(lumps.values())}

    places = {robot.root: world_from_root}
    for joint in robot.joints:
        places[joint.child] = places[joint.parent] @ joint.parent_from_joint
    added: list[Body] = []
    try:
        made = _add(world, robot, lumps, shapes, places, matter, friction, self_collision, added)
    except BaseException as error:
        for each in added:
            world.remove(each)
        # What is wrong with the arguments has been said before.
        if isinstance(error, (PoseError, SettingsError)):
            raise RobotError(f"{robot.path}: {error}") from error
        raise
    _warn_of_completions(robot, matter)
    return made


def _add(
    world: World,
    robot: RobotDescription,
    lumps: dict[str, Lump],
    shapes: dict[Lump, Part | Compound | None],
    places: dict[str, NDArray[np.float64]],
    matter: Matter,
    friction: float,
    self_collision: bool,
    added: list[Body],
) -> Robot:
    """Adds bodies and joints, the bodies to ``added`` as well."""
    bodies: dict[Lump, Body | None] = {}
    for lump, shape in shapes.items():
        own = matter.of_lumps.get(lump)
        if own is None and shape is None:
            bodies[lump] = None
            continue
        body = bodies[lump] = world.add(
            Sphere(_MARKER_RADIUS) if shape is None else shape,
            mass=0.0 if own is None else own.mass,
            inertia="solid" if own is None else own,
            pose=places[lump.first],
            friction=friction,
            name=f"{robot.name}/{lump.first}",
            group=1 if shape is not None else 0,
        )
        added.append(body)
    links = {}
    for name, lump in lumps.items():
        body = bodies[lump]
        offset = lump.links[name] if body is not None else places[name]
        links[name] = Link(name, body, offset, robot.links[name].color)
    if not self_collision:
        present = [body for body in bodies.values() if body is not None]
        for a, b in combinations(present, 2):
            world.set_collision(a, b, False)
    joints: dict[str, Joint] = {}
    ball_joints: dict[str, Joint] = {}
    for joint in robot.joints:
        made = _add_joint(world, robot, joint, links)
        if made is not None:
            (ball_joints if joint.type == "spherical" else joints)[joint.name] = made
    by_name = {joint.name: joint for joint in robot.joints}
    for joint in robot.joints:
        if joint.mimic is not None:
            leader, multiplier, offset = joint.mimic
            joints[joint.name].follow(
                joints[leader],
                multiplier=multiplier,
                offset=offset,
                max_force=joint.effort or by_name[leader].effort or _MIMIC_EFFORT,
            )
    strengths = {it.name: Strength(it.effort, it.velocity) for it in robot.joints}
    mimics = frozenset(joint.name for joint in robot.joints if joint.mimic is not None)
    return Robot(world, robot.name, links, joints, ball_joints, strengths, mimics)


def _warn_of_completions(robot: RobotDescription, matter: Matter) -> None:
    """Says in one warning what the file left out, and what was taken instead."""
    efforts = {joint.name: joint.effort for joint in robot.joints}
    weak = [
        joint.name
        for joint in robot.joints
        if joint.mimic is not None and not (joint.effort or efforts[joint.mimic[0]])
    ]
    hulls = "the convex hulls of its collision geometry"
    lines = [
        f"{text} ({shorten_names(names)})"
        for names, text in (
            (matter.without_mass, f"no mass: {DENSITY:g} kg/m3 of {hulls} were taken"),
            (matter.without_shape, f"no mass and no shape: {GHOST_MASS:g} kg were taken"),
            (matter.without_inertia, f"no valid inertia: that of {hulls} was taken"),
            (
                robot.without_limits,
                "no <limit>, or a lower above the upper one: it moves without an end",
            ),
            (weak, f"no effort to follow its leader with: {_MIMIC_EFFORT:g} N or N m were taken"),
        )
        if names
    ]
    if lines:
        warnings.warn(
            f"{robot.path} leaves out what a simulation needs: {'; '.join(lines)}; complete the file to "
            "be rid of this warning",
            RobotWarning,
            stacklevel=3,
        )


def _add_joint(
    world: World, robot: RobotDescription, joint: JointDescription, links: dict[str, Link]
) -> Joint | None:
    match joint.type:
        case "revolute" | "continuous":
            kind = HingeJoint(joint.axis, joint.limits, joint.friction, joint.damping)
        case "prismatic":
            kind = SliderJoint(joint.axis, joint.limits, joint.friction, joint.damping)
        case "spherical":
            kind = PointJoint()
        case _:
            return None
    parent, child = links[joint.parent], links[joint.child]
    assert child.body is not None
    return world.add_joint(
        kind,
        parent.body,
        child.body,
        parent_from_joint=parent.body_from_link @ joint.parent_from_joint,
        child_from_joint=np.eye(4),
        name=f"{robot.name}/{joint.name}",
    )


class _Shaper:
    """Makes shapes of the collision geometry of links."""

    def __init__(
        self,
        robot: RobotDescription,
        voxel_size: float | None,
        resolution: int | None,
        mesh_as: Literal["model", "hull"],
    ) -> None:
        self._robot = robot
        self._voxel_size = voxel_size
        self._resolution = resolution
        self._mesh_as = mesh_as
        self._made: dict[tuple[MeshFile, bytes], Part] = {}

    def shape_of(self, lump: Lump) -> Part | Compound | None:
        """In the lump's frame; None where no link has a surface."""
        parts: list[tuple[Part, NDArray[np.float64]]] = []
        for name, lump_from_link in lump.links.items():
            for collision in self._robot.links[name].collisions:
                place = lump_from_link @ collision.link_from_geometry
                parts.append(self._make(name, collision, place))
        if not parts:
            return None
        if len(parts) == 1 and np.array_equal(parts[0][1], np.eye(4)):
            return parts[0][0]
        return Compound(parts)

    def _make(
        self, link: str, collision: Collision, place: NDArray[np.float64]
    ) -> tuple[Part, NDArray[np.float64]]:
        geometry = collision.geometry
        if isinstance(geometry, MeshFile):
            key = geometry, place.tobytes()
            if key not in self._made:
                self._made[key] = self._make_mesh(link, geometry, place)
            return self._made[key], np.eye(4)
        try:
            return self._make_primitive(geometry), place
        except SettingsError as error:
            line = self._robot.links[link].line
            raise RobotError(f"{self._robot.path}:{line}: link {link!r}: {error}") from error

    @staticmethod
    def _make_primitive(geometry: Primitive) -> Part:
        match geometry.kind:
            case "box":
                return Box(np.array(geometry.sizes) / 2.0)
            case "sphere":
                return Sphere(geometry.sizes[0])
            case "cylinder":
                return Cylinder(*geometry.sizes)
            case "capsule":
                return Capsule(*geometry.sizes)

    def _make_mesh(self, link: str, file: MeshFile, place: NDArray[np.float64]) -> Part:
        mesh = read_link_mesh(self._robot, link, file)
        vertices = mesh.vertices @ place[:3, :3].T + place[:3, 3]
        try:
            if self._mesh_as == "hull":
                return self._make_hull(vertices)
            voxel_size = self._voxel_size
            side = float(np.ptp(vertices, axis=0).max()) if len(vertices) > 0 else 0.0
            if voxel_size is not None and side > 0.0:
                voxel_size = min(voxel_size, side)
            return Model.from_mesh(
                (vertices, mesh.faces), voxel_size=voxel_size, resolution=self._resolution
            )
        except MeshError as error:
            refuse_mesh(self._robot, link, file, error)
        except MemoryLimitError as error:
            raise MemoryLimitError(f"{self._robot.path}: link {link!r}: {error}") from error

    @staticmethod
    def _make_hull(vertices: NDArray[np.float64]) -> ConvexHull:
        try:
            return ConvexHull(vertices)
        except MeshError as error:
            raise MeshError(f"{error}; repair the mesh, or give it a thickness") from None
