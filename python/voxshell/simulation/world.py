"""Simulation in stock Bullet: bodies of models, analytic shapes and Bullet's own, and their joints."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal

import numpy as np

from voxshell import _bullet
from voxshell.base.arguments import (
    as_integer,
    as_not_negative,
    as_positive,
    as_real,
    as_threads,
    as_vector,
)
from voxshell.errors import SettingsError
from voxshell.simulation.limits import check_fall, check_motions
from voxshell.simulation.recorder import Recorder
from voxshell.simulation.state import WorldState, check_same
from voxshell.simulation.world_view import ViewedWorld

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import ArrayLike, NDArray

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


class World(ViewedWorld):
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

    Attributes:
        bodies: Its bodies, in the order in which they were added.
        joints: Its joints, likewise.
        time_step: Seconds a step.

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
        self._advice = "" if solver == "coulomb" else ", or the solver 'coulomb'"
        self._recorders: list[Recorder] = []
        simulation = _bullet.Simulation(
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
        super().__init__(
            simulation,
            moves_surfaces=solver == "coulomb" and directions == 2,
            takes_joints=solver != "nncg",
            judges_pairs=shell == "auto",
        )

    def _fixed_iterations(self) -> int:
        """Those of solvers that do not find out how many they need."""
        return max(50, min(round(1500.0 * self.time_step), _MOST_ITERATIONS))

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
        if self._pairs is not None:
            self._pairs.judge(self.bodies)
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


def _as_reach(value: float) -> float:
    """A length of at least 0, or infinity, metres."""
    return math.inf if value == math.inf else as_not_negative(value, "ccd_motion_threshold")
