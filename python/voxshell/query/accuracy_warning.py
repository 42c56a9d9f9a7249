"""Warnings, once per pair, if queries may miss much of a body."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from voxshell import _core
from voxshell.base.user_warnings import warn_user
from voxshell.model.accuracy import AccuracyWarning
from voxshell.model.model import Model
from voxshell.query.contact_set import ROLES

if TYPE_CHECKING:
    from collections.abc import Iterable

    from voxshell.model.field import Field

Parts: TypeAlias = tuple[_core.Field, _core.Model | None, _core.Field, _core.Model | None]
"""The field and the model of each of two bodies, as the core takes them."""

_OF_SIDE = 0.02  # limit as a fraction of the smaller body's shortest side
_OF_WALL = 0.25  # limit as a fraction of the thinner wall: half the distance to its middle
_MOST_REMEMBERED = 10_000


class Missing(NamedTuple):
    """Depth that queries of two bodies may miss, and the length that limits it; meters."""

    miss: float
    length: float
    of: str
    shell: str

    @property
    def fraction(self) -> float:
        """The missed depth as a fraction of the length."""
        return self.miss / self.length

    def __str__(self) -> str:
        by = {"a": "a's points", "b": "b's points", "both": "both bodies' points"}[self.shell]
        part = f"{100.0 * self.fraction:.3g} % of" if self.fraction <= 1.0 else "more than"
        return (
            f"may miss {self.miss * 1e3:.3g} mm in depth with {by}, {part} {self.of} of "
            f"{self.length * 1e3:.3g} mm"
        )


def _name(body: Model | Field) -> str:
    """Return what tells a body from others, in few words."""
    if isinstance(body, Model):
        return f"a model of {len(body._core.faces)} triangles and {len(body.shell)} points"
    return repr(body)


def _advise(*bodies: Model | Field) -> str:
    """What to do about bodies that may miss much of each other."""
    uniform = [body for body in bodies if isinstance(body, Model) and body.tolerance is None]
    of_robots = [body for body in uniform if body._is_of_robot]  # uniform by default
    build = "build {} to a tolerance, without voxel_size= and resolution="
    if not uniform:
        remedy, more = "build the models to a smaller tolerance=", ""
    elif not of_robots:
        remedy, more = build.format("the models"), "; load robots with tolerance=0.0002"
    else:
        remedy, more = "load robots with tolerance=0.0002", ""
        if len(of_robots) < len(uniform):
            remedy = f"{remedy}, and {build.format('other models')}"
    return (
        f"{remedy} (voxshell.contact_bounds reports the effect{more}), or filter "
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
            f"queries of {_name(a)} and {_name(b)} {missing}; {_advise(a, b)}", AccuracyWarning
        )


def judge_world(pairs: Iterable[tuple[Model, Model]]) -> None:
    """Warn about the worst pair of models that may meet in a world."""
    found: list[tuple[Missing, Model, Model]] = []
    for a, b in pairs:
        missing = measure((a.field._core, a._core, b.field._core, b._core))
        if missing is not None:
            found.append((missing, a, b))
    if not found:
        return
    worst, a, b = max(found, key=lambda each: each[0].fraction)
    count = f"{len(found)} pairs of models" if len(found) > 1 else "a pair of models"
    warn_user(
        f"{count} in the world may miss contacts; the worst {worst}; {_advise(a, b)}",
        AccuracyWarning,
    )


def measure(parts: Parts) -> Missing | None:
    """Return what the automatic role of two bodies may miss, or None if that is acceptable."""
    role, miss, _, _, _, _, side, wall = _core.role(*parts, _core.Shells.AUTOMATIC)
    if miss > _OF_WALL * wall:
        return Missing(miss, wall, "the thinner wall", ROLES[role])
    if miss > _OF_SIDE * side:
        return Missing(miss, side, "the smaller body's shortest side", ROLES[role])
    return None
