"""Check of everyday scenes against mechanics, at default settings.

:mod:`voxshell_studies.scenes.everyday` defines scenes, true values and bars. Every scene runs with
models, with Bullet's own shapes in the same world, and in MuJoCo if it is installed, at each rate
and in several placements.
"""

from __future__ import annotations

import math
import re
import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from voxshell.base.arguments import as_integer, as_positive
from voxshell.errors import SettingsError
from voxshell.model.accuracy import AccuracyWarning

from voxshell_studies.everyday.runs import is_installed, record_stage, run_stage
from voxshell_studies.part import Part
from voxshell_studies.scenes.everyday import SCENES
from voxshell_studies.scenes.everyday.scene import ENGINES
from voxshell_studies.settings import check_scenes, choose_scenes

if TYPE_CHECKING:
    from voxshell_studies.part import Tables
    from voxshell_studies.scenes.everyday.scene import Engine, EverydayScene

_SECONDS_A_STEP = {"voxshell": 3e-4, "bullet": 1e-4, "mujoco": 1.5e-4}
"""Approximate time of a step, only for progress displays."""

_HEAVY = 50.0
"""Factor on the time of a step for heavy scenes with models."""


@dataclass(frozen=True)
class EverydaySettings:
    """Settings of the study.

    Attributes:
        scenes: Names of scenes; empty for all.
        placements: Largest number of headings or places of each scene.
        heavy_placements: Likewise for scenes whose steps take milliseconds.
        longest: Longest duration of a scene, seconds, unless its true value needs longer; scenes
            that wait for creep last a minute.
        rates: Steps per second to select from each scene's; empty for all of them.
        heavy_rates: Likewise for scenes whose steps take milliseconds.
        engines: Engines to run, of "voxshell", "bullet", "mujoco".
        shown_rate: Steps per second of recordings.
    """

    scenes: tuple[str, ...] = ()
    placements: int = 20
    heavy_placements: int = 3
    longest: float = 60.0
    rates: tuple[float, ...] = ()
    heavy_rates: tuple[float, ...] = ()
    engines: tuple[str, ...] = ENGINES
    shown_rate: float = 200.0

    def __post_init__(self) -> None:
        for name in ("placements", "heavy_placements"):
            as_integer(getattr(self, name), name, 1, 1_000)
        for name in ("longest", "shown_rate"):
            as_positive(getattr(self, name), name)
        for name in ("rates", "heavy_rates"):
            for rate in getattr(self, name):
                as_positive(rate, name)
        check_scenes(self.scenes, SCENES)
        for name in self.engines:
            if name not in ENGINES:
                raise SettingsError(
                    f"engines: unknown engine {name!r}; valid engines: {', '.join(ENGINES)}"
                )

    @property
    def chosen(self) -> tuple[EverydayScene, ...]:
        """The chosen scenes."""
        return choose_scenes(self.scenes, SCENES)

    def rates_of(self, scene: EverydayScene) -> tuple[float, ...]:
        """Return the steps per second at which a scene runs."""
        wanted = self.rates or scene.rates
        if scene.heavy and self.heavy_rates:
            wanted = tuple(rate for rate in wanted if rate in self.heavy_rates)
        return tuple(rate for rate in scene.rates if rate in wanted)

    def engines_of(self, scene: EverydayScene) -> tuple[Engine, ...]:
        """Return the chosen engines that can represent a scene, installed or not."""
        return tuple(engine for engine in scene.engines if engine in self.engines)

    def seconds_of(self, scene: EverydayScene) -> float:
        """Return the duration of a scene, seconds."""
        return min(scene.seconds, max(self.longest, scene.needs))

    def placements_of(self, scene: EverydayScene) -> int:
        """Return the number of placements of a scene."""
        most = min(self.placements, scene.most)
        return min(most, self.heavy_placements) if scene.heavy else most


def plan(settings: EverydaySettings) -> list[Part]:
    """Return a part for each scene and installed engine, and one for each scene that is shown."""
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
                        cost=_estimate(settings, scene, engine),
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


def _estimate(settings: EverydaySettings, scene: EverydayScene, engine: Engine) -> float:
    """Seconds, about."""
    steps = settings.seconds_of(scene) * sum(settings.rates_of(scene))
    slowness = _HEAVY if scene.heavy and engine == "voxshell" else 1.0
    return 0.5 + steps * settings.placements_of(scene) * _SECONDS_A_STEP[engine] * slowness


def name_part(scene: str, engine: str) -> str:
    """Return the name of a part.

    Example:
        >>> name_part("cube stops, plane", "bullet")
        'cube-stops-plane-bullet'
    """
    return re.sub(r"[^a-z0-9]+", "-", scene.lower()).strip("-") + f"-{engine}"


def measure_scene(settings: EverydaySettings, name: str, engine: Engine) -> Tables:
    """Run a scene at its rates in its placements.

    Returns:
        "runs", a row a rate, placement and measure (its number in the scene): value and truth,
        before :attr:`Measure.scale`, and the error as the measure's bar is meant; infinite where
        there is no value.
    """
    scene = SCENES[name]
    rows = []
    for placement in range(settings.placements_of(scene)):
        stage = scene.stage(placement)
        for rate in settings.rates_of(scene):
            with warnings.catch_warnings():
                # Another study examines what a pair may miss.
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
    """Return the first placement with models: "poses", "contacts" and "frames" (time step)."""
    scene = SCENES[name]
    rates = settings.rates_of(scene)
    rate = min(rates, key=lambda each: abs(math.log(each / settings.shown_rate)))
    seconds = min(settings.seconds_of(scene), 1.0 if scene.heavy else 4.0)
    return record_stage(scene.stage(0), rate, seconds)
