"""Finds pairs of models that may meet, to judge each once before the first step where it may."""

from __future__ import annotations

from collections import Counter, defaultdict
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from voxshell.model.model import Model
from voxshell.query.accuracy_warning import Meeting, judge_world
from voxshell.simulation.compound import Compound

if TYPE_CHECKING:
    from collections.abc import Iterable

    from voxshell.simulation.body import Body
    from voxshell.simulation.body_shapes import Shape
    from voxshell.simulation.joints import Joint


class _Kind(NamedTuple):
    """What decides whether bodies may meet others, except for single pairs."""

    group: int
    mask: int
    moves: bool

    def may_meet(self, other: _Kind) -> bool:
        return (self.moves or other.moves) and bool(
            self.group & other.mask and other.group & self.mask
        )


_Owners: TypeAlias = dict[_Kind, list["Body"]]
"""The bodies that have a model, by their kind."""


class PairWatch:
    """The pairs of models that were judged, and the models that may meet others since."""

    def __init__(self) -> None:
        # Number of bodies ever added, by the model's serial number and whether they can move.
        self._known: Counter[tuple[int, bool]] = Counter()
        self._new: set[Model] = set()  # models that may meet others than before the last step
        self._judged: set[frozenset[int]] = set()  # pairs of serials, or one if both are the same
        self._waiting: set[int] = set()  # serials of models that could not meet some others so far
        self._apart: defaultdict[int, set[int]] = defaultdict(set)  # bodies that do not collide

    def note(self, body: Body) -> None:
        """Register a body that was added to the world."""
        for model in set(_models_of(body.shape)):
            key = (model._serial, body.motion != "static")
            self._known[key] += 1
            # A second body may meet the first, and a later one what these could not meet.
            if self._known[key] <= 2 or model._serial in self._waiting:
                self._new.add(model)

    def forget(self, body: Body) -> None:
        """Register a body that was removed from the world."""
        for other in self._apart.pop(body.number, ()):
            self._apart[other].discard(body.number)

    def renew(self, *bodies: Body | None) -> None:
        """Register bodies that may meet others than before."""
        for body in bodies:
            if body is not None:
                self._new.update(_models_of(body.shape))

    def set_collision(self, a: Body, b: Body, collide: bool) -> None:
        """Register whether two bodies collide if nothing else keeps them from it."""
        if collide:
            self._apart[a.number].discard(b.number)
            self._apart[b.number].discard(a.number)
            self.renew(a, b)
        else:
            self._apart[a.number].add(b.number)
            self._apart[b.number].add(a.number)

    def judge(self, bodies: Iterable[Body], joints: Iterable[Joint] = ()) -> None:
        """Warn once per pair of models that may meet and may miss contacts."""
        if not self._new:
            return
        new, self._new = self._new, set()
        self._waiting -= {model._serial for model in new}
        owners = _find_owners(bodies)
        held = {
            frozenset((joint.parent.number, joint.child.number))
            for joint in joints
            if joint.parent is not None and not joint._collides
        }
        movers = {model for model, kinds in owners.items() if any(kind.moves for kind in kinds)}
        meetings: dict[frozenset[int], Meeting] = {}
        for model in new & owners.keys():
            for other in owners:
                key = frozenset((model._serial, other._serial))
                if key in self._judged or movers.isdisjoint((model, other)):
                    continue
                found = self._find_two(owners[model], owners[other], held)
                if found is not None:
                    a, b = found
                    meetings[key] = Meeting(model, other, a.name, b.name)
                elif model is not other or sum(map(len, owners[model].values())) > 1:
                    self._waiting |= key
        judge_world(meetings.values())
        self._judged |= meetings.keys()

    def _find_two(
        self, some: _Owners, others: _Owners, held: set[frozenset[int]]
    ) -> tuple[Body, Body] | None:
        """Return the first two bodies that may meet, one of each; None if no two may."""
        return next(
            (
                (a, b)
                for kind, these in some.items()
                for other_kind, those in others.items()
                if kind.may_meet(other_kind)
                for a in these
                for b in those
                if a is not b
                and b.number not in self._apart.get(a.number, ())
                and frozenset((a.number, b.number)) not in held
            ),
            None,
        )


def _find_owners(bodies: Iterable[Body]) -> dict[Model, _Owners]:
    """Return the bodies that have each model."""
    owners: dict[Model, _Owners] = {}
    for body in bodies:
        models = set(_models_of(body.shape))
        if models:
            kind = _Kind(body.group, body.mask, body.motion != "static")
            for model in models:
                owners.setdefault(model, {}).setdefault(kind, []).append(body)
    return owners


def _models_of(shape: Shape) -> list[Model]:
    if isinstance(shape, Compound):
        return [part for part, _ in shape.parts if isinstance(part, Model)]
    return [shape] if isinstance(shape, Model) else []
