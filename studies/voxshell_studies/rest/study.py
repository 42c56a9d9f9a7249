"""Rest: how calmly the bunny lies, in many orientations, with every contact mode.

The study also measures how long the bunny rolls. This depends on its shape as well as on contacts,
so two libraries with their own contacts are measured, too, at increasing rates.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from importlib.util import find_spec
from itertools import product
from typing import TYPE_CHECKING, Literal

import numpy as np
from voxshell.base.arguments import as_integer, as_positive
from voxshell.model.shapes import Plane
from voxshell.simulation.body import Body
from voxshell.simulation.comparison_shapes import ConvexHull
from voxshell.simulation.world import World

from voxshell_studies.part import Part
from voxshell_studies.rest.mujoco import MuJoCoFall
from voxshell_studies.scenes.bunny import (
    ORIENTATIONS_WXYZ,
    BunnySettings,
    build_block,
    compute_pose,
)
from voxshell_studies.scenes.drop import BULLET_MARGIN, BULLET_SOLVER
from voxshell_studies.scenes.solids import as_mesh, import_manifold

if TYPE_CHECKING:
    from collections.abc import Iterator

    from numpy.typing import NDArray
    from voxshell.simulation.body_shapes import Shape

    from voxshell_studies.part import Tables

Ground = Literal["voxels", "plane"]
Shell = Literal["fine", "coarse", "hull", "whole-hull"]
"""Our shells, or for comparison Bullet's own hull of the bunny, of 42 vertices or of all."""
Mode = Literal["auto", "regular", "segmented"]

GROUNDS: tuple[Ground, ...] = ("voxels", "plane")
SHELLS: tuple[Shell, ...] = ("fine", "coarse")
"""Ours."""
MODES: tuple[Mode, ...] = ("auto", "regular", "segmented")
HULLS: dict[bool, Shell] = {False: "hull", True: "whole-hull"}
"""Bullet's shapes for comparison, without and with rolling friction."""
BLOCK_HALF_EXTENTS = (0.5, 0.5, 0.05)
"""Voxel size of the ground, meters."""

ROLLERS: tuple[Shell | Literal["mujoco"], ...] = (
    "fine",
    "coarse",
    "hull",
    "whole-hull",
    "mujoco",
)
"""Shapes whose rolling time is measured. On a plane, all except the hull of 42 vertices are
equivalent: only the convex hull can touch."""

CHOSEN_ON = 20
"""The orientations for which the rolling friction was chosen, from the first on."""

FRAME_SECONDS = 0.05
"""Frames per second of the largest angular speed."""

WINDOW_SECONDS = 0.25
"""Window for angular speed and depth; at its end, "after 2 s" has passed."""


@dataclass(frozen=True)
class RestSettings(BunnySettings):
    """Settings of rest.

    Attributes:
        others: Number of orientations after those of :data:`CHOSEN_ON`, with rolling friction.
        height: Initial height of the lowest vertex, meters.
        rate: Steps per second.
        settle_seconds: Time from the first contact to the measurement of rest.
        drift_seconds: Time after that over which drift is measured.
        roll_rates: Steps per second at which rolling is measured.
        rolling_friction: Rolling and spinning friction of bunny and ground, meters, where they have
            it.
    """

    orientations: int = 20
    others: int = 40
    height: float = 0.05
    rate: float = 200.0
    settle_seconds: float = 2.0
    drift_seconds: float = 10.0
    roll_rates: tuple[float, ...] = (200.0, 1000.0, 4000.0)
    rolling_friction: float = 0.008

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("height", "rate", "settle_seconds", "drift_seconds", "rolling_friction"):
            as_positive(getattr(self, name), name)
        for rate in self.roll_rates:
            as_positive(rate, "roll_rates")
        as_integer(self.others, "others", 0, len(ORIENTATIONS_WXYZ) - self.first_other)

    @property
    def first_other(self) -> int:
        """The number of the first of the other orientations."""
        return max(self.orientations, CHOSEN_ON)

    @property
    def fall_seconds(self) -> float:
        """Time until the first contact, seconds."""
        return float(np.sqrt(2.0 * self.height / 9.81))


def plan(settings: RestSettings) -> list[Part]:
    """Return parts by ground, shell and mode, without and with rolling friction, and for rolling.

    Those with rolling friction exist once more, in other orientations.
    """
    seconds = settings.settle_seconds + settings.drift_seconds
    ours: list[tuple[Ground, Shell, Mode]] = list(product(GROUNDS, SHELLS, MODES))
    rests = []
    for held, hull in HULLS.items():
        rests += [_plan_rests(settings, *way, held=held) for way in ours]
        rests.append(_plan_rests(settings, "plane", hull, "auto", held=held))
    if settings.others > 0:
        rests += [_plan_rests(settings, *way, held=True, others=True) for way in ours]
    rolls = [
        Part(
            f"roll-{roller}-{rate:g}",
            run_rolls,
            {"settings": settings, "roller": roller, "rate": rate},
            cost=1.5e-5 * rate * seconds * settings.orientations,
        )
        for roller in ROLLERS
        for rate in settings.roll_rates
        if roller != "mujoco" or find_spec("mujoco") is not None
    ]
    return rests + rolls


def name_rest(ground: str, shell: str, mode: str, *, held: bool, others: bool = False) -> str:
    """Return the name of a part; held: with rolling friction; others: in the other orientations."""
    return f"{ground}-{shell}-{mode}" + ("-held" if held else "") + ("-others" if others else "")


def _plan_rests(
    settings: RestSettings,
    ground: Ground,
    shell: Shell,
    mode: Mode,
    *,
    held: bool,
    others: bool = False,
) -> Part:
    first = settings.first_other if others else 0
    count = settings.others if others else settings.orientations
    seconds = settings.settle_seconds + settings.drift_seconds
    return Part(
        name_rest(ground, shell, mode, held=held, others=others),
        run_rests,
        {
            "settings": settings,
            "ground": ground,
            "shell": shell,
            "mode": mode,
            "orientations": (first, first + count),
            "held": held,
        },
        cost=3e-5 * settings.rate * seconds * count,
    )


def run_rests(
    settings: RestSettings,
    ground: Ground,
    shell: Shell,
    mode: Mode,
    orientations: tuple[int, int],
    *,
    held: bool,
) -> Tables:
    """Measure every orientation: turning and depth after settling, later drift, and sleep.

    ``orientations``: the first and the one after the last. ``held``: with rolling friction.
    """
    rows = [
        (orientation, *_lie(settings, ground, shell, mode, orientation, held=held))
        for orientation in range(*orientations)
    ]
    names = ("orientation", "angular_speed", "depth", "drift", "end_angular_speed", "asleep")
    return {"runs": dict(zip(names, np.array(rows, dtype=np.float64).T, strict=True))}


def _lie(
    settings: RestSettings,
    ground: Ground,
    shell: Shell,
    mode: Mode,
    orientation: int,
    *,
    held: bool,
) -> tuple[float, float, float, float, bool]:
    def build(*, sleeping: bool) -> tuple[World, Body]:
        world, body = _build_world(settings, ground, shell, mode, orientation, sleeping=sleeping)
        if held:
            for each in world.bodies:
                each.rolling_friction = each.spinning_friction = settings.rolling_friction
        return world, body

    world, body = build(sleeping=False)
    settle = settings.settle_seconds + settings.fall_seconds
    window = round(WINDOW_SECONDS * settings.rate)
    world.step(round(settle * settings.rate) - window)
    turning = depth = 0.0
    for _ in range(window):
        world.step()
        turning = max(turning, float(np.linalg.norm(body.angular_velocity)))
        depth = max(depth, float(world.contacts()["depth"].max(initial=0.0)))
    start = body.pose[:3, 3]
    drift = end = 0.0
    steps = round(settings.drift_seconds * settings.rate)
    for step in range(steps):
        world.step()
        drift = max(drift, float(np.linalg.norm(body.pose[:3, 3] - start)))
        if step >= steps - window:
            end = max(end, float(np.linalg.norm(body.angular_velocity)))
    world, body = build(sleeping=True)
    world.step(round((settle + settings.drift_seconds) * settings.rate))
    return turning, depth, drift, end, body.sleeping


def run_rolls(settings: RestSettings, roller: Shell | Literal["mujoco"], rate: float) -> Tables:
    """Return the largest angular speed in each frame of every orientation, on a plane."""
    frame = max(round(FRAME_SECONDS * rate), 1)
    seconds = settings.fall_seconds + settings.settle_seconds + settings.drift_seconds
    frames = round(seconds * rate) // frame
    turning = np.empty((settings.orientations, frames))
    for orientation in range(settings.orientations):
        steps = _roll(settings, roller, rate, orientation)
        for number in range(frames):
            turning[orientation, number] = max(next(steps) for _ in range(frame))
    times = (np.arange(frames) + 1) * frame / rate - settings.fall_seconds
    return {
        "turning": {
            "orientation": np.repeat(np.arange(settings.orientations), frames),
            "time": np.tile(times, settings.orientations),
            "angular_speed": turning.ravel(),
        }
    }


def _roll(
    settings: RestSettings,
    roller: Shell | Literal["mujoco"],
    rate: float,
    orientation: int,
) -> Iterator[float]:
    """Yield the angular speed after each step, rad/s, endlessly."""
    if roller == "mujoco":
        pose = compute_pose(settings.build_mesh(), orientation, settings.height)
        fall = MuJoCoFall(find_hull(settings), settings.mass_properties, rate, pose)
        while True:
            yield fall.step()
    world, body = _build_world(
        settings, "plane", roller, "auto", orientation, rate=rate, sleeping=False
    )
    while True:
        world.step()
        yield float(np.linalg.norm(body.angular_velocity))


@cache
def find_hull(settings: RestSettings) -> NDArray[np.float64]:
    """Return all vertices of the bunny's convex hull, (n, 3), meters, the model's frame."""
    solid = import_manifold().Manifold.hull_points(np.array(settings.build_mesh().vertices))
    vertices = as_mesh(solid).vertices
    vertices.setflags(write=False)
    return vertices


def _build_world(
    settings: RestSettings,
    ground: Ground,
    shell: Shell,
    mode: Mode,
    orientation: int,
    *,
    sleeping: bool,
    rate: float | None = None,
) -> tuple[World, Body]:
    world = World(
        shell="fewest",
        time_step=1.0 / (settings.rate if rate is None else rate),
        contact=mode,
        sleeping=sleeping,
        **(BULLET_SOLVER if shell in ("hull", "whole-hull") else {}),
    )
    if ground == "plane":
        world.add(Plane(), mass=0.0)
    else:
        pose = np.eye(4)
        pose[2, 3] = -BLOCK_HALF_EXTENTS[2]
        world.add(build_block(BLOCK_HALF_EXTENTS, settings.voxel_size), mass=0.0, pose=pose)
    body = world.add(
        _build_shape(settings, shell),
        mass=settings.mass,
        pose=compute_pose(settings.build_mesh(), orientation, settings.height),
        inertia=settings.mass_properties,
    )
    return world, body


def _build_shape(settings: RestSettings, shell: Shell) -> Shape:
    match shell:
        case "hull":
            return ConvexHull.sampled(settings.build_mesh().vertices, margin=BULLET_MARGIN)
        case "whole-hull":
            # A larger margin would round its facets more.
            return ConvexHull(find_hull(settings))
        case _:
            return settings.build_model(shell)
