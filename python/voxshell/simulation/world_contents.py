"""Bodies and joints of a world: adding and removing them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from voxshell import _bullet
from voxshell.base.arguments import as_flag, as_text
from voxshell.base.pose_forms import as_rigid_pose
from voxshell.errors import InputTypeError, SettingsError
from voxshell.simulation.body import Body
from voxshell.simulation.body_properties import make_properties
from voxshell.simulation.body_shapes import as_shape, compute_mass_properties, make_geometry
from voxshell.simulation.body_tuple import BodyTuple
from voxshell.simulation.joint_frames import JointFrames, make_settings
from voxshell.simulation.joints import Joint
from voxshell.simulation.limits import check_extent, check_mass
from voxshell.simulation.material import Material, as_material
from voxshell.simulation.motion import MOTIONS, check_surface, decide_mass_and_motion
from voxshell.simulation.pair_watch import PairWatch
from voxshell.simulation.world_part import check_own, refuse_added

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from voxshell.model.meshes import MeshLike
    from voxshell.simulation.body_shapes import Inertia, Shape
    from voxshell.simulation.joint_kinds import JointKind
    from voxshell.simulation.motion import Motion


class WorldContents:
    """The bodies and joints of a world."""

    __slots__ = (
        "__weakref__",
        "_bodies",
        "_joints",
        "_moves_surfaces",
        "_pairs",
        "_simulation",
        "_takes_armature",
        "_takes_joints",
    )

    def __init__(
        self,
        simulation: _bullet.Simulation,
        *,
        moves_surfaces: bool,
        takes_joints: bool,
        takes_armature: bool,
        judges_pairs: bool,
    ) -> None:
        self._simulation = simulation
        self._moves_surfaces = moves_surfaces
        self._takes_joints = takes_joints
        self._takes_armature = takes_armature
        self._pairs = PairWatch() if judges_pairs else None
        self._bodies: list[Body] = []
        self._joints: list[Joint] = []

    @property
    def bodies(self) -> tuple[Body, ...]:
        """The bodies in the order of addition, as they are now.

        Example:
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> balls = [world.add(vx.Sphere(0.1)) for _ in range(5)]
            >>> for body in world.bodies:
            ...     world.remove(body)
            >>> world.bodies
            ()

            By name, if names are unique:

            >>> ground = world.add(vx.Plane(), mass=0, name="ground")
            >>> {body.name: body for body in world.bodies}["ground"] is ground
            True
        """
        return BodyTuple(self._bodies)

    @property
    def joints(self) -> tuple[Joint, ...]:
        """The joints in the order of addition, as they are now."""
        return tuple(self._joints)

    def add(
        self,
        shape: Shape | MeshLike,
        *,
        pose: ArrayLike | None = None,
        name: str | None = None,
        mass: float | None = None,
        inertia: Inertia = "solid",
        material: Material | None = None,
        friction: float | None = None,
        restitution: float | None = None,
        rolling_friction: float | None = None,
        spinning_friction: float | None = None,
        motion: Motion | None = None,
        surface_velocity: ArrayLike = (0.0, 0.0, 0.0),
        linear_damping: float = 0.0,
        angular_damping: float = 0.0,
        group: int = 1,
        mask: int = 2**31 - 1,
    ) -> Body:
        """Add a body: a shape with a pose, a mass, a material, a motion, and groups.

        Only the shape is required. All settings except shape, mass, inertia and motion are
        properties of the body, and can be changed later.

        Args:
            shape: A model, an analytic shape, a compound, or one of Bullet's shapes for comparison.
                A mesh, as a ``trimesh.Trimesh`` or the path of a file, becomes a model with the
                defaults of :meth:`Model.from_mesh`, in meters, and is cached. The path of a model
                file (``.vxs``) loads that model.
            pose: **Place**: ``world_from_body`` in any form that :func:`pose` lists; the identity
                by default.
            name: A name for people, which several bodies may have; "body" and its number by default.
            mass: **Mass**: kilograms; 0 makes the body static. By default, 0 for planes, the mass of
                ``inertia`` if that is mass properties, and otherwise 1 kg.
            inertia: "solid" for uniform density, "surface" for a thin skin on the surface, or mass
                properties of your own. If ``mass`` is given, too, their inertia is scaled to it.
            material: **Material**: friction and restitution as one value, which bodies can share.
                By default friction is 0.5, and the other properties are 0.
            friction: Replaces :attr:`Material.friction`.
            restitution: Replaces :attr:`Material.restitution`. Bullet multiplies those of both bodies,
                so a ball bounces only if the ground has restitution, too.
            rolling_friction: Replaces :attr:`Material.rolling_friction`.
            spinning_friction: Replaces :attr:`Material.spinning_friction`.
            motion: **Motion**: "dynamic": forces move the body. "static": nothing moves it.
                "kinematic": the user sets its pose before each step. By default, bodies with a mass
                are dynamic and others are static. Static and kinematic bodies need no mass.
            surface_velocity: Velocity of a kinematic body's surface, (3,), m/s, body frame. The
                body stays, and friction moves what touches it; see :attr:`Body.surface_velocity`.
            linear_damping: Fraction of the velocity that is lost in a second, 0 to 1.
            angular_damping: Fraction of the angular velocity that is lost in a second, 0 to 1.
            group: **Groups**: bit mask of the groups that the body is in.
            mask: Bit mask of the groups that the body collides with. Two bodies collide if each
                one's group has a bit of the other's mask; see also :meth:`set_collision`.

        Returns:
            The body.

        Raises:
            MissingFileError: A file does not exist.
            MeshError: A mesh cannot be read, or no model can be built from it: see
                :meth:`Model.from_mesh`.
            ModelFileError: A model file is damaged or has another version.
            FileAccessError: A model file cannot be read.
            InputTypeError: ``shape`` cannot be simulated, or ``inertia``, ``material`` or ``name``
                has an unsupported type.
            SettingsError: A number is out of range, or a plane is not static. Or the tensor of
                ``inertia`` is not symmetric or not positive definite, or its
                largest principal moment exceeds the sum of the other two. Or
                ``surface_velocity`` is not 0, and the body is not kinematic, the solver is not
                "coulomb", or ``friction_directions`` is 1.
            PoseError: ``pose`` is in no form that :func:`pose` lists, is not rigid, or is not
                finite.

        Example:
            A kinematic plate carries what lies on it, one meter a second:

            >>> import numpy as np
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> plate = world.add(vx.Box((0.5, 0.5, 0.05)), motion="kinematic")
            >>> on_top = np.eye(4)
            >>> on_top[2, 3] = 0.1
            >>> parcel = world.add(vx.Box((0.05, 0.05, 0.05)), pose=on_top, friction=1.0)
            >>> def push(world):
            ...     plate.position = plate.position + (1.0 * world.time_step, 0, 0)
            >>> world.step(400, before=push)
            >>> bool(abs(parcel.linear_velocity[0] - 1.0) < 0.01)
            True
        """
        if isinstance(shape, Body):
            refuse_added(shape, self._simulation)
        kilograms, motion = decide_mass_and_motion(shape, mass, inertia, motion)
        label = "the body" if name is None else repr(as_text(name, "name"))
        check_mass(kilograms, label)
        properties = make_properties(
            as_material(
                Material() if material is None else material,
                friction=friction,
                restitution=restitution,
                rolling_friction=rolling_friction,
                spinning_friction=spinning_friction,
            ),
            linear_damping=linear_damping,
            angular_damping=angular_damping,
            surface_velocity=surface_velocity,
            group=group,
            mask=mask,
        )
        if any(properties.surface_velocity):
            check_surface(motion, label, self._moves_surfaces)
        shape = as_shape(shape)
        geometry = make_geometry(shape)
        matter = compute_mass_properties(shape, kilograms, inertia)
        world_from_body = np.eye(4) if pose is None else as_rigid_pose(pose, "pose")
        number = self._simulation.add_body(
            geometry,
            motion=MOTIONS[motion],
            mass=kilograms,
            center_of_mass=matter.center_of_mass.tolist(),
            inertia=matter.inertia.tolist(),
            pose=world_from_body,
            material=properties,
        )
        if motion != "static":
            try:
                check_extent(self._simulation.bounds(number), label)
            except SettingsError:
                self._simulation.remove_body(number)
                raise
        body = Body(
            self._simulation,
            number,
            name or f"body {number}",
            shape,
            kilograms,
            motion,
            self._moves_surfaces,
            matter,
            None if self._pairs is None else self._pairs.renew,
        )
        self._bodies.append(body)
        if self._pairs is not None:
            self._pairs.note(body)
        return body

    def remove(self, what: Body | Joint) -> None:
        """Remove a body and the joints that hold it, or remove a joint.

        Everything else stays as it is, including numbers. Bodies that it held or carried wake up.

        Raises:
            InputTypeError: ``what`` is neither a body nor a joint.
            SettingsError: It belongs to another world, or has been removed before.

        Example:
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> ball = world.add(vx.Sphere(0.1))
            >>> world.remove(ball)
            >>> world.bodies
            ()
        """
        if isinstance(what, Joint):
            check_own(what, self._simulation)
            self._simulation.remove_joint(what._number)
            what._world = None
            self._joints.remove(what)
            if self._pairs is not None:
                self._pairs.renew(what.parent, what.child)
            return
        if not isinstance(what, Body):
            raise InputTypeError(f"what must be a Body or a Joint, not {type(what).__name__}")
        self._check_own(what, "what")
        for joint in [joint for joint in self.joints if what in (joint.parent, joint.child)]:
            self.remove(joint)
        self._simulation.remove_body(what.number)
        what._world = None
        self._bodies.remove(what)
        if self._pairs is not None:
            self._pairs.forget(what)

    def add_joint(
        self,
        joint: JointKind,
        parent: Body | None,
        child: Body,
        *,
        parent_from_joint: ArrayLike | None = None,
        child_from_joint: ArrayLike | None = None,
        world_from_joint: ArrayLike | None = None,
        collide: bool = False,
        name: str | None = None,
    ) -> Joint:
        """Join two bodies, or a body and the world.

        A joint has a frame in each of its bodies. The frames coincide at position 0. By default the
        joint is at the child's origin, and its present position is 0.

        Args:
            joint: The kind of joint: :class:`FixedJoint`, :class:`HingeJoint`, :class:`SliderJoint`
                or :class:`PointJoint`.
            parent: A body, or None for the world.
            child: Another body. At least one of the two must be dynamic.
            parent_from_joint: (4, 4) pose of the joint in the parent's frame, which is that of its
                mesh. If it is given without ``child_from_joint``, it determines the present
                position of the joint.
            child_from_joint: (4, 4) pose of the joint in the child's frame; the identity by
                default.
            world_from_joint: Alternative to both: (4, 4) present pose of the joint in the world.
            collide: Let the two bodies collide with each other.
            name: A name for people; "joint" and its number by default.

        Returns:
            The joint.

        Raises:
            InputTypeError: ``joint``, ``parent`` or ``child`` has a wrong type.
            SettingsError: A body belongs to another world or has been removed, both are the same,
                or none of them can move. Or the world's solver is "nncg", with which motors at
                limits diverge.
            PoseError: A frame is not a rigid transform.

        Example:
            A door of 0.8 m, hinged at its edge and pushed at its handle:

            >>> import numpy as np
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> door = world.add(vx.Box((0.4, 0.02, 1.0)), mass=20.0)
            >>> edge = np.eye(4)
            >>> edge[0, 3] = -0.4
            >>> hinge = world.add_joint(
            ...     vx.HingeJoint(axis=(0, 0, 1), limits=(0.0, 1.5)), None, door,
            ...     world_from_joint=edge,
            ... )
            >>> push = lambda world: door.apply_force((0, 20, 0), at=(0.3, 0, 0))
            >>> world.step(400, before=push)
            >>> bool(abs(hinge.position - 1.5) < 0.01)
            True
        """
        if not self._takes_joints:
            raise SettingsError(
                "Bullet's solver 'nncg' does not support joints: make the world with another solver"
            )
        if getattr(joint, "armature", 0.0) and not self._takes_armature:
            raise SettingsError(
                "Bullet's own solvers do not support the armature of joints: make the world with "
                "the solver 'coulomb', the default"
            )
        if parent is not None:
            self._check_own(parent, "parent")
        self._check_own(child, "child")
        if parent is child:
            raise SettingsError(
                f"parent and child are both {child.name!r}; pass another parent, or None for the world"
            )
        if child.motion != "dynamic" and (parent is None or parent.motion != "dynamic"):
            raise SettingsError(
                "a joint needs a body that can move: "
                f"{'the world' if parent is None else repr(parent.name)} and {child.name!r} cannot"
            )
        if name is not None:
            as_text(name, "name")
        frames = JointFrames(parent_from_joint, child_from_joint, world_from_joint)
        collides = as_flag(collide, "collide")
        settings, resolved = make_settings(joint, parent, child, frames, collides)
        number = self._simulation.add_joint(settings)
        made = Joint(
            self._simulation,
            number,
            name or f"joint {number}",
            joint,
            parent,
            child,
            resolved,
            collides,
        )
        self._joints.append(made)
        return made

    def set_collision(self, a: Body, b: Body, collide: bool) -> None:
        """Set whether two bodies can collide with each other.

        Groups and joints may still keep them from colliding.

        Raises:
            InputTypeError: ``a`` or ``b`` is not a body.
            SettingsError: One belongs to another world or has been removed, or both are the same.

        Example:
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> ground = world.add(vx.Plane(), mass=0)
            >>> stone = world.add(vx.Sphere(0.1))
            >>> world.set_collision(ground, stone, False)
            >>> world.step(200)
            >>> bool(stone.pose[2, 3] < -4.0)
            True
        """
        self._check_two(a, b)
        collides = as_flag(collide, "collide")
        self._simulation.set_collision(a.number, b.number, collides)
        if self._pairs is not None:
            self._pairs.set_collision(a, b, collides)

    def _check_two(self, a: Body, b: Body) -> None:
        self._check_own(a, "a")
        self._check_own(b, "b")
        if a is b:
            raise SettingsError(f"a and b are both {a.name!r}; pass two different bodies")

    def _check_own(self, body: Body, name: str) -> None:
        if not isinstance(body, Body):
            kind = type(body).__name__
            hint = "; pass one of its bodies, which robot.bodies lists" if kind == "Robot" else ""
            raise InputTypeError(f"{name} must be a Body, not {kind}{hint}")
        check_own(body, self._simulation)
