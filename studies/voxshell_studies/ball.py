"""The bouncing ball: rebound, penetration and energy, from many initial heights."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell_studies.motion import tabulate
from voxshell_studies.part import Part
from voxshell_studies.scenes.ball import BallSettings, build_world

if TYPE_CHECKING:
    from voxshell_studies.part import Columns, Tables
    from voxshell_studies.scenes.ball import Ground, Landing, Rule

METHODS = ("bullet", "low", "high")
"""Bullet's sphere on its box, and the two shells."""

RULES: tuple[Rule, ...] = ("published", "voxshell")
GROUNDS: tuple[Ground, ...] = ("voxels", "plane")


def plan(settings: BallSettings) -> list[Part]:
    """Return a part for each method and restitution, and then many initial heights on both grounds.

    The coarse ball falls once more such that it lands beside its center.
    """
    common = {"settings": settings}
    seconds = 0.005 * settings.phases * len(settings.phase_restitutions)
    falls = [
        Part(f"fall-{rule}-{method}", run_falls, {**common, "method": method, "rule": rule})
        for rule in RULES
        for method in METHODS
        if not (method == "bullet" and rule == "voxshell")
    ]
    phases = [
        Part(
            f"phases-{rule}-{method}-{ground}",
            run_phases,
            {**common, "method": method, "rule": rule, "ground": ground},
            cost=seconds,
        )
        for rule in RULES
        for method in METHODS
        for ground in GROUNDS
        if method != "bullet" or (rule, ground) == ("published", "voxels")
    ]
    beside = [
        *(
            Part(
                f"fall-{rule}-low-beside",
                run_falls,
                {**common, "method": "low", "rule": rule, "landing": "beside"},
            )
            for rule in RULES
        ),
        Part(
            "phases-voxshell-low-beside-voxels",
            run_phases,
            {
                **common,
                "method": "low",
                "rule": "voxshell",
                "ground": "voxels",
                "landing": "beside",
            },
            cost=seconds,
        ),
    ]
    return falls + phases + beside


def run_falls(settings: BallSettings, method: str, rule: Rule, landing: Landing = "pole") -> Tables:
    """Return every step of the fall from the published height, for each restitution."""
    tables: dict[str, Any] = {"steps": {}}
    parts = []
    for index, restitution in enumerate(settings.restitutions):
        steps, motion = _fall(
            settings, method, "voxels", rule, landing, restitution, settings.height
        )
        parts.append({"restitution": np.full(len(steps["step"]), restitution), **steps})
        tables |= {f"{name}_{index}": table for name, table in motion.items()}
    tables["steps"] = {key: np.concatenate([part[key] for part in parts]) for key in parts[0]}
    return tables


def run_phases(
    settings: BallSettings, method: str, rule: Rule, ground: Ground, landing: Landing = "pole"
) -> Tables:
    """Return the results of each initial height: rebound, penetration, energy."""
    heights = settings.height + np.linspace(
        -settings.phase_reach, settings.phase_reach, settings.phases
    )
    rows = []
    for restitution in settings.phase_restitutions:
        for height in heights:
            steps, _ = _fall(settings, method, ground, rule, landing, restitution, float(height))
            rows.append((restitution, height, *measure(settings, steps)))
    names = ("restitution", "height", "rebound", "depth", "reported_depth", "energy", "spin")
    return {"runs": dict(zip(names, np.array(rows).T, strict=True))}


def measure(settings: BallSettings, steps: dict[str, Any]) -> tuple[float, ...]:
    """Measure one fall.

    Returns:
        Rebound, depth, reported depth, energy, spin. Rebound is the height of the first apex after
        the first contact, as a fraction of the initial height, both above the ball at rest. Depths
        are the largest of the ball's lowest point below the ground, and of reported contacts,
        meters. Energies are the largest total and rotational energy, as fractions of the initial
        energy.
    """
    energy = compute_energy(settings, steps)
    turning = steps["turning"] / (settings.gravity * (steps["start"] - settings.radius))
    apex = find_apex(steps)
    rebound = 0.0 if apex is None else energy[apex] - turning[apex]
    depth = max(settings.radius - steps["height"].min(), 0.0)
    reported = steps["depth"].max()
    return (
        float(rebound),
        float(depth),
        float(reported),
        float(energy.max()),
        float(turning.max()),
    )


def find_apex(steps: Columns) -> int | None:
    """Return the last step that rises after the first contact; None if none does."""
    touched = np.flatnonzero(steps["contacts"] > 0)
    if len(touched) == 0:
        return None
    rising = steps["speed"][touched[0] :] > 0.0
    if not rising.any():
        return None
    first = int(np.argmax(rising))
    falling = ~rising[first:]
    length = int(np.argmax(falling)) if falling.any() else len(falling)
    return int(touched[0]) + first + length - 1


def compute_energy(settings: BallSettings, steps: Columns) -> np.ndarray:
    """Return the energy above that of the resting ball, as fractions of its start, (steps,).

    Bullet's integration conserves v^2/2 + g x - g dt v/2 in free flight, so this counts, together
    with the rotational energy.
    """
    gravity, speed = settings.gravity, steps["speed"]
    energy = (
        0.5 * speed**2
        + gravity * (steps["height"] - settings.radius)
        - 0.5 * gravity / settings.rate * speed
        + steps["turning"]
    )
    return energy / (gravity * (steps["start"] - settings.radius))


def _fall(
    settings: BallSettings,
    method: str,
    ground: Ground,
    rule: Rule,
    landing: Landing,
    restitution: float,
    height: float,
) -> tuple[dict[str, Any], Tables]:
    points = {"bullet": None, "low": settings.low_points, "high": settings.high_points}[method]
    world, ball = build_world(
        settings,
        points=points,
        ground="box" if points is None else ground,
        rule=rule,
        restitution=restitution,
        height=height,
        landing=landing,
    )
    recorder = world.record()
    steps = settings.steps
    center, speed, turning, depth = np.zeros((4, steps))
    contacts = np.zeros(steps, np.int64)
    # Per kilogram, for the solid ball.
    inertia = 0.4 * settings.radius**2
    for step in range(steps):
        world.step()
        found = world.contacts()
        touching = found[found["depth"] > 0.0] if rule == "published" else found
        contacts[step] = len(touching)
        depth[step] = touching["depth"].max(initial=0.0)
        center[step] = ball.pose[2, 3]
        speed[step] = ball.linear_velocity[2]
        turning[step] = 0.5 * inertia * float(ball.angular_velocity @ ball.angular_velocity)
    columns = {
        "step": np.arange(1, steps + 1),
        "height": center,
        "speed": speed,
        "turning": turning,
        "contacts": contacts,
        "depth": np.maximum(depth, 0.0),
        "start": np.full(steps, height),
    }
    return columns, tabulate(recorder.recording())
