"""Figures of the page of limits, at default settings.

:mod:`voxshell_studies.scenes.limits` defines the scenes. Each yields one number at each rate and in each
placement, beside the number that it should be. No bar says what is right: these are known limits.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING

from voxshell.base.arguments import as_integer, as_positive
from voxshell.model.accuracy import AccuracyWarning

from voxshell_studies.everyday.study import name_part
from voxshell_studies.part import Part, as_columns
from voxshell_studies.scenes.limits import SCENES
from voxshell_studies.settings import check_scenes, choose_scenes

if TYPE_CHECKING:
    from voxshell_studies.part import Tables
    from voxshell_studies.scenes.limits.scene import LimitScene

_COST_RATE = 200.0
"""Rate that :attr:`LimitScene.cost` refers to, steps per second."""


@dataclass(frozen=True)
class LimitsSettings:
    """Settings of the study.

    Attributes:
        scenes: Names of scenes; empty for all.
        placements: Largest number of placements of each scene.
        rates: Steps per second to select from each scene's; empty for all of them.
    """

    scenes: tuple[str, ...] = ()
    placements: int = 20
    rates: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        as_integer(self.placements, "placements", 1, 1_000)
        for rate in self.rates:
            as_positive(rate, "rates")
        check_scenes(self.scenes, SCENES)

    @property
    def chosen(self) -> tuple[LimitScene, ...]:
        """The chosen scenes."""
        return choose_scenes(self.scenes, SCENES)

    def rates_of(self, scene: LimitScene) -> tuple[float, ...]:
        """Return the steps per second at which a scene runs."""
        return tuple(rate for rate in scene.rates if rate in (self.rates or scene.rates))

    def placements_of(self, scene: LimitScene) -> int:
        """Return the number of placements of a scene."""
        return min(self.placements, scene.placements)


def name_run(scene: LimitScene, rate: float) -> str:
    """Return the name of the part that runs a scene at a rate."""
    return name_part(scene.name, f"{rate:g}-hz")


def plan(settings: LimitsSettings) -> list[Part]:
    """Return a part for each scene and rate."""
    return [
        Part(
            name_run(scene, rate),
            measure_scene,
            {"name": scene.name, "rate": rate, "placements": settings.placements_of(scene)},
            timed=scene.timed,
            cost=0.5 + scene.cost * settings.placements_of(scene) * rate / _COST_RATE,
        )
        for scene in settings.chosen
        for rate in settings.rates_of(scene)
    ]


def measure_scene(name: str, rate: float, placements: int) -> Tables:
    """Run a scene at a rate.

    Returns:
        "runs", a row for each placement: its number and the value.
    """
    scene = SCENES[name]
    rows = []
    for placement in range(placements):
        with warnings.catch_warnings():
            # Another study examines what a pair may miss.
            warnings.simplefilter("ignore", AccuracyWarning)
            rows.append((placement, scene.run(rate, placement)))
    return {"runs": as_columns(("placement", "value"), rows)}
