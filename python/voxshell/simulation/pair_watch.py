"""Finds pairs of models that may meet, to judge each once before the first step where it may."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from voxshell.model.model import Model
from voxshell.query.accuracy_warning import judge_world
from voxshell.simulation.compound import Compound

if TYPE_CHECKING:
    from collections.abc import Iterable

    from voxshell.simulation.body import Body
    from voxshell.simulation.body_shapes import Shape


class PairWatch:
    """The pairs of models that were judged, and the bodies that were added since."""

    def __init__(self) -> None:
        # Number of bodies ever added, by the model's serial number and whether they can move.
        self._known: Counter[tuple[int, bool]] = Counter()
        self._new: set[Model] = set()  # models that may meet others than before the last step
        self._judged: set[frozenset[int]] = set()  # pairs of serials, or one if both are the same

    def note(self, body: Body) -> None:
        """Register a body that was added to the world."""
        for model in set(_models_of(body.shape)):
            key = (model._serial, body.motion != "static")
            self._known[key] += 1
            if self._known[key] <= 2:  # a second body may meet the first
                self._new.add(model)

    def judge(self, bodies: Iterable[Body]) -> None:
        """Warn once per pair of models that may meet and may miss contacts."""
        if not self._new:
            return
        new, self._new = self._new, set()
        counts: Counter[Model] = Counter()
        movers: set[Model] = set()
        for body in bodies:
            for model in set(_models_of(body.shape)):
                counts[model] += 1
                if body.motion != "static":
                    movers.add(model)
        pairs = {
            frozenset((model._serial, other._serial)): (model, other)
            for model in new
            if model in counts
            for other in counts
            if (other is not model or counts[model] > 1) and not movers.isdisjoint((model, other))
        }
        judge_world(pairs[key] for key in pairs.keys() - self._judged)
        self._judged |= pairs.keys()


def _models_of(shape: Shape) -> list[Model]:
    if isinstance(shape, Compound):
        return [part for part, _ in shape.parts if isinstance(part, Model)]
    return [shape] if isinstance(shape, Model) else []
