"""Stacks of spheres and of bunnies: how long they stand."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell_studies.motion import tabulate
from voxshell_studies.part import Part
from voxshell_studies.scenes.stack import StackSettings, build_bunny_world, build_world

if TYPE_CHECKING:
    from collections.abc import Sequence

    from voxshell.simulation.body import Body
    from voxshell.simulation.world import World

    from voxshell_studies.part import Tables
    from voxshell_studies.scenes.ball import Rule

RULES: tuple[Rule, ...] = ("published", "voxshell")
BUNNY_FALL = 0.05
"""Descent of the top bunny that counts as collapse, meters."""

KEPT_EVERY = 5
"""Steps between stored heights."""

RECORDED_SECONDS = 4.0
"""Frames per second of the stack that is shown."""


def plan(settings: StackSettings) -> list[Part]:
    """Return a part for each resolution and rule, with all seeds."""
    variants: list[tuple[str, Rule, int | None]] = [
        (f"{rule}-{points}", rule, points) for rule in RULES for points in settings.resolutions
    ]
    variants.append(("bullet", "published", None))
    return [
        Part(
            name,
            run_stacks,
            {"settings": settings, "points": points, "rule": rule},
            cost=0.02 * settings.seeds * settings.seconds,
        )
        for name, rule, points in variants
    ] + [
        Part(
            "bunnies",
            run_bunnies,
            {"settings": settings},
            cost=0.1 * settings.bunny_seeds * settings.seconds,
        )
    ]


def run_stacks(settings: StackSettings, points: int | None, rule: Rule) -> Tables:
    """Run every seed until its stack has collapsed, or has stood long enough."""
    collapses, curves = [], []
    for seed in range(settings.seeds):
        collapse, curve = _stand(settings, points, rule, seed)
        collapses.append((seed, collapse))
        curves.append(curve)
    seeds, seconds = np.array(collapses, dtype=np.float64).T
    return {
        "runs": {"seed": seeds.astype(np.int64), "collapse": seconds},
        "heights": {key: np.concatenate([c[key] for c in curves]) for key in curves[0]},
        **_record(settings, points, rule),
    }


def _stand(
    settings: StackSettings, points: int | None, rule: Rule, seed: int
) -> tuple[float, dict[str, Any]]:
    """Return when the top has fallen by a radius, seconds, or infinity; and its height."""
    world, bodies = build_world(settings, points=points, rule=rule, seed=seed)
    return _watch(settings, world, bodies, settings.radius, seed)


def run_bunnies(settings: StackSettings) -> Tables:
    """Run every seed until its stack of bunnies has collapsed, or has stood long enough."""
    runs = [
        _watch(settings, *build_bunny_world(settings, seed=seed), BUNNY_FALL, seed)
        for seed in range(settings.bunny_seeds)
    ]
    world, _ = build_bunny_world(settings, seed=0)
    recorder = world.record(every=4)
    world.step(round(min(RECORDED_SECONDS, settings.seconds) * settings.rate))
    return {
        "runs": {
            "seed": np.arange(settings.bunny_seeds),
            "collapse": np.array([collapse for collapse, _ in runs]),
        },
        "heights": {key: np.concatenate([c[key] for _, c in runs]) for key in runs[0][1]},
        **tabulate(recorder.recording()),
    }


def _watch(
    settings: StackSettings, world: World, bodies: Sequence[Body], fall: float, seed: int
) -> tuple[float, dict[str, Any]]:
    """Return when the top has fallen by a distance, seconds, or infinity; and its height."""
    start = bodies[-1].pose[2, 3]
    steps, heights = [0], [start]
    collapse = math.inf
    for step in range(1, round(settings.seconds * settings.rate) + 1):
        world.step()
        height = bodies[-1].pose[2, 3]
        if step % KEPT_EVERY == 0:
            steps.append(step)
            heights.append(height)
        if height < start - fall:
            collapse = step / settings.rate
            break
    return collapse, {
        "seed": np.full(len(steps), seed),
        "step": np.array(steps),
        "top": np.array(heights),
    }


def _record(settings: StackSettings, points: int | None, rule: Rule) -> Tables:
    """Return poses of the first seed's stack, for the replay."""
    world, _ = build_world(settings, points=points, rule=rule, seed=0)
    recorder = world.record(every=4)
    world.step(round(min(RECORDED_SECONDS, settings.seconds) * settings.rate))
    return tabulate(recorder.recording())
