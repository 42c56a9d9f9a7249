"""Simulation in stock Bullet: bodies made of models, analytic shapes and Bullet's own shapes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

import numpy as np

from voxshell import _bullet
from voxshell._arguments import as_floats, as_integer, as_positive, as_real, as_vector
from voxshell.body_shapes import compute_mass_properties, make_geometry
from voxshell.comparison_shapes import as_margin
from voxshell.errors import PoseError, SettingsError
from voxshell.recorder import Recorder
from voxshell.shapes import Plane

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

    from voxshell.body_shapes import Inertia, Shape

BULLET_VERSION = f"{_bullet.bullet_version / 100:.2f}, double precision"
"""Of the library that simulates."""

CONTACT_DTYPE = np.dtype(
    [
        ("body_a", np.int32),
        ("body_b", np.int32),
        ("id", np.int32),
        ("point_a", np.float64, 3),
        ("point_b", np.float64, 3),
        ("normal", np.float64, 3),
        ("depth", np.float64),
        ("impulse", np.float64),
    ]
)
TIMINGS_DTYPE = np.dtype(
    [(name, np.float64) for name in ("step", "narrow_phase", "query", "reduction", "manifold")]
)

_CONTACT_MODES = {
    "auto": _bullet.ContactMode.AUTO,
    "regular": _bullet.ContactMode.REGULAR,
    "segmented": _bullet.ContactMode.SEGMENTED,
}
_SOLVERS = {
    "sequential_impulse": _bullet.ConstraintSolver.SEQUENTIAL_IMPULSE,
    "nncg": _bullet.ConstraintSolver.NNCG,
    "dantzig": _bullet.ConstraintSolver.DANTZIG,
    "projected_gauss_seidel": _bullet.ConstraintSolver.PROJECTED_GAUSS_SEIDEL,
}
_MOST_LEVELS = 12
_MOST_ITERATIONS = 1_000_000


class Body:
    """A body of a :class:`World`; made by :meth:`World.add`.

    Its origin and axes are those of its mesh or shape: where the centre of mass lies is the world's
    business.

    Attributes:
        number: Its place in ``World.bodies``, and its number in ``World.contacts()``.
        name: For people.
        shape: What it is made of; may be shared with other bodies.
        mass: Kilograms; 0 for a static body.
    """

    __slots__ = ("_simulation", "mass", "name", "number", "shape")

    def __init__(
        self, simulation: _bullet.Simulation, number: int, name: str, shape: Shape, mass: float
    ) -> None:
        self._simulation = simulation
        self.number = number
        self.name = name
        self.shape = shape
        self.mass = mass

    @property
    def pose(self) -> NDArray[np.float64]:
        """``world_from_body``, (4, 4) float64. Setting it wakes the body.

        Raises:
            PoseError: It is set to what is not a rigid transform.
        """
        return self._simulation.pose(self.number)

    @pose.setter
    def pose(self, value: ArrayLike) -> None:
        self._simulation.set_pose(self.number, as_floats(value, "pose", (4, 4), PoseError))

    @property
    def linear_velocity(self) -> NDArray[np.float64]:
        """Of the centre of mass, (3,) float64, m/s, world frame. Setting it wakes the body."""
        return np.array(self._simulation.linear_velocity(self.number))

    @linear_velocity.setter
    def linear_velocity(self, value: ArrayLike) -> None:
        self._simulation.set_linear_velocity(self.number, as_vector(value, "linear_velocity"))

    @property
    def angular_velocity(self) -> NDArray[np.float64]:
        """(3,) float64, rad/s, world frame. Setting it wakes the body."""
        return np.array(self._simulation.angular_velocity(self.number))

    @angular_velocity.setter
    def angular_velocity(self, value: ArrayLike) -> None:
        self._simulation.set_angular_velocity(self.number, as_vector(value, "angular_velocity"))

    @property
    def sleeping(self) -> bool:
        """Whether Bullet has put the body to sleep."""
        return self._simulation.is_asleep(self.number)

    def __repr__(self) -> str:
        return f"Body({self.number}, {self.name!r}, {self.shape!r}, mass={self.mass:g})"


class World:
    """A world of stock Bullet (double precision) in which models collide.

    Args:
        gravity: (3,), m/s2, world frame.
        time_step: Seconds a step.
        contact: How contacts of models become Bullet's contact points. "regular": the deepest and
            those that span the largest area, four at most; "segmented": the deepest of each cluster
            of the point-sphere tree at ``level``, or up to four of each where a body lies still on few;
            "auto": what rests most calmly, now segmented.
        level: The level, 1 to 12, for segmented contacts; 4 by default, up to 64 clusters.
        margin: How near slow points count as contacts, metres; a thousandth of the shell's diameter
            by default. Without it, resting bodies rock.
        sweep_beyond: Where bodies move farther than this in a step, metres, points that will touch
            within the step are contacts before they do, so that nothing tunnels; a voxel by default.
            Infinity: never, as the thesis does it.
        sleeping: Whether bodies at rest are put to sleep.
        split_impulse_threshold: Bullet's m_splitImpulsePenetrationThreshold, metres. At 0, its value
            here, penetration is resolved without adding velocity, which models need to rebound
            truly; -0.04 is Bullet's own default.
        solver: Bullet's solver of constraints. "sequential_impulse" is its default; "nncg" follows
            conjugate gradients; "dantzig" solves all of an island's constraints as one problem,
            exactly, in a time that grows with the cube of their number; "projected_gauss_seidel"
            solves that problem step by step.
        iterations: Of the solver a step, at least 1. Bullet's own default of 10 is enough for single
            bodies; stacks and machines want the 50 here, pybullet's default. "dantzig" does without.

    Raises:
        SettingsError: A setting is out of range.

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
        level: int | None = None,
        margin: float | None = None,
        sweep_beyond: float | None = None,
        sleeping: bool = True,
        split_impulse_threshold: float = 0.0,
        solver: Literal[
            "sequential_impulse", "nncg", "dantzig", "projected_gauss_seidel"
        ] = "sequential_impulse",
        iterations: int = 50,
    ) -> None:
        if solver not in _SOLVERS:
            raise SettingsError(
                f"solver must be one of {', '.join(map(repr, _SOLVERS))}, not {solver!r}"
            )
        if contact not in _CONTACT_MODES:
            raise SettingsError(
                f"contact must be one of {', '.join(map(repr, _CONTACT_MODES))}, not {contact!r}"
            )
        if level is not None and contact == "regular":
            raise SettingsError("level is for segmented contacts; leave it out or change contact")
        self.time_step = as_positive(time_step, "time_step")
        self.bodies: list[Body] = []
        self._recorders: list[Recorder] = []
        self._simulation = _bullet.Simulation(
            gravity=as_vector(gravity, "gravity"),
            time_step=self.time_step,
            sleeping=bool(sleeping),
            split_impulse_threshold=as_real(split_impulse_threshold, "split_impulse_threshold"),
            solver=_SOLVERS[solver],
            iterations=as_integer(iterations, "iterations", 1, _MOST_ITERATIONS),
            mode=_CONTACT_MODES[contact],
            level=0 if level is None else as_integer(level, "level", 1, _MOST_LEVELS),
            margin=-1.0 if margin is None else as_margin(margin),
            sweep_beyond=-1.0 if sweep_beyond is None else _as_reach(sweep_beyond),
        )

    def add(
        self,
        shape: Shape,
        *,
        mass: float = 1.0,
        pose: ArrayLike | None = None,
        friction: float = 0.5,
        restitution: float = 0.0,
        inertia: Inertia = "solid",
        name: str | None = None,
    ) -> Body:
        """Adds a body.

        Args:
            shape: A model, an analytic shape, or one of Bullet's shapes for comparison.
            mass: Kilograms; 0 makes the body static.
            pose: (4, 4) ``world_from_body``; the identity by default.
            friction: Coulomb coefficient; Bullet multiplies those of the two bodies.
            restitution: 0 to 1; Bullet multiplies those of the two bodies.
            inertia: Of the uniform solid, of a thin skin on the surface, or given: then its mass is
                replaced by ``mass``.
            name: For people; "body" and its number by default.

        Returns:
            The body.

        Raises:
            InputTypeError: ``shape`` cannot be simulated.
            SettingsError: A number is out of range, or a plane is given a mass.
            PoseError: ``pose`` is not a rigid transform.
        """
        kilograms = as_real(mass, "mass")
        if kilograms < 0.0:
            raise SettingsError(f"mass must be at least 0, not {kilograms:g}")
        if isinstance(shape, Plane) and kilograms > 0.0:
            raise SettingsError("a plane has no end and cannot move: pass mass=0")
        bounce = as_real(restitution, "restitution")
        if not 0.0 <= bounce <= 1.0:
            raise SettingsError(f"restitution must be from 0 to 1, not {bounce:g}")
        grip = as_real(friction, "friction")
        if grip < 0.0:
            raise SettingsError(f"friction must be at least 0, not {grip:g}")
        geometry = make_geometry(shape)
        matter = compute_mass_properties(shape, kilograms, inertia)
        world_from_body = np.eye(4) if pose is None else as_floats(pose, "pose", (4, 4), PoseError)
        number = self._simulation.add_body(
            geometry,
            mass=kilograms,
            centre_of_mass=matter.center_of_mass.tolist(),
            inertia=matter.inertia.tolist(),
            pose=world_from_body,
            friction=grip,
            restitution=bounce,
        )
        body = Body(self._simulation, number, name or f"body {number}", shape, kilograms)
        self.bodies.append(body)
        return body

    def step(self, n: int = 1, callback: Callable[[World], object] | None = None) -> None:
        """Advances by ``n`` time steps. Ctrl-C stops between steps.

        Args:
            n: How many.
            callback: Called after each step; what it returns does not matter, what it raises ends
                the run.

        Raises:
            SettingsError: ``n`` is below 0.
        """
        count = as_integer(n, "n", 0, 2**31 - 1)
        if callback is None and not self._recorders:
            self._simulation.step(count)
            return
        for _ in range(count):
            self._simulation.step(1)
            for recorder in self._recorders:
                recorder.take()
            if callback is not None:
                callback(self)

    def contacts(self) -> NDArray[np.void]:
        """The contact points after the last step, as Bullet's solver had them.

        Returns:
            (n,) structured array: ``body_a``, ``body_b`` (numbers of bodies), ``id`` (of the shell's
            point), ``point_a``, ``point_b`` and ``normal`` ((3,), metres, world frame, the normal on
            body b and towards body a), ``depth`` (metres, positive where the bodies overlap) and
            ``impulse`` (normal, N s, of the last step).
        """
        rows = self._simulation.contacts()
        contacts = np.empty(len(rows), CONTACT_DTYPE)
        contacts["body_a"], contacts["body_b"], contacts["id"] = rows[:, 0], rows[:, 1], rows[:, 2]
        contacts["point_a"], contacts["point_b"] = rows[:, 3:6], rows[:, 6:9]
        contacts["normal"] = rows[:, 9:12]
        contacts["depth"], contacts["impulse"] = rows[:, 12], rows[:, 13]
        return contacts

    @property
    def timings(self) -> NDArray[np.void]:
        """Seconds of every step since the start or :meth:`clear_timings`, (steps,) structured array.

        Of long runs, the last 100,000 steps.

        ``step`` is all of Bullet's step; ``narrow_phase`` all pairs' collision algorithms, whatever
        the shapes; ``query``, ``reduction`` and ``manifold`` the models' part of that: finding
        contacts, choosing points, handing them to Bullet.
        """
        return self._simulation.timings().view(TIMINGS_DTYPE)[:, 0]

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
        recorder = Recorder(self, as_integer(every, "every", 1, 2**31 - 1))
        self._recorders.append(recorder)
        return recorder


def _as_reach(value: float) -> float:
    """A length of at least 0, or infinity, metres."""
    return math.inf if value == math.inf else as_margin(value, "sweep_beyond")
