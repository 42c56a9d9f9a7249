"""What an everyday scene is made of: bodies, their start, and what is measured against which truth.

Meters, kilograms, seconds, radians; z is up in the world frame. A stage says nothing about an engine:
voxshell, Bullet's own shapes and MuJoCo are given the same bodies, masses, inertias and starts.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Literal

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from voxshell.model.meshes import Mesh

Engine = Literal["voxshell", "bullet", "mujoco"]
ENGINES: tuple[Engine, ...] = ("voxshell", "bullet", "mujoco")
RATES: tuple[float, ...] = (1000.0, 200.0, 60.0, 30.0)
"""Steps a second at which a scene runs unless it says otherwise."""

PieceKind = Literal["box", "sphere", "capsule", "cylinder", "ellipsoid", "hull"]
Vector = tuple[float, float, float]


@dataclass(frozen=True, eq=False)
class Piece:
    """A convex part by which engines without distance fields represent a body.

    Attributes:
        kind: What it is.
        size: "box" and "ellipsoid": three half extents; "sphere": its radius; "capsule" and "cylinder":
            radius and length along z, a capsule's without its caps. Meters.
        pose: (4, 4) ``body_from_piece``.
        points: (n, 3) of a "hull", meters, piece frame.
    """

    kind: PieceKind
    size: tuple[float, ...] = ()
    pose: NDArray[np.float64] = field(default_factory=lambda: np.eye(4))
    points: NDArray[np.float64] | None = None


@dataclass(frozen=True, eq=False)
class Form:
    """A body's surface, and the convex parts that represent it elsewhere.

    Attributes:
        name: Unique; equal names mean equal forms.
        mesh: Of which voxshell makes a model at default settings; None for the half-space below z = 0.
        pieces: The same body for Bullet and MuJoCo; empty where no convex parts represent it.
    """

    name: str
    mesh: Mesh | None
    pieces: tuple[Piece, ...] = ()

    @property
    def is_plane(self) -> bool:
        """Whether it is the half-space."""
        return self.mesh is None

    @property
    def vertices(self) -> NDArray[np.float64]:
        """(n, 3), meters, body frame; empty of the half-space."""
        return np.zeros((0, 3)) if self.mesh is None else self.mesh.vertices


@dataclass(frozen=True, eq=False)
class Joint:
    """What holds a body to the world.

    Attributes:
        kind: "hinge" and "slider" leave an axis free, "point" every rotation.
        at: (3,), meters, world frame.
        axis: (3,), unit, world frame; ignored by "point".
    """

    kind: Literal["hinge", "slider", "point"]
    at: Vector = (0.0, 0.0, 0.0)
    axis: Vector = (0.0, 0.0, 1.0)


@dataclass(frozen=True, eq=False)
class Item:
    """A body of a stage at its start.

    Attributes:
        name: Unique in the stage.
        form: Its surface.
        pose: (4, 4) ``world_from_body``.
        mass: Kilograms; 0 makes it static. Its inertia is that of the uniform solid of its mesh.
        velocity: Of the center of mass, m/s, world frame.
        spin: Angular velocity, rad/s, world frame.
        path: Of a kinematic body: its pose at a time, seconds.
        force: Constant, at the origin of the body, newtons, world frame.
        joint: What holds it to the world, if anything.
        plain: Whether voxshell's world is given Bullet's own shape instead of a model.
    """

    name: str
    form: Form
    pose: NDArray[np.float64] = field(default_factory=lambda: np.eye(4))
    mass: float = 1.0
    velocity: Vector = (0.0, 0.0, 0.0)
    spin: Vector = (0.0, 0.0, 0.0)
    path: Callable[[float], NDArray[np.float64]] | None = None
    force: Vector = (0.0, 0.0, 0.0)
    joint: Joint | None = None
    plain: bool = False

    @property
    def moves(self) -> bool:
        """Whether forces move it."""
        return self.mass > 0.0 and self.path is None


@dataclass(frozen=True, eq=False)
class Stage:
    """Bodies and what acts on them.

    Attributes:
        items: The bodies.
        friction: Coulomb coefficient of every pair.
        restitution: Of every pair.
        gravity: m/s2, world frame.
        facts: Numbers that the truth needs, such as slopes and lengths, by name.
        world_from_ramp: (3, 3): the frame in which motion is measured; x is downhill, z off the ramp.
    """

    items: tuple[Item, ...]
    friction: float = 0.5
    restitution: float = 0.0
    gravity: Vector = (0.0, 0.0, -9.81)
    facts: Mapping[str, float] = field(default_factory=dict)
    world_from_ramp: NDArray[np.float64] = field(default_factory=lambda: np.eye(3))


@dataclass(frozen=True, eq=False)
class Track:
    """What happened: the state after every step.

    Attributes:
        stage: What stood where.
        time_step: Seconds.
        poses: Of each body that forces move, (steps + 1, 4, 4) ``world_from_body``; the first is the start.
        velocities: (steps + 1, 3) of the center of mass, m/s, world frame.
        spins: (steps + 1, 3), rad/s, world frame.
    """

    stage: Stage
    time_step: float
    poses: Mapping[str, NDArray[np.float64]]
    velocities: Mapping[str, NDArray[np.float64]]
    spins: Mapping[str, NDArray[np.float64]]

    @cached_property
    def steps(self) -> int:
        """How many were taken."""
        return len(next(iter(self.poses.values()))) - 1

    @property
    def seconds(self) -> float:
        """That they lasted."""
        return self.steps * self.time_step

    def item(self, name: str) -> Item:
        """The body of that name."""
        return next(item for item in self.stage.items if item.name == name)

    def fact(self, name: str) -> float:
        """A number that the truth needs."""
        return self.stage.facts[name]

    def count(self, seconds: float) -> int:
        """The step that ends nearest to a time, at most the last."""
        return min(round(seconds / self.time_step), self.steps)

    def path(self, name: str) -> NDArray[np.float64]:
        """How far the body's origin is from its start, (steps + 1, 3), meters, ramp frame."""
        places = self.poses[name][:, :3, 3]
        return (places - places[0]) @ self.stage.world_from_ramp

    def turned(self, name: str) -> NDArray[np.float64]:
        """The angle of the rotation since the start, (steps + 1,), radians, 0 to pi."""
        rotations = self.poses[name][:, :3, :3]
        traces = np.einsum("nij,ij->n", rotations, rotations[0])
        return np.arccos(np.clip(0.5 * (traces - 1.0), -1.0, 1.0))

    def lowest(self, name: str, step: int = -1) -> float:
        """The height of the body's lowest vertex over z = 0, meters, world frame."""
        pose = self.poses[name][step]
        return float((self.item(name).form.vertices @ pose[2, :3]).min() + pose[2, 3])


@dataclass(frozen=True, eq=False)
class Measure:
    """A number of a run beside its truth.

    Attributes:
        name: What, in words.
        unit: Of value and truth, after ``scale``; "" for pure numbers.
        value: From the track.
        truth: From the track's stage and time step: a closed form, time-discrete where that differs.
        bar: The largest error that is right: a fraction of the truth where ``relative``, else in the
            unit of ``value``, before ``scale``.
        relative: Whether the error is a fraction of the truth.
        scale: Units in one meter, second, radian, ...
        signed: The error counts only where the value is above (1) or below (-1) the truth; 0: always.
    """

    name: str
    unit: str
    value: Callable[[Track], float]
    truth: Callable[[Track], float]
    bar: float
    relative: bool = False
    scale: float = 1.0
    signed: int = 0

    def error(self, value: float, truth: float) -> float:
        """How far off, as the bar is meant; infinite where there is no finite value.

        Example:
            >>> Measure("distance", "m", lambda _: 0.0, lambda _: 0.0, 0.05, relative=True).error(1.9, 2.0)
            0.05
        """
        if not np.isfinite(value):
            return float("inf")
        error = value - truth
        error = max(self.signed * error, 0.0) if self.signed else abs(error)
        return round(error / abs(truth), 15) if self.relative else error


@dataclass(frozen=True, eq=False)
class EverydayScene:
    """A scene with truths.

    Attributes:
        name: Unique.
        group: Heading below which it is reported.
        law: The truth in words and where it comes from.
        stage: What stands where in a placement; the first is 0.
        seconds: How long it lasts.
        measures: Numbers beside their truths.
        engines: Those that can represent it.
        rates: Steps a second.
        most: Placements, at most.
        shown: Whether its first placement is recorded, at 200 Hz or the nearest rate.
        held_out: Whether someone who has not seen the code chose it, and nothing may be tuned by it.
        smooth: Whether nothing touches, so that MuJoCo can integrate with Runge and Kutta's method.
        needs: Seconds below which the truth does not hold yet, so that short runs must last as long.
        heavy: Whether a step takes milliseconds, so that short runs leave out most of it.
    """

    name: str
    group: str
    law: str
    stage: Callable[[int], Stage]
    seconds: float
    measures: tuple[Measure, ...]
    engines: tuple[Engine, ...] = ENGINES
    rates: tuple[float, ...] = RATES
    most: int = 20
    shown: bool = False
    held_out: bool = False
    smooth: bool = False
    needs: float = 0.0
    heavy: bool = False


# ---- placements ----------------------------------------------------------------------------------

_GOLDEN = 0.5 * (np.sqrt(5.0) - 1.0)


def heading(placement: int) -> float:
    """An angle for a placement, radians: 0 first, then spread evenly however many there are.

    Example:
        >>> [round(heading(i), 3) for i in range(3)]
        [0.0, 3.883, 1.483]
    """
    return float(2.0 * np.pi * (placement * _GOLDEN % 1.0))


def scatter(placement: int, salt: int = 1) -> float:
    """A number of a placement in [-1, 1): 0 first, another sequence for each salt."""
    return float((placement * (_GOLDEN + 0.1 * salt) * (salt + 1) + 0.5) % 1.0 * 2.0 - 1.0)


def turn(axis: Vector, angle: float) -> NDArray[np.float64]:
    """The rotation about a unit axis through the origin, (4, 4); radians."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    pose = np.eye(4)
    pose[:3, :3] += np.sin(angle) * cross + (1.0 - np.cos(angle)) * (cross @ cross)
    return pose


def shift(x: float, y: float, z: float) -> NDArray[np.float64]:
    """The translation, (4, 4); meters."""
    pose = np.eye(4)
    pose[:3, 3] = x, y, z
    return pose


X: Vector = (1.0, 0.0, 0.0)
Y: Vector = (0.0, 1.0, 0.0)
Z: Vector = (0.0, 0.0, 1.0)
