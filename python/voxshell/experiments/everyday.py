"""Whether everyday scenes do what mechanics says, at default settings.

Scenes, truths and bars are those of :mod:`voxshell.scenes.everyday`. Every scene runs with models, with
Bullet's own shapes in the same world, and in MuJoCo where that is installed, at each rate and in several
placements.
"""

from __future__ import annotations

import math
import re
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from voxshell._arguments import as_integer, as_positive
from voxshell.accuracy import AccuracyWarning
from voxshell.errors import SettingsError
from voxshell.experiments.everyday_runs import is_installed, record_stage, run_stage
from voxshell.experiments.part import Part
from voxshell.scenes.everyday import SCENES
from voxshell.scenes.everyday.scene import ENGINES

if TYPE_CHECKING:
    from voxshell.experiments.part import Tables
    from voxshell.scenes.everyday.scene import Engine, EverydayScene

_CROWD = 8
"""A stage with more bodies than this that move is a crowd."""

_SECONDS_A_STEP = 6e-5
"""About what a step of one body takes; only tells how far a run is."""


@dataclass(frozen=True)
class EverydaySettings:
    """Settings of the study.

    Attributes:
        scenes: Names of scenes; empty for all.
        placements: Headings or places of each scene, at most.
        crowd_placements: Of scenes with more than eight bodies that move, at most.
        longest: Seconds that a scene lasts at most; those that wait for a creep last a minute.
        rates: Steps a second, of those of each scene; empty for all of them.
        engines: Which run, of "voxshell", "bullet", "mujoco".
        shown_rate: Steps a second of what is recorded.
    """

    scenes: tuple[str, ...] = ()
    placements: int = 20
    crowd_placements: int = 3
    longest: float = 60.0
    rates: tuple[float, ...] = ()
    engines: tuple[str, ...] = ENGINES
    shown_rate: float = 200.0

    def __post_init__(self) -> None:
        for name in ("placements", "crowd_placements"):
            as_integer(getattr(self, name), name, 1, 1_000)
        for name in ("longest", "shown_rate"):
            as_positive(getattr(self, name), name)
        for rate in self.rates:
            as_positive(rate, "rates")
        for name in self.scenes:
            if name not in SCENES:
                raise SettingsError(f"scenes: unknown scene {name!r}")
        for name in self.engines:
            if name not in ENGINES:
                raise SettingsError(
                    f"engines: unknown engine {name!r}; valid engines: {', '.join(ENGINES)}"
                )

    @property
    def chosen(self) -> tuple[EverydayScene, ...]:
        """The scenes that are run."""
        return tuple(SCENES[name] for name in self.scenes or SCENES)

    def rates_of(self, scene: EverydayScene) -> tuple[float, ...]:
        """Steps a second at which a scene is run."""
        return tuple(rate for rate in scene.rates if not self.rates or rate in self.rates)

    def engines_of(self, scene: EverydayScene) -> tuple[Engine, ...]:
        """Engines that can represent a scene and are wanted, installed or not."""
        return tuple(engine for engine in scene.engines if engine in self.engines)

    def seconds_of(self, scene: EverydayScene) -> float:
        """How long a scene lasts."""
        return min(scene.seconds, self.longest)


def plan(settings: EverydaySettings) -> list[Part]:
    """A part for each scene and engine that is installed, and one for each scene that is shown."""
    installed = [engine for engine in ENGINES if is_installed(engine)]
    parts = []
    for scene in settings.chosen:
        for engine in settings.engines_of(scene):
            if engine in installed:
                parts.append(
                    Part(
                        name_part(scene.name, engine),
                        measure_scene,
                        {"settings": settings, "name": scene.name, "engine": engine},
                        cost=_estimate(settings, scene),
                    )
                )
        if scene.shown and "voxshell" in settings.engines_of(scene):
            parts.append(
                Part(
                    name_part(scene.name, "shown"),
                    record_scene,
                    {"settings": settings, "name": scene.name},
                    cost=1.0,
                )
            )
    return parts


def _estimate(settings: EverydaySettings, scene: EverydayScene) -> float:
    """Seconds, about."""
    steps = settings.seconds_of(scene) * sum(settings.rates_of(scene))
    return 0.5 + steps * min(settings.placements, scene.most) * _SECONDS_A_STEP


def name_part(scene: str, engine: str) -> str:
    """The name of a part.

    Example:
        >>> name_part("cube stops, plane", "bullet")
        'cube-stops-plane-bullet'
    """
    return re.sub(r"[^a-z0-9]+", "-", scene.lower()).strip("-") + f"-{engine}"


def count_placements(settings: EverydaySettings, scene: EverydayScene) -> int:
    """Of a scene that are run."""
    most = min(settings.placements, scene.most)
    moving = sum(item.moves for item in scene.stage(0).items)
    return min(most, settings.crowd_placements) if moving > _CROWD else most


def measure_scene(settings: EverydaySettings, name: str, engine: Engine) -> Tables:
    """Runs a scene at its rates in its placements.

    Returns:
        "runs", a row a rate, placement and measure (its number in the scene): value and truth, before
        :attr:`Measure.scale`, and the error as the measure's bar is meant; infinite where there is no
        value.
    """
    scene = SCENES[name]
    rows = []
    for placement in range(count_placements(settings, scene)):
        stage = scene.stage(placement)
        for rate in settings.rates_of(scene):
            with warnings.catch_warnings():
                # What a pair may miss is another study's question.
                warnings.simplefilter("ignore", AccuracyWarning)
                track = run_stage(
                    stage, engine, rate, settings.seconds_of(scene), smooth=scene.smooth
                )
            for number, measure in enumerate(scene.measures):
                value, truth = measure.value(track), measure.truth(track)
                rows.append((rate, placement, number, value, truth, measure.error(value, truth)))
    names = ("rate", "placement", "measure", "value", "truth", "error")
    values = np.array(rows, dtype=np.float64).reshape(-1, len(names))
    return {"runs": dict(zip(names, values.T.copy(), strict=True))}


def record_scene(settings: EverydaySettings, name: str) -> Tables:
    """The first placement with models: "poses", "contacts", and "frames" with seconds between frames."""
    scene = SCENES[name]
    rates = settings.rates_of(scene)
    rate = min(rates, key=lambda each: abs(math.log(each / settings.shown_rate)))
    return record_stage(scene.stage(0), rate, min(settings.seconds_of(scene), 5.0))
