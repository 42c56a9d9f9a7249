"""Simulation in stock Bullet: bodies of models, analytic shapes and Bullet's own, and their joints."""

from __future__ import annotations

import math
import weakref
from collections import Counter
from contextlib import suppress
from typing import TYPE_CHECKING, Literal

import numpy as np

from voxshell import _bullet
from voxshell._accuracy_warning import judge_world
from voxshell._arguments import (
    as_integer,
    as_not_negative,
    as_points,
    as_positive,
    as_real,
    as_threads,
    as_vector,
)
from voxshell._poses import as_rigid_pose
from voxshell.body import MOTIONS, Body, as_mass_and_motion, check_surface, make_material
from voxshell.body_shapes import as_shape, compute_mass_properties, make_geometry
from voxshell.comparison_shapes import GImpact
from voxshell.compound import Compound
from voxshell.errors import InputTypeError, SettingsError
from voxshell.joints import Joint, JointFrames, make_settings
from voxshell.live_view import LiveView
from voxshell.model import Model
from voxshell.recorder import Recorder
from voxshell.shapes import Plane
from voxshell.world_limits import check_extent, check_fall, check_mass, check_motions
from voxshell.world_part import check_own
from voxshell.world_state import WorldState, check_same
from voxshell.world_tables import as_contacts, as_hits, as_timings

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from numpy.typing import ArrayLike, NDArray

    from voxshell.body import Motion
    from voxshell.body_shapes import Inertia, Shape
    from voxshell.joints import JointKind
    from voxshell.meshes import MeshLike

BULLET_VERSION = f"{_bullet.bullet_version / 100:.2f}, double precision"
"""Of the library that simulates."""

_CONTACT_MODES = {
    "auto": _bullet.ContactMode.AUTO,
    "regular": _bullet.ContactMode.REGULAR,
    "segmented": _bullet.ContactMode.SEGMENTED,
}
_SHELL_RULES = {
    "auto": _bullet.ShellRule.AUTO,
    "fewest": _bullet.ShellRule.FEWEST,
}
_SOLVERS = {
    "coulomb": _bullet.ConstraintSolver.COULOMB,
    "sequential_impulse": _bullet.ConstraintSolver.SEQUENTIAL_IMPULSE,
    "nncg": _bullet.ConstraintSolver.NNCG,
    "dantzig": _bullet.ConstraintSolver.DANTZIG,
    "projected_gauss_seidel": _bullet.ConstraintSolver.PROJECTED_GAUSS_SEIDEL,
}
_MOST_LEVELS = 12
_MOST_ITERATIONS = 1_000_000


class World:
    """A world of stock Bullet (double precision) in which models collide.

    Bodies that turn freely keep their angular momentum and energy.

    Threads may share a world. Each call waits for its turn, :meth:`step` gives way to others between
    steps, and what a thread reads is how things stand between two steps. A body that another thread
    has removed is a :class:`SettingsError`. Callbacks of :meth:`step` hold no turn and may use the world.

    Args:
        gravity: (3,), m/s2, world frame.
        time_step: Seconds a step.
        contact: How contacts of models become Bullet's contact points. "regular": the deepest and
            those that span the largest area, four at most; "segmented": the deepest of each cluster
            of the point-sphere tree at ``level``, or up to four of each where a body lies still on
            few; "auto": what rests most calmly, now segmented with up to four points each on few,
            moving or not.
        shell: Whose points of two models are tested. "auto": those of the model with which least can
            be missed, or both models' where neither is enough alone; "fewest": those of the model with
            fewer points, as the thesis has it.
        level: The level, 1 to 12, for segmented contacts; 4 by default, up to 64 clusters, and for
            "auto" 5 in steps in which bodies are fast.
        margin: How near slow points count as contacts, metres; a thousandth of the smaller body's
            diameter by default, but no more than a 20th of either one's thickness. Without it, resting bodies rock.
        ccd_motion_threshold: A pair of bodies that moves farther than this in a step, metres, gets
            continuous collision detection (CCD): points that will touch within the step are
            speculative contacts, so that nothing tunnels. By default two fifths of a model's
            thickness or a 50th of its longest side, or a quarter of the inner radius of a box, ball
            or hull, whichever is least. Infinity: no CCD, as in the thesis.
        sleeping: Whether bodies at rest are put to sleep.
        split_impulse_threshold: Bullet's m_splitImpulsePenetrationThreshold, metres. At 0, its value
            here, penetration is resolved without adding velocity, which models need to rebound
            truly; -0.04 is Bullet's own default.
        solver: The solver of constraints. "coulomb" is Bullet's sequential impulse solver with
            Coulomb's friction, the same in every direction. The others are Bullet's own, under which
            bodies with many contact points slide with too much friction: "sequential_impulse" is
            Bullet's default; "nncg" follows conjugate gradients, takes no joints, and may diverge;
            "dantzig" solves all of an island's constraints as one problem, exactly, in a time that
            grows with the cube of their number; "projected_gauss_seidel" solves that problem step by
            step.
        iterations: Of the solver a step, at least 1; exactly as many as given. By default "coulomb"
            does 10 and, where bodies that touch are not solved by then, as with heavy bodies on light
            ones, goes on with Newton's method until they are; the others do 50, pybullet's default, and in longer
            steps as many for each 30th of a second. "dantzig" does without.
        friction_directions: Along which each contact resists sliding: 2 fixed ones, or 1, that in which
            it slides, as is Bullet's default. With 1, gripped bodies creep; convex hulls of few
            vertices rest sooner.
        threads: How many look for the contacts of models, up to 1024; one a core by default. A few
            pairs of bodies are left to one thread. The result is the same.

    Raises:
        SettingsError: A setting is out of range.

    Warns:
        AccuracyWarning: At the first step with them, where a pair of models may miss contacts that are
            deep beside the smaller model's thickness; and, once a body, where one turns by more than
            an eighth of a turn in a step, or moves so far in one that Bullet takes it out of the
            simulation.

    Example:
        A ball of 0.1 m falls on the ground and stays there:

        >>> import numpy as np
        >>> import trimesh
        >>> import voxshell as vx
        >>> model = vx.Model.from_mesh(trimesh.creation.icosphere(radius=0.1), voxel_size=0.01)
        >>> world = vx.World()
        >>> ground = world.add(vx.Plane(), mass=0)
        >>> above = np.eye(4)
        >>> above[2, 3] = 0.3
        >>> ball = world.add(model, mass=1.0, pose=above)
        >>> world.step(400)
        >>> bool(abs(ball.pose[2, 3] - 0.1) < 0.001)
        True
    """

    def __init__(
        self,
        *,
        gravity: ArrayLike = (0.0, 0.0, -9.81),
        time_step: float = 1.0 / 200.0,
        contact: Literal["auto", "regular", "segmented"] = "auto",
        shell: Literal["auto", "fewest"] = "auto",
        level: int | None = None,
        margin: float | None = None,
        ccd_motion_threshold: float | None = None,
        sleeping: bool = True,
        split_impulse_threshold: float = 0.0,
        solver: Literal[
            "coulomb", "sequential_impulse", "nncg", "dantzig", "projected_gauss_seidel"
        ] = "coulomb",
        iterations: int | None = None,
        friction_directions: Literal[1, 2] = 2,
        threads: int | None = None,
    ) -> None:
        if solver not in _SOLVERS:
            raise SettingsError(
                f"solver must be one of {', '.join(map(repr, _SOLVERS))}, not {solver!r}"
            )
        if contact not in _CONTACT_MODES:
            raise SettingsError(
                f"contact must be one of {', '.join(map(repr, _CONTACT_MODES))}, not {contact!r}"
            )
        if shell not in _SHELL_RULES:
            raise SettingsError(
                f"shell must be one of {', '.join(map(repr, _SHELL_RULES))}, not {shell!r}"
            )
        if level is not None and contact == "regular":
            raise SettingsError("level is for segmented contacts; leave it out or change contact")
        directions = as_integer(friction_directions, "friction_directions", 1, 2)
        self.time_step: float = as_positive(time_step, "time_step")
        check_fall(as_vector(gravity, "gravity"), self.time_step)
        as_needed = iterations is None and solver == "coulomb"
        if iterations is None:
            iterations = 10 if as_needed else self._fixed_iterations()
        self._gravity = np.array(as_vector(gravity, "gravity"))
        self._gravity.setflags(write=False)
        self.bodies: list[Body] = []
        self.joints: list[Joint] = []
        self._moves_surfaces = solver == "coulomb" and directions == 2
        self._takes_joints = solver != "nncg"
        self._advice = "" if solver == "coulomb" else ", or the solver 'coulomb'"
        self._recorders: list[Recorder] = []
        self._view: LiveView | None = None
        self._judges = shell == "auto"
        # Bodies ever added, by the model's serial and whether they may move.
        self._known: Counter[tuple[int, bool]] = Counter()
        self._new: set[Model] = set()  # that may meet others than before the last step
        self._judged: set[frozenset[int]] = set()  # pairs of serials; one of a model with itself
        self._simulation = _bullet.Simulation(
            gravity=as_vector(gravity, "gravity"),
            time_step=self.time_step,
            sleeping=bool(sleeping),
            split_impulse_threshold=as_real(split_impulse_threshold, "split_impulse_threshold"),
            solver=_SOLVERS[solver],
            iterations=as_integer(iterations, "iterations", 1, _MOST_ITERATIONS),
            effort=_bullet.SolverEffort.AS_NEEDED if as_needed else _bullet.SolverEffort.FIXED,
            two_friction_directions=directions == 2,
            mode=_CONTACT_MODES[contact],
            shell=_SHELL_RULES[shell],
            level=0 if level is None else as_integer(level, "level", 1, _MOST_LEVELS),
            margin=-1.0 if margin is None else as_not_negative(margin, "margin"),
            ccd_motion_threshold=-1.0
            if ccd_motion_threshold is None
            else _as_reach(ccd_motion_threshold),
            threads=as_threads(threads),
        )

    def _fixed_iterations(self) -> int:
        """Those of solvers that do not find out how many they need."""
        return max(50, min(round(1500.0 * self.time_step), _MOST_ITERATIONS))

    def add(
        self,
        shape: Shape | MeshLike,
        *,
        mass: float = 1.0,
        pose: ArrayLike | None = None,
        friction: float = 0.5,
        restitution: float = 0.0,
        inertia: Inertia = "solid",
        name: str | None = None,
        motion: Motion | None = None,
        rolling_friction: float = 0.0,
        spinning_friction: float = 0.0,
        linear_damping: float = 0.0,
        angular_damping: float = 0.0,
        surface_velocity: ArrayLike = (0.0, 0.0, 0.0),
        group: int = 1,
        mask: int = 2**31 - 1,
    ) -> Body:
        """Adds a body.

        Args:
            shape: A model, an analytic shape, a compound, or one of Bullet's shapes for comparison. A
                mesh, as a ``trimesh.Trimesh`` or the path of a file, becomes a model as
                :meth:`Model.from_mesh` builds it by default, in metres, and is cached; the path of a model
                file (``.vxs``) is loaded.
            mass: Kilograms; 0 makes the body static.
            pose: ``world_from_body`` in any form that :func:`pose` lists; the identity by default.
            friction: Coulomb coefficient; Bullet multiplies those of the two bodies.
            restitution: 0 to 1; Bullet multiplies those of the two bodies.
            inertia: Of the uniform solid, of a thin skin on the surface, or given: then its mass is
                replaced by ``mass``.
            name: For people; "body" and its number by default.
            motion: "dynamic", moved by forces; "static", by nobody; "kinematic", by the user, who sets
                its pose before each step. By default the first two, by the mass, which the last two
                do without.
            rolling_friction: Lever of the torque that withstands rolling, metres; see
                :attr:`Body.rolling_friction`.
            spinning_friction: The same of spinning about the contact's normal; Bullet heeds it only
                beside rolling friction.
            linear_damping: Share of the velocity that is lost in a second, 0 to 1.
            angular_damping: The same of the angular velocity.
            surface_velocity: Of a kinematic body's surface, (3,), m/s, body frame: the body stays, and
                friction takes along what touches it; see :attr:`Body.surface_velocity`.
            group: Bits of the groups that the body is in.
            mask: Bits of the groups that it meets. Two bodies meet if each one's group has a bit of
                the other's mask; see also :meth:`set_collision`.

        Returns:
            The body.

        Raises:
            MeshError: A mesh cannot be read or made into a model: see :meth:`Model.from_mesh`.
            ModelFileError: A model file is damaged or of another version.
            FileAccessError: A model file cannot be read.
            InputTypeError: ``shape`` cannot be simulated, or ``inertia`` is of another type.
            SettingsError: A number is out of range, a plane is to move, or ``surface_velocity`` is not
                0 and the body is not kinematic, the solver is not "coulomb", or
                ``friction_directions`` is 1.
            PoseError: ``pose`` is in no form that :func:`pose` lists, is not rigid, or is not finite.

        Example:
            A kinematic plate carries what lies on it, one metre a second:

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
        kilograms, motion = as_mass_and_motion(mass, motion)
        label = "the body" if name is None else repr(name)
        check_mass(kilograms, label)
        if isinstance(shape, Plane) and motion != "static":
            raise SettingsError("a plane has no end and cannot move: pass mass=0")
        material = make_material(
            friction=friction,
            rolling_friction=rolling_friction,
            spinning_friction=spinning_friction,
            restitution=restitution,
            linear_damping=linear_damping,
            angular_damping=angular_damping,
            group=group,
            mask=mask,
            surface_velocity=surface_velocity,
        )
        if any(material.surface_velocity):
            check_surface(motion, label, self._moves_surfaces)
        shape = as_shape(shape)
        geometry = make_geometry(shape)
        matter = compute_mass_properties(shape, kilograms, inertia)
        world_from_body = np.eye(4) if pose is None else as_rigid_pose(pose, "pose")
        number = self._simulation.add_body(
            geometry,
            motion=MOTIONS[motion],
            mass=kilograms,
            centre_of_mass=matter.center_of_mass.tolist(),
            inertia=matter.inertia.tolist(),
            pose=world_from_body,
            material=material,
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
        )
        self.bodies.append(body)
        if self._judges:
            for model in set(_models_of(shape)):
                key = (model._serial, motion != "static")
                self._known[key] += 1
                if self._known[key] <= 2:  # a second body may meet the first
                    self._new.add(model)
        return body

    def remove(self, what: Body | Joint) -> None:
        """Takes a body, with the joints that hold it, or a joint out of the world.

        Everything else stays as it is, numbers included; what was held or carried wakes.

        Raises:
            InputTypeError: ``what`` is neither.
            SettingsError: It is of another world, or has been removed before.

        Example:
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> ball = world.add(vx.Sphere(0.1))
            >>> world.remove(ball)
            >>> world.bodies
            []
        """
        if isinstance(what, Joint):
            check_own(what, self._simulation)
            self._simulation.remove_joint(what._number)
            what._world = None
            self.joints.remove(what)
            return
        self._check_own(what, "what")
        for joint in [joint for joint in self.joints if what in (joint.parent, joint.child)]:
            self.remove(joint)
        self._simulation.remove_body(what.number)
        what._world = None
        self.bodies.remove(what)

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
        """Holds two bodies together, or one to the world.

        A joint has a frame in each of its bodies, which coincide at position 0. It is at the child's
        origin where nothing else is said, and at position 0 as the bodies stand now.

        Args:
            joint: What it leaves free: :class:`FixedJoint`, :class:`HingeJoint`, :class:`SliderJoint`
                or :class:`PointJoint`.
            parent: A body, or None for the world.
            child: Another body. One of the two must be dynamic.
            parent_from_joint: (4, 4) pose of the joint in the parent's frame, that of its mesh. Given
                alone, it says how far the joint is from position 0 now.
            child_from_joint: (4, 4) pose of the joint in the child's frame; the identity by default.
            world_from_joint: (4, 4) pose of the joint now, instead of the two above.
            collide: Whether the two bodies collide with each other.
            name: For people; "joint" and its number by default.

        Returns:
            The joint, to read and to drive.

        Raises:
            InputTypeError: ``joint``, ``parent`` or ``child`` is of a wrong type.
            SettingsError: A body is of another world or has been removed, both are the same, or none
                of them can move; or the world's solver is "nncg", under which motors at limits throw
                bodies about.
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
                "Bullet's solver 'nncg' does not hold joints: make the world with another solver"
            )
        if parent is not None:
            self._check_own(parent, "parent")
        self._check_own(child, "child")
        if parent is child:
            raise SettingsError(f"parent and child are both {child.name!r}")
        if child.motion != "dynamic" and (parent is None or parent.motion != "dynamic"):
            raise SettingsError(
                "a joint needs a body that can move: "
                f"{'the world' if parent is None else repr(parent.name)} and {child.name!r} cannot"
            )
        frames = JointFrames(parent_from_joint, child_from_joint, world_from_joint)
        settings = make_settings(joint, parent, child, frames, bool(collide))
        number = self._simulation.add_joint(settings)
        made = Joint(self._simulation, number, name or f"joint {number}", joint, parent, child)
        self.joints.append(made)
        return made

    def set_collision(self, a: Body, b: Body, collide: bool) -> None:
        """Lets two bodies collide with each other or not, whatever else they meet.

        Groups and joints may keep bodies apart that this leaves together.

        Raises:
            InputTypeError: One is no body.
            SettingsError: One is of another world or has been removed, or both are the same.

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
        self._check_own(a, "a")
        self._check_own(b, "b")
        if a is b:
            raise SettingsError(f"a and b are both {a.name!r}")
        self._simulation.set_collision(a.number, b.number, bool(collide))

    def step(
        self,
        n: int = 1,
        callback: Callable[[World], object] | None = None,
        *,
        before: Callable[[World], object] | None = None,
    ) -> None:
        """Advances by ``n`` time steps. Ctrl-C stops it after the step that is under way.

        Args:
            n: How many.
            callback: Called after each step; what it returns does not matter, what it raises ends
                the run.
            before: The same before each step: the place for forces, targets and kinematic poses.

        Raises:
            SettingsError: ``n`` is below 0.
            SimulationError: A body's pose or velocity is no longer finite. The world keeps the state
                that the failed step left.
        """
        count = as_integer(n, "n", 0, 2**31 - 1)
        if self._new:
            self._judge_models()
        view = self._view if self._view is not None and self._view.is_open else None
        if callback is None and before is None and view is None and not self._recorders:
            self._simulation.step(count)
            check_motions(self._simulation, self.bodies, self._advice)
            return
        for _ in range(count):
            if view is not None:
                view.before_step()
            if before is not None:
                before(self)
            self._simulation.step(1)
            check_motions(self._simulation, self.bodies, self._advice)
            for recorder in self._recorders:
                recorder.take()
            if view is not None:
                view.after_step()
            if callback is not None:
                callback(self)

    @property
    def time(self) -> float:
        """Simulated seconds since the world was made: steps times ``time_step``.

        :meth:`restore_state` sets it back to the time of the state.

        Example:
            >>> import voxshell as vx
            >>> world = vx.World(time_step=0.01)
            >>> world.step(25)
            >>> world.time
            0.25
        """
        return self._simulation.step_count() * self.time_step

    @property
    def gravity(self) -> NDArray[np.float64]:
        """The acceleration of free bodies, (3,) float64, m/s2, world frame, read-only.

        Example:
            >>> import voxshell as vx
            >>> vx.World().gravity
            array([ 0.  ,  0.  , -9.81])
        """
        return self._gravity

    def __repr__(self) -> str:
        bodies, joints = len(self.bodies), len(self.joints)
        return (
            f"World({bodies} {'body' if bodies == 1 else 'bodies'}, "
            f"{joints} {'joint' if joints == 1 else 'joints'}, time={self.time:.6g} s, "
            f"time_step={self.time_step:.6g} s)"
        )

    def _judge_models(self) -> None:
        """Warns of pairs of models that may meet, once a pair, where they may miss contacts."""
        new, self._new = self._new, set()
        bodies: Counter[Model] = Counter()
        movers: set[Model] = set()
        for body in self.bodies:
            for model in set(_models_of(body.shape)):
                bodies[model] += 1
                if body.motion != "static":
                    movers.add(model)
        pairs = {
            frozenset((model._serial, other._serial)): (model, other)
            for model in new
            if model in bodies
            for other in bodies
            if (other is not model or bodies[model] > 1) and not movers.isdisjoint((model, other))
        }
        judge_world(pairs[key] for key in pairs.keys() - self._judged)
        self._judged |= pairs.keys()

    def save_state(self) -> WorldState:
        """Takes down all that moves, for :meth:`restore_state`.

        That is: poses, velocities, forces not yet spent, who sleeps and since when; contacts with the
        impulses that the solver begins with; motors and turns of joints; frictions, restitution,
        damping, groups and pairs set apart. Bodies and joints are not in it: they must be the same at
        :meth:`restore_state`.

        After both calls the same steps give the same bits: both lay Bullet's caches (its tree of
        bounds, pairs, contact points) anew from the state alone. This means that a run in which a
        state was saved differs by rounding errors from one without: what a body at rest has learned
        of the place that it lies on is learned again.

        Returns:
            The state; for this world alone.

        Example:
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> ground = world.add(vx.Plane(), mass=0)
            >>> ball = world.add(vx.Sphere(0.1))
            >>> state = world.save_state()
            >>> world.step(100)
            >>> first = ball.pose
            >>> world.restore_state(state)
            >>> world.step(100)
            >>> bool((ball.pose == first).all())
            True
        """
        return WorldState(self._simulation, tuple(self.bodies), tuple(self.joints))

    def restore_state(self, state: WorldState) -> None:
        """Goes back to a state of :meth:`save_state`, as often as one likes.

        Recorders and timings go on; they do not go back.

        Raises:
            InputTypeError: ``state`` is no state.
            SettingsError: It is of another world, or bodies or joints were added or removed since.
        """
        check_same(self._simulation, tuple(self.bodies), tuple(self.joints), state)
        self._simulation.restore(state._state)

    def ray_cast(self, starts: ArrayLike, ends: ArrayLike) -> NDArray[np.void]:
        """What rays meet first, of all bodies as they stand now.

        Models are met at their meshes' triangles, from either side.

        Args:
            starts: (n, 3), metres, world frame; or (3,) for one ray.
            ends: The same.

        Returns:
            (n,) structured array: ``body`` (its number; -1 where a ray meets nothing), ``fraction`` (of
            the way, 0 to 1), ``point`` ((3,), metres, world frame; the end where it meets nothing) and
            ``normal`` ((3,), of the surface, unit; zero where it meets nothing).

        Raises:
            SettingsError: The arrays are not of the same shape, or a number is not finite.

        Example:
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> ground = world.add(vx.Plane(), mass=0)
            >>> hits = world.ray_cast([(0, 0, 2), (0, 0, 2)], [(1, 0, -2), (0, 0, 1)])
            >>> hits["body"].tolist(), hits["fraction"].tolist()
            ([0, -1], [0.5, 1.0])
            >>> hits["point"][0]
            array([0.5, 0. , 0. ])
        """
        first, last = _as_rows(starts, "starts"), _as_rows(ends, "ends")
        if first.shape != last.shape:
            raise SettingsError(
                f"starts and ends must be of the same shape, not {first.shape} and {last.shape}"
            )
        for name, points in (("starts", first), ("ends", last)):
            if not np.isfinite(points).all():
                raise SettingsError(f"{name} must be finite")
        return as_hits(self._simulation.cast_rays(first, last))

    def query_contacts(
        self, a: Body, b: Body | None = None, *, margin: float = 0.0
    ) -> NDArray[np.void]:
        """Where a body touches another, or any other, as they stand now.

        It asks for geometry alone: bodies that are kept apart by groups, pairs or joints are found,
        and the simulation goes on as if nothing had been asked.

        Args:
            a: A body.
            b: Another body; None: all others.
            margin: Metres: places this near count as well, with a negative depth. Of pairs with a
                model, the nearest place is among those that are found.

        Returns:
            As :meth:`contacts`, up to four points of each pair of parts; ``impulse`` is 0.

        Raises:
            InputTypeError: One is no body.
            SettingsError: One is of another world or has been removed, ``margin`` is below 0, or one is
                a :class:`GImpact` and the other that or a plane: Bullet does not tell.

        Example:
            >>> import numpy as np
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> ground = world.add(vx.Plane(), mass=0)
            >>> above = np.eye(4)
            >>> above[2, 3] = 0.15
            >>> ball = world.add(vx.Sphere(0.1), pose=above)
            >>> len(world.query_contacts(ball))
            0
            >>> float(world.query_contacts(ball, margin=0.1)["depth"][0])
            -0.04...
        """
        self._check_own(a, "a")
        reach = as_not_negative(margin, "margin")
        if b is not None:
            self._check_own(b, "b")
        others = [b] if b is not None else [body for body in self.bodies if body is not a]
        for other in others:
            _refuse_unanswered(a, other)
        rows = [self._simulation.find_contacts(a.number, it.number, reach) for it in others]
        return as_contacts(np.concatenate(rows) if rows else np.empty((0, 14)))

    def overlaps(self, a: Body, b: Body) -> bool:
        """Whether two bodies touch or penetrate each other as they stand now.

        Raises:
            InputTypeError: One is no body.
            SettingsError: As for :meth:`query_contacts`.

        Example:
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> a, b = world.add(vx.Sphere(0.1)), world.add(vx.Box((1, 1, 1)))
            >>> world.overlaps(a, b)
            True
        """
        return len(self.query_contacts(a, b)) > 0

    def contacts(self) -> NDArray[np.void]:
        """The contact points after the last step, as Bullet's solver had them.

        Returns:
            (n,) structured array: ``body_a``, ``body_b`` (numbers of bodies), ``id`` (of the shell's
            point), ``point_a``, ``point_b`` and ``normal`` ((3,), metres, world frame, the normal on
            body b and towards body a), ``depth`` (metres, positive where the bodies overlap) and
            ``impulse`` (normal, N s, of the last step).
        """
        return as_contacts(self._simulation.contacts())

    @property
    def timings(self) -> NDArray[np.void]:
        """Seconds of every step since the start or :meth:`clear_timings`, (steps,) structured array.

        Of long runs, the last 100,000 steps.

        ``step`` is all of Bullet's step; ``narrow_phase`` all pairs' collision algorithms, whatever
        the shapes; ``query``, ``reduction`` and ``manifold`` the models' part of that: finding
        contacts, choosing points, handing them to Bullet. Where several threads find contacts,
        ``query`` is the time until all of them are done, and includes the choice of those that touch.
        """
        return as_timings(self._simulation.timings())

    def clear_timings(self) -> None:
        """Forgets the :attr:`timings` so far, as after a warm-up.

        Example:
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> world.step(10)
            >>> world.clear_timings()
            >>> world.step(3)
            >>> len(world.timings)
            3
        """
        self._simulation.clear_timings()

    def record(self, *, every: int = 1) -> Recorder:
        """Starts to record poses and contacts, now and after every ``every`` steps.

        Example:
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> ball = world.add(vx.Sphere(0.1))
            >>> recorder = world.record(every=2)
            >>> world.step(10)
            >>> recorder.recording().frame_count
            6
        """
        recorder = Recorder(
            self._simulation,
            self.time_step,
            tuple(self.bodies),
            as_integer(every, "every", 1, 2**31 - 1),
        )
        self._recorders.append(recorder)
        return recorder

    def view(
        self,
        *,
        port: int = 8080,
        title: str = "voxshell",
        colors: Mapping[Body, tuple[int, int, int]] | None = None,
        frames_per_second: float = 30.0,
        speed: float | None = None,
        paused: bool = False,
        open_browser: bool = False,
    ) -> LiveView:
        """Shows the world in a browser, live, while you call :meth:`step`.

        The page shows bodies, contacts, the force of each contact, and plots of the energy, the number of contacts
        and the greatest depth over time. It has buttons to pause, to make one step and to reset the camera. A body
        that the mouse drags is pulled by a spring; see :class:`voxshell.live_view.LiveView`. A pause blocks
        :meth:`step`. Several browsers may open the page; they share one view.

        A world that is viewed takes the same steps, bit for bit, unless somebody drags a body.

        Args:
            port: Port of the page on this machine, or the next free one; 0: the system picks one.
            title: Heading of the page.
            colors: Red, green and blue, 0 to 255, of bodies; the viewer chooses those of the others.
            frames_per_second: How many times a second the page is updated at most, wall-clock time.
            speed: Simulated seconds in a second while a page is open: :meth:`step` waits where it would be faster.
                None: as fast as the machine can. The page can change it.
            paused: Whether to wait before the first step until somebody presses "Resume" on the page.
            open_browser: Whether to open the page in the default browser of this machine.

        Returns:
            The view. Its ``address`` holds a secret, so that other pages in the browser cannot read the world. It ends
            with its ``close()``, at the end of a ``with`` block, or with the world.

        Raises:
            MissingExtraError: The viewer is not installed.
            SettingsError: A view of this world is open already, or an argument is out of range.

        Example:
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> ground = world.add(vx.Plane(), mass=0)
            >>> ball = world.add(vx.Sphere(0.1), pose=(0, 0, 0.5))
            >>> with world.view(port=0) as view:
            ...     print(view.address)
            ...     world.step(200)
            http://127.0.0.1:...
        """
        if self._view is not None and self._view.is_open:
            raise SettingsError(
                f"this world has a view already, at {self._view.address}; open that address in another browser, or "
                "call its close() first"
            )
        from voxshell.viewer.live_page import LivePage

        number = as_integer(port, "port", 0, 65535)
        view = LiveView(
            self._simulation,
            self.bodies,
            gravity=self._gravity,
            time_step=self.time_step,
            frames_per_second=frames_per_second,
            speed=speed,
            paused=paused,
        )
        view.open(lambda: LivePage(view, port=number, title=title, colors=colors or {}))
        self._view = view
        weakref.finalize(self, view.close)
        if open_browser:
            import webbrowser

            webbrowser.open(view.address)
        return view

    def _check_own(self, body: Body, name: str) -> None:
        if not isinstance(body, Body):
            raise InputTypeError(f"{name} must be a Body, not {type(body).__name__}")
        check_own(body, self._simulation)


def _as_rows(value: ArrayLike, name: str) -> NDArray[np.float64]:
    """Points, (n, 3), of one or many."""
    with suppress(TypeError, ValueError):  # as_points says what is wrong
        value = np.atleast_2d(value)
    return as_points(value, name)


def _refuse_unanswered(a: Body, b: Body) -> None:
    """Of these pairs Bullet's contact test finds nothing, wherever they are."""
    for first, second in ((a, b), (b, a)):
        if isinstance(first.shape, GImpact) and isinstance(second.shape, (GImpact, Plane)):
            raise SettingsError(
                f"Bullet does not tell where {first.name!r}, a GImpact, touches {second.name!r}, a "
                f"{type(second.shape).__name__}, outside of a step: see World.contacts() after one"
            )


def _models_of(shape: Shape) -> list[Model]:
    if isinstance(shape, Compound):
        return [part for part, _ in shape.parts if isinstance(part, Model)]
    return [shape] if isinstance(shape, Model) else []


def _as_reach(value: float) -> float:
    """A length of at least 0, or infinity, metres."""
    return math.inf if value == math.inf else as_not_negative(value, "ccd_motion_threshold")
