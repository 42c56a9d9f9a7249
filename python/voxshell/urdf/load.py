"""Loading a URDF file into a world."""

from __future__ import annotations

from itertools import combinations
from typing import TYPE_CHECKING, Literal, NoReturn

import numpy as np

from voxshell._arguments import as_floats, as_integer, as_positive
from voxshell.comparison_shapes import ConvexHull
from voxshell.compound import Compound, Part
from voxshell.errors import (
    InputTypeError,
    MemoryLimitError,
    MeshError,
    PoseError,
    RobotError,
    SettingsError,
)
from voxshell.joints import HingeJoint, Joint, SliderJoint
from voxshell.meshes import read_mesh
from voxshell.model import Model
from voxshell.shapes import Box, Cylinder, Sphere
from voxshell.urdf.description import (
    Collision,
    MeshFile,
    Primitive,
    RobotDescription,
    read_urdf,
)
from voxshell.urdf.lumps import Lump, find_lumps
from voxshell.urdf.robot import Link, Robot, Strength

if TYPE_CHECKING:
    import os

    from numpy.typing import ArrayLike, NDArray

    from voxshell.body import Body
    from voxshell.urdf.description import JointDescription
    from voxshell.world import World

_DEFAULT_RESOLUTION = 100
_MARKER_RADIUS = 0.005
"""Of the ball that stands for a body without a surface, metres; it meets nothing."""


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

    Collision meshes become models, which the cache keeps; boxes, spheres and cylinders stay what they
    are. Links that fixed joints hold together become one body, so that frames without a mass, such as a
    tool's, are welcome. Joints have their limits, friction and damping; they move freely until they are
    driven, but for those that mimic others, which follow them. Grippers of light fingers that hold on
    firmly want short steps: ``World(time_step=1 / 1000)``.

    Args:
        world: Where to.
        path: Of the file. Meshes are looked for from its folder; ``package://`` from there upwards.
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
        MissingExtraError: yourdfpy is not installed.
        RobotError: The file does not describe a robot that can be simulated; the message names the
            file, the link or joint, and what to do.
        SettingsError: A setting is out of range.
        PoseError: ``pose`` is not a rigid transform.
        MemoryLimitError: A model would be too large.
        InputTypeError: ``world`` is no world, or ``path`` no path.

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
    from voxshell.world import World  # which imports robots

    if not isinstance(world, World):
        raise InputTypeError(f"world must be a World, not {type(world).__name__}")
    # Says what is wrong with the arguments before anything is blamed on the file.
    World().add(Sphere(_MARKER_RADIUS), mass=0.0, pose=world_from_root, friction=friction)
    robot = read_urdf(path)
    lumps = find_lumps(robot)
    _check_masses(robot, lumps, fixed_base)
    _check_efforts(robot)
    shaper = _Shaper(robot, voxel_size, resolution, mesh_as)
    shapes = {lump: shaper.shape_of(lump) for lump in dict.fromkeys(lumps.values())}

    places = {robot.root: world_from_root}
    for joint in robot.joints:
        places[joint.child] = places[joint.parent] @ joint.parent_from_joint
    added: list[Body] = []
    try:
        return _add(
            world, robot, lumps, shapes, places, fixed_base, friction, self_collision, added
        )
    except BaseException as error:
        for each in added:
            world.remove(each)
        # What is wrong with the arguments has been said before.
        if isinstance(error, (PoseError, SettingsError)):
            raise RobotError(f"{robot.path}: {error}") from error
        raise


def _add(
    world: World,
    robot: RobotDescription,
    lumps: dict[str, Lump],
    shapes: dict[Lump, Part | Compound | None],
    places: dict[str, NDArray[np.float64]],
    fixed_base: bool,
    friction: float,
    self_collision: bool,
    added: list[Body],
) -> Robot:
    """Adds bodies and joints, the bodies to ``added`` as well."""
    bodies: dict[Lump, Body | None] = {}
    for lump, shape in shapes.items():
        is_base = lump is lumps[robot.root] and fixed_base
        matter = None if is_base else lump.matter(robot)
        if is_base and shape is None:
            bodies[lump] = None
            continue
        body = bodies[lump] = world.add(
            Sphere(_MARKER_RADIUS) if shape is None else shape,
            mass=0.0 if matter is None else matter.mass,
            inertia="solid" if matter is None else matter,
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
        links[name] = Link(name, body, offset)
    if not self_collision:
        present = [body for body in bodies.values() if body is not None]
        for a, b in combinations(present, 2):
            world.set_collision(a, b, False)
    joints = {
        joint.name: made
        for joint in robot.joints
        if (made := _add_joint(world, robot, joint, links)) is not None
    }
    strengths = {it.name: Strength(it.effort, it.velocity) for it in robot.joints}
    for joint in robot.joints:
        if joint.mimic is not None and joint.name in joints:
            leader, multiplier, offset = joint.mimic
            joints[joint.name].follow(
                joints[leader],
                multiplier=multiplier,
                offset=offset,
                max_force=_effort_of_mimic(robot, joint),
            )
    mimics = frozenset(joint.name for joint in robot.joints if joint.mimic is not None)
    return Robot(world, robot.name, links, joints, strengths, mimics)


def _check_masses(robot: RobotDescription, lumps: dict[str, Lump], fixed_base: bool) -> None:
    for lump in dict.fromkeys(lumps.values()):
        if lump is lumps[robot.root] and fixed_base:
            continue
        if lump.matter(robot) is None:
            hint = "; or pass fixed_base=True" if lump is lumps[robot.root] else ""
            others = f" (nor have those fixed to it: {', '.join(map(repr, [*lump.links][1:]))})"
            robot.refuse(
                f"link {lump.first!r} moves and has no mass{others if len(lump.links) > 1 else ''}; "
                f"add an <inertial> with a <mass> above 0 and its <inertia>{hint}"
            )


def _check_efforts(robot: RobotDescription) -> None:
    for joint in robot.joints:
        if joint.mimic is not None:
            _effort_of_mimic(robot, joint)


def _effort_of_mimic(robot: RobotDescription, joint: JointDescription) -> float:
    """Its own, else that of its leader."""
    assert joint.mimic is not None
    leader = next(it for it in robot.joints if it.name == joint.mimic[0])
    effort = joint.effort or leader.effort
    if effort is None:
        robot.refuse(
            f"joint {joint.name!r} mimics {leader.name!r}, and neither has an effort above 0 in its "
            "<limit>; add one: it is what follows the other with"
        )
    return effort


def _add_joint(
    world: World, robot: RobotDescription, joint: JointDescription, links: dict[str, Link]
) -> Joint | None:
    match joint.type:
        case "revolute" | "continuous":
            kind = HingeJoint(joint.axis, joint.limits, joint.friction, joint.damping)
        case "prismatic":
            kind = SliderJoint(joint.axis, joint.limits, joint.friction, joint.damping)
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
            raise RobotError(f"{self._robot.path}: link {link!r}: {error}") from error

    @staticmethod
    def _make_primitive(geometry: Primitive) -> Part:
        match geometry.kind:
            case "box":
                return Box(np.array(geometry.sizes) / 2.0)
            case "sphere":
                return Sphere(geometry.sizes[0])
            case "cylinder":
                return Cylinder(*geometry.sizes)

    def _make_mesh(self, link: str, file: MeshFile, place: NDArray[np.float64]) -> Part:
        try:
            mesh = read_mesh(file.path)
            vertices = mesh.vertices * file.scale @ place[:3, :3].T + place[:3, 3]
            if self._mesh_as == "hull":
                return ConvexHull(vertices)
            mirrored = np.prod(file.scale) < 0.0
            faces = mesh.faces[:, ::-1] if mirrored else mesh.faces
            voxel_size = self._voxel_size
            side = float(np.ptp(vertices, axis=0).max()) if len(vertices) > 0 else 0.0
            if voxel_size is not None and side > 0.0:
                voxel_size = min(voxel_size, side)
            return Model.from_mesh(
                (vertices, faces), voxel_size=voxel_size, resolution=self._resolution
            )
        except MeshError as error:
            self._refuse(link, file, error)
        except MemoryLimitError as error:
            raise MemoryLimitError(f"{self._robot.path}: link {link!r}: {error}") from error

    def _refuse(self, link: str, file: MeshFile, error: MeshError) -> NoReturn:
        what = str(error) if file.path in str(error) else f"{file.path}: {error}"
        raise RobotError(f"{self._robot.path}: link {link!r}: {what}") from error
