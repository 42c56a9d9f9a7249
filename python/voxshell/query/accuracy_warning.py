"""Warnings, once per pair, if queries may miss much of a body."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from voxshell import _core
from voxshell.base.user_warnings import warn_user
from voxshell.model.accuracy import AccuracyWarning
from voxshell.model.model import Model

if TYPE_CHECKING:
    from collections.abc import Iterable

    from voxshell.model.field import Field

Parts: TypeAlias = tuple[_core.Field, _core.Model | None, _core.Field, _core.Model | None]
"""The field and the model of each of two bodies, as the core takes them."""

_OF_SIDE = 0.02  # limit as a fraction of the smaller body's shortest side
_OF_WALL = 0.25  # limit as a fraction of the thinner wall: half the distance to its middle
_MOST_REMEMBERED = 10_000


class Meeting(NamedTuple):
    """Two models of a world that may meet, and the names of a body of each."""

    a: Model
    b: Model
    name_a: str
    name_b: str


class Missing(NamedTuple):
    """Depth that queries of two bodies may miss, and the length that limits it; meters."""

    miss: float
    length: float
    of: str

    @property
    def fraction(self) -> float:
        """The missed depth as a fraction of the length."""
        return self.miss / self.length

    def __str__(self) -> str:
        part = f"{100.0 * self.fraction:.3g} % of" if self.fraction <= 1.0 else "more than"
        return (
            f"may be missed up to {self.miss * 1e3:.3g} mm deep, {part} {self.of} of "
            f"{self.length * 1e3:.3g} mm"
        )


def _describe(name: str, body: Model | Field) -> str:
    """Return an argument's name, and what tells its body from others, in few words."""
    what = f"{len(body._core.faces)} triangles" if isinstance(body, Model) else repr(body)
    return f"{name} ({what})"


def _advise(a: Model | Field, b: Model | Field, name_a: str, name_b: str) -> str:
    """Return what to do about bodies that may miss much of each other, and which models it concerns."""
    models = {body: name for body, name in ((b, name_b), (a, name_a)) if isinstance(body, Model)}
    uniform = {body: name for body, name in models.items() if body.tolerance is None}
    others = sorted(name for body, name in uniform.items() if not body._is_of_robot)
    remedies = []
    if len(others) < len(uniform):  # loaders build uniform models by default
        remedies.append("load robots with tolerance=0.0002")
    if others:
        names = " and ".join(others)
        remedies.append(f"build {names} to a tolerance, without voxel_size= and resolution=")
    if not uniform:
        coarsest = max(body.tolerance or 0.0 for body in models)
        names = " and ".join(
            sorted(name for body, name in models.items() if body.tolerance == coarsest)
        )
        remedies.append(f"build {names} to a tolerance below {coarsest:.3g} m")
    return (
        f"{', and '.join(remedies)} (voxshell.contact_bounds reports the effect), or filter "
        "voxshell.AccuracyWarning"
    )


def judge(a: Model | Field, b: Model | Field, parts: Parts) -> None:
    """Warn if the automatic role of two bodies may miss much of the smaller one.

    Args:
        a: A body.
        b: Another body.
        parts: The field and the shell's model of each, as the core takes them.
    """
    for body, other in ((a, b), (b, a)):
        if len(body._judged) >= _MOST_REMEMBERED:
            body._judged.clear()
        body._judged.add(other._serial)
    missing = measure(parts)
    if missing is not None:
        warn_user(
            f"contacts between {_describe('a', a)} and {_describe('b', b)} {missing}; "
            f"{_advise(a, b, 'a', 'b')}",
            AccuracyWarning,
        )


def judge_world(meetings: Iterable[Meeting]) -> None:
    """Warn about the worst pair of models that may meet in a world."""
    found: list[tuple[Missing, Meeting]] = []
    for meeting in meetings:
        a, b = meeting.a, meeting.b
        missing = measure((a.field._core, a._core, b.field._core, b._core))
        if missing is not None:
            found.append((missing, meeting))
    if not found:
        return
    worst, (a, b, name_a, name_b) = max(found, key=lambda each: each[0].fraction)
    count = f" (the worst of {len(found)} pairs of models)" if len(found) > 1 else ""
    advice = _advise(a, b, f"the model of {name_a!r}", f"the model of {name_b!r}")
    warn_user(
        f"contacts between {name_a!r} and {name_b!r} {worst}{count}; {advice}", AccuracyWarning
    )


def measure(parts: Parts) -> Missing | None:
    """Return what the automatic role of two bodies may miss, or None if that is acceptable."""
    _, miss, _, _, _, _, side, wall = _core.role(*parts, _core.Shells.AUTOMATIC)
    if miss > _OF_WALL * wall:
        return Missing(miss, wall, "the thinner wall")
    if miss > _OF_SIDE * side:
        return Missing(miss, side, "the smaller body's shortest side")
    return None
