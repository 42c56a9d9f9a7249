"""Simulation in stock Bullet: worlds with bodies and joints."""

from __future__ import annotations

import math
import weakref
from typing import TYPE_CHECKING, Any, Literal, NoReturn

import numpy as np

from voxshell import _bullet
from voxshell.base.arguments import (
    as_choice,
    as_flag,
    as_integer,
    as_not_negative,
    as_positive,
    as_real,
    as_threads,
    check_callable,
    is_infinite,
)
from voxshell.base.calls import check_takes, explain_calls
from voxshell.base.near_names import know_near_names
from voxshell.base.notebook import make_table
from voxshell.errors import InputTypeError, SettingsError
from voxshell.simulation.body_properties import read_only
from voxshell.simulation.forks import Using
from voxshell.simulation.limits import (
    as_gravity,
    check_gravity,
    check_motions,
    check_time_step,
    doubt_gravity,
)
from voxshell.simulation.recorder import Recorder
from voxshell.simulation.world_states import WorldWithStates

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

BULLET_VERSION = f"{_bullet.bullet_version / 100:.2f}, double precision"
"""Version of the Bullet library in use."""

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
_ARGUMENTS = {
    "effort": "default of iterations",
    "mode": "contact",
    "two_friction_directions": "friction_directions",
}
"""Names of settings where those of the bindings are others."""
_MOST_LEVELS = 12
_MOST_ITERATIONS = 1_000_000


@explain_calls
@know_near_names
class World(WorldWithStates):
    """A world of stock Bullet (double precision) in which models collide.

    Freely rotating bodies keep their angular momentum and energy.

    Threads may share a world. Calls run one at a time, :meth:`step` lets other calls run between
    steps, and every call sees the state between two steps. Using a body that another thread has
    removed raises :class:`SettingsError`. Callbacks of :meth:`step` may use the world.

    Args:
        time_step: Seconds per step: 1/200 for 200 steps a second.
        gravity: (3,), m/s2, world frame.
        contact: How contacts of models become Bullet's contact points. "regular": the deepest and
            those that span the largest area, at most four; steps with CCD are segmented here, too.
            "segmented": the deepest of each cluster of the point-sphere tree at ``level``, or up to
            four of each if a body rests on few.
            "auto": the mode in which bodies rest best, at present segmented with up to four points
            each on few clusters, whether bodies move or not.
        shell: The model of a pair whose points are tested. "auto": the model whose shell misses
            less, or both if neither is sufficient alone. "fewest": the model with fewer points, as
            in the thesis.
        level: Level of segmented contacts, 1 to 12. The default is 4, which is up to 64 clusters;
            "auto" uses 5 in steps with fast bodies.
        margin: Distance within which slow points count as contacts, meters. The default is a
            thousandth of the smaller body's diameter, but at most a 20th of either body's
            thickness. Without a margin, resting bodies rock.
        ccd_motion_threshold: Displacement in a step from which a pair of bodies gets continuous
            collision detection (CCD), meters. Points that will touch within the step become
            speculative contacts, so that nothing tunnels. The default is the smallest of a tenth of
            a model's thickness, a 200th of its longest side, and a 16th of the inner radius of a
            box, ball or hull; for pairs with restitution, at most the margin. Infinity turns CCD
            off, as in the thesis.
        sleeping: Put bodies to sleep that have hardly moved for two seconds.
        split_impulse_threshold: Bullet's m_splitImpulsePenetrationThreshold, meters. The default 0
            resolves penetration without adding velocity, which models need for correct rebounds.
            Bullet's own default is -0.04.
        solver: The constraint solver. "coulomb" is Bullet's sequential impulse solver with
            Coulomb's friction, equal in every direction. The others are Bullet's own; with them,
            bodies with many contact points have too much friction. "sequential_impulse" is Bullet's
            default. "nncg" uses conjugate gradients, supports no joints, and may diverge. "dantzig"
            solves all constraints of an island exactly, as one problem, in a time that grows with
            the cube of their number. "projected_gauss_seidel" solves that problem iteratively.
        iterations: Iterations of the solver per step, at least 1. By default "coulomb" makes 10. If
            the contacts are not solved by then, as with heavy bodies on light ones, it continues
            with Newton's method until they are. The others make 50, pybullet's default, and
            proportionally more in steps longer than a 30th of a second. "dantzig" needs none.
        friction_directions: Number of directions in which each contact resists sliding: 2 fixed
            ones, or 1, the direction of sliding, which is Bullet's default. With 1, gripped bodies
            creep, but convex hulls of few vertices come to rest sooner.
        threads: Number of threads that find contacts of models, up to 1024; one per CPU core by
            default. Few pairs of bodies use only one thread. The number does not affect the result.

    Raises:
        SettingsError: A setting is out of range.

    Warns:
        AccuracyWarning: ``time_step`` is above a 20th of a second; above 1 s, it is nearly always a
            rate. Or a pair of
            models may miss contacts that are deep compared with the smaller model's thickness;
            warned at the first step with the pair. Or a body turns by more than an eighth of a turn
            in a step, or moves so far in a step that Bullet stops simulating it; warned once per
            body.
        UnitWarning: ``gravity`` is above 1000 m/s2, as in mm/s2.

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

    __slots__ = ("_advice", "_recorders")

    def __init__(
        self,
        time_step: float = 1.0 / 200.0,
        *,
        gravity: ArrayLike = (0.0, 0.0, -9.81),
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
        as_choice(solver, "solver", _SOLVERS)
        as_choice(contact, "contact", _CONTACT_MODES)
        as_choice(shell, "shell", _SHELL_RULES)
        if level is not None and contact == "regular":
            raise SettingsError(
                "level has no effect with contact='regular'; leave it out, or pass contact='segmented'"
            )
        directions = as_integer(friction_directions, "friction_directions", 1, 2)
        self._time_step = as_positive(time_step, "time_step")
        acceleration = as_gravity(gravity)
        check_time_step(self.time_step, acceleration)
        doubt_gravity(acceleration)
        as_needed = iterations is None and solver == "coulomb"
        if iterations is None:
            iterations = 10 if as_needed else self._fixed_iterations()
        self._advice = "" if solver == "coulomb" else ", or the solver 'coulomb'"
        self._view = None
        # Weak references: a recorder that nobody else refers to stops recording.
        self._recorders: list[weakref.ref[Recorder]] = []
        settings: dict[str, Any] = {
            "time_step": self.time_step,
            "sleeping": as_flag(sleeping, "sleeping"),
            "split_impulse_threshold": as_real(split_impulse_threshold, "split_impulse_threshold"),
            "solver": _SOLVERS[solver],
            "iterations": as_integer(iterations, "iterations", 1, _MOST_ITERATIONS),
            "effort": _bullet.SolverEffort.AS_NEEDED if as_needed else _bullet.SolverEffort.FIXED,
            "two_friction_directions": directions == 2,
            "mode": _CONTACT_MODES[contact],
            "shell": _SHELL_RULES[shell],
            "level": 0 if level is None else as_integer(level, "level", 1, _MOST_LEVELS),
            "margin": -1.0 if margin is None else as_not_negative(margin, "margin"),
            "ccd_motion_threshold": -1.0
            if ccd_motion_threshold is None
            else _as_reach(ccd_motion_threshold),
        }
        simulation = _bullet.Simulation(
            gravity=acceleration, threads=as_threads(threads), **settings
        )
        self._settings = {
            _ARGUMENTS.get(name, name): getattr(value, "name", value)
            for name, value in settings.items()
        }
        super().__init__(
            simulation,
            moves_surfaces=solver == "coulomb" and directions == 2,
            takes_joints=solver != "nncg",
            takes_armature=solver == "coulomb",
            judges_pairs=shell == "auto",
        )

    def _fixed_iterations(self) -> int:
        """Return the number of iterations for solvers that do not choose it themselves."""
        return max(50, min(round(1500.0 * self.time_step), _MOST_ITERATIONS))

    def step(
        self,
        n: int = 1,
        callback: Callable[[World], object] | None = None,
        *,
        before: Callable[[World], object] | None = None,
    ) -> None:
        """Advance by ``n`` time steps. Ctrl-C stops the run after the current step.

        Args:
            n: Number of steps.
            callback: Called after each step. Its return value is ignored; an exception ends the
                run.
            before: Likewise, called before each step. Set forces, targets and kinematic poses here.

        Raises:
            SettingsError: ``n`` is below 0.
            InputTypeError: ``callback`` or ``before`` cannot be called with the world.
            SimulationError: A body's pose or velocity is no longer finite. The world keeps the
                state of the failed step. Or the process is the child of a fork during a step.
        """
        count = as_integer(n, "n, the number of steps,", 0, 2**31 - 1)
        check_callable(callback, "callback")
        check_callable(before, "before")
        if self._pairs is not None:
            self._pairs.judge(self._bodies, self._joints)
        view = self._view if self._view is not None and self._view.is_open else None
        if callback is None and before is None and view is None and not self._find_recorders():
            with Using(self):
                self._simulation.step(count)
            check_motions(self._simulation, self._bodies, self._advice)
            return
        try:
            for _ in range(count):
                if view is not None:
                    view.before_step()
                if before is not None:
                    before(self)
                with Using(self):
                    self._simulation.step(1)
                check_motions(self._simulation, self._bodies, self._advice)
                self._take_frames()
                if view is not None:
                    view.after_step()
                if callback is not None:
                    callback(self)
        except TypeError:
            check_takes(self, "the world", callback=callback, before=before)
            raise

    @property
    def time(self) -> float:
        """Simulated seconds since the world was made: number of steps times ``time_step``.

        :meth:`restore_state` resets it to the time of the state.

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
        """The acceleration of free bodies, (3,) float64, m/s2, world frame, read-only; settable.

        A change acts from the next step on, and wakes all bodies. :meth:`restore_state` returns to the
        gravity of the state.

        Raises:
            SettingsError: The new gravity is not three finite numbers, or would move bodies by more
                than 1e5 m in the first step.

        Warns:
            UnitWarning: The new gravity is above 1000 m/s2, as in mm/s2.

        Example:
            >>> import voxshell as vx
            >>> world = vx.World()
            >>> world.gravity
            array([ 0.  ,  0.  , -9.81])
            >>> ball = world.add(vx.Sphere(0.1))
            >>> world.gravity = (0, 0, 0)
            >>> world.step(100)
            >>> ball.position
            array([0., 0., 0.])
        """
        return read_only(np.array(self._simulation.gravity()))

    @gravity.setter
    def gravity(self, value: ArrayLike) -> None:
        acceleration = as_gravity(value)
        check_gravity(self.time_step, acceleration)
        doubt_gravity(acceleration)
        self._simulation.set_gravity(acceleration)

    def __reduce__(self) -> NoReturn:
        raise InputTypeError(
            "a World cannot be copied or pickled: make another one and add the same bodies, which may share their "
            "shapes; to return to an earlier state, use save_state() and restore_state()"
        )

    def __repr__(self) -> str:
        bodies, joints = len(self._bodies), len(self._joints)
        return (
            f"World({bodies} {'body' if bodies == 1 else 'bodies'}, "
            f"{joints} {'joint' if joints == 1 else 'joints'}, time={self.time:.6g} s, "
            f"time_step={self.time_step:.6g} s)"
        )

    def _repr_html_(self) -> str:
        """Return a table of facts for notebooks."""
        x, y, z = self.gravity
        return make_table(
            "World",
            {
                "bodies": f"{len(self._bodies)}",
                "joints": f"{len(self._joints)}",
                "time": f"{self.time:.6g} s",
                "time step": f"{self.time_step:.6g} s",
                "gravity": f"({x:.4g}, {y:.4g}, {z:.4g}) m/s2",
            },
        )

    def record(self, *, every: int = 1) -> Recorder:
        """Start to record poses and contacts, now and after every ``every`` steps.

        Keep the recorder: it records until its :meth:`Recorder.stop`, or until nothing refers to it
        any more. Bodies that you add later are recorded from the next frame on; the recording shows
        them from there. Removed bodies stay at their last pose.

        Args:
            every: Steps from one recorded frame to the next, at least 1.

        Raises:
            SettingsError: ``every`` is below 1 or not an integer.

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
            self._bodies,
            as_integer(every, "every", 1, 2**31 - 1),
        )
        self._recorders.append(weakref.ref(recorder, self._recorders.remove))
        return recorder

    def _find_recorders(self) -> list[Recorder]:
        """Return the recorders that are in use and not stopped."""
        if not self._recorders:  # as in most steps
            return []
        in_use = (reference() for reference in tuple(self._recorders))
        return [recorder for recorder in in_use if recorder is not None and not recorder.stopped]

    def _take_frames(self) -> None:
        for recorder in self._find_recorders():
            recorder.take()


def _as_reach(value: float) -> float:
    """Return a length of at least 0, or infinity, meters."""
    return math.inf if is_infinite(value) else as_not_negative(value, "ccd_motion_threshold")
