"""Low rates: the lowest number of steps per second at which the ground carries the bunny."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from voxshell.base.arguments import as_positive
from voxshell.errors import SettingsError
from voxshell.model.shapes import Plane
from voxshell.simulation.world import World

from voxshell_studies.motion import tabulate
from voxshell_studies.part import Part
from voxshell_studies.scenes.bunny import BunnySettings, build_block, compute_pose, find_lowest

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from voxshell.model.meshes import Mesh
    from voxshell.simulation.body import Body

    from voxshell_studies.part import Columns, Tables

Rule = Literal["published", "voxshell"]
RULES: tuple[Rule, ...] = ("published", "voxshell")
Ground = Literal["plane", "slab"]
GROUNDS: tuple[Ground, ...] = ("plane", "slab")

SLAB_HALF_EXTENTS = (0.5, 0.5, 0.025)
"""Thickness of the slab, meters: less than the displacement in a step at low rates."""

LEVELS = (1, 2, 3, 4, 5)
MODES = (*(f"level {level}" for level in LEVELS), "regular", "auto")
"""Contact modes; the last exists only in voxshell."""

SHOWN: tuple[tuple[Rule, str, float], ...] = (
    ("published", "level 1", 30.0),
    ("published", "level 1", 10.0),
    ("published", "level 5", 10.0),
    ("voxshell", "auto", 10.0),
    ("voxshell", "auto", 5.0),
)
"""Rule, mode and rate of the falls in the replay."""

SHOWN_SECONDS = 2.0
THROWN_MODES = ("auto", "regular")
LEAST_STEPS = 25
"""Smallest number of steps in a run: a landing takes a few dozen steps to come to rest."""

REST_SECONDS = 0.5
"""Final steps of a run that count as rest."""


@dataclass(frozen=True)
class RatesSettings(BunnySettings):
    """Settings of the low rates.

    Attributes:
        height: Initial height of the lowest vertex, meters.
        rates: Steps per second to try, descending.
        seconds: Duration of each run.
        throw_speeds: Initial downward speeds of throws, m/s.
        throw_rate: Steps per second of throws.
    """

    orientations: int = 10
    height: float = 0.5
    rates: tuple[float, ...] = (200, 100, 60, 50, 40, 30, 25, 20, 15, 10, 7.5, 5, 3, 2, 1)
    seconds: float = 5.0
    throw_speeds: tuple[float, ...] = (5.0, 50.0)
    throw_rate: float = 60.0

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("height", "seconds", "throw_rate"):
            as_positive(getattr(self, name), name)
        if not self.rates or sorted(set(self.rates), reverse=True) != list(self.rates):
            raise SettingsError(f"rates must descend, not {self.rates}")
        if min(self.rates) <= 0.0:
            raise SettingsError(f"rates must be above 0, not {self.rates}")


def plan(settings: RatesSettings) -> list[Part]:
    """Return a part for each rule, ground and contact mode, and one for the replay."""
    cost = 2e-4 * settings.orientations * settings.seconds * sum(settings.rates)
    falls = [
        Part(
            f"fall-{rule}-{ground}-{mode}",
            run_falls,
            {"settings": settings, "rule": rule, "ground": ground, "mode": mode},
            cost=cost,
        )
        for rule in RULES
        for ground in GROUNDS
        for mode in modes_of(rule)
    ]
    throws = [
        Part(
            f"throw-{ground}-{mode}",
            run_throws,
            {"settings": settings, "ground": ground, "mode": mode},
            cost=cost / 4,
        )
        for ground in GROUNDS
        for mode in THROWN_MODES
    ]
    return [*falls, *throws, Part("shown", record_falls, {"settings": settings}, cost=0.5)]


def modes_of(rule: Rule) -> tuple[str, ...]:
    """Return the :data:`MODES` for a rule."""
    return MODES if rule == "voxshell" else MODES[:-1]


def run_falls(settings: RatesSettings, rule: Rule, ground: Ground, mode: str) -> Tables:
    """Run every rate and orientation from rest."""
    return _tabulate(
        [
            (rate, 0.0, orientation)
            for rate in settings.rates
            for orientation in range(settings.orientations)
        ],
        settings,
        rule,
        ground,
        mode,
    )


def run_throws(settings: RatesSettings, ground: Ground, mode: str) -> Tables:
    """Run every speed and orientation, at one rate, with our rule."""
    return _tabulate(
        [
            (settings.throw_rate, speed, orientation)
            for speed in settings.throw_speeds
            for orientation in range(settings.orientations)
        ],
        settings,
        "voxshell",
        ground,
        mode,
    )


def record_falls(settings: RatesSettings) -> Tables:
    """Return upright falls on the half-space: "N_poses", "N_contacts" of :data:`SHOWN` [N]."""
    tables: dict[str, Columns] = {}
    for number, (rule, mode, rate) in enumerate(SHOWN):
        world, _ = _build_world(settings, rule, "plane", mode, rate, 0.0, 0)
        recorder = world.record()
        world.step(round(SHOWN_SECONDS * rate))
        for name, columns in tabulate(recorder.recording()).items():
            tables[f"{number}_{name}"] = columns
    return tables


def _tabulate(
    cases: list[tuple[float, float, int]],
    settings: RatesSettings,
    rule: Rule,
    ground: Ground,
    mode: str,
) -> Tables:
    rows = []
    for rate, speed, orientation in cases:
        world, body = _build_world(settings, rule, ground, mode, rate, speed, orientation)
        steps = _count_steps(settings, rate)
        lowest, over, middle, sideways = _land(world, body, settings.build_mesh(), ground, steps)
        rest = lowest[-max(round(REST_SECONDS * rate), 2) :]
        first = int(np.argmax(lowest <= 0.0))
        later = over[first + 1 :].min(initial=0.0)
        depths = (-over.min(initial=0.0), -later, -rest.min())
        rows.append((rate, speed, orientation, *depths, middle[-1], sideways[-1]))
    names = ("deepest", "later_depth", "rest_depth", "middle", "sideways")
    names = ("rate", "speed", "orientation", *names)
    return {"runs": dict(zip(names, np.array(rows).T, strict=True))}


def _count_steps(settings: RatesSettings, rate: float) -> int:
    """Return the number of steps that suffices to come to rest."""
    return max(round(settings.seconds * rate), LEAST_STEPS)


def _land(
    world: World, body: Body, mesh: Mesh, ground: Ground, steps: int
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Simulate a fall.

    Returns:
        For each step, meters: the height of the lowest vertex, that of the lowest vertex above the
        ground (infinity if there is none), that of the center of mass, and its sideways
        displacement.
    """
    lowest, over, middle, sideways = np.zeros((4, steps))
    reach = float(np.linalg.norm(mesh.vertices, axis=1).max())
    for step in range(steps):
        world.step()
        pose = body.pose
        middle[step] = pose[2, 3]
        sideways[step] = math.hypot(pose[0, 3], pose[1, 3])
        lowest[step] = over[step] = find_lowest(mesh, pose)
        if ground == "slab" and sideways[step] + reach > min(SLAB_HALF_EXTENTS[:2]):
            over[step] = _find_lowest_over_slab(mesh, pose)
    return lowest, over, middle, sideways


def _find_lowest_over_slab(mesh: Mesh, pose: NDArray[np.float64]) -> float:
    vertices = mesh.vertices @ pose[:3, :3].T + pose[:3, 3]
    is_over = (np.abs(vertices[:, :2]) <= SLAB_HALF_EXTENTS[:2]).all(axis=1)
    return float(vertices[is_over, 2].min(initial=math.inf))


def _build_world(
    settings: RatesSettings,
    rule: Rule,
    ground: Ground,
    mode: str,
    rate: float,
    speed: float,
    orientation: int,
) -> tuple[World, Body]:
    world = World(
        shell="fewest", time_step=1.0 / rate, sleeping=False, **_contact_arguments(rule, mode)
    )
    if ground == "plane":
        world.add(Plane(), mass=0.0, name="ground")
    else:
        pose = np.eye(4)
        pose[2, 3] = -SLAB_HALF_EXTENTS[2]
        world.add(
            build_block(SLAB_HALF_EXTENTS, settings.voxel_size), mass=0.0, pose=pose, name="ground"
        )
    body = world.add(
        settings.build_model(),
        mass=settings.mass,
        pose=compute_pose(settings.build_mesh(), orientation, settings.height),
        inertia=settings.mass_properties,
        name="bunny",
    )
    body.linear_velocity = (0.0, 0.0, -speed)
    return world, body


def _contact_arguments(rule: Rule, mode: str) -> dict[str, Any]:
    """Return a rule and a mode as arguments of World."""
    arguments: dict[str, Any] = {"contact": mode}
    if mode.startswith("level "):
        arguments = {"contact": "segmented", "level": int(mode.removeprefix("level "))}
    if rule == "published":
        arguments |= {"margin": 0.0, "ccd_motion_threshold": math.inf}
    return arguments


def find_lowest_rate(rates: NDArray[np.float64], held: NDArray[np.bool_]) -> float:
    """Return the lowest rate, from the highest down, at which every run was held; infinite if none.

    Args:
        rates: (n,) steps per second of each run.
        held: (n,) whether the ground carried the body.

    Example:
        >>> import numpy as np
        >>> find_lowest_rate(np.array([50, 50, 20, 20, 10]), np.array([1, 1, 1, 0, 1], bool))
        50.0
    """
    lowest = math.inf
    for rate in sorted(set(rates.tolist()), reverse=True):
        if not held[rates == rate].all():
            break
        lowest = float(rate)
    return lowest
