"""Contacts without friction, ``condim="1"``, by the frictions of bodies."""

from __future__ import annotations

import os
from dataclasses import replace
from itertools import chain
from typing import TYPE_CHECKING, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Iterator

    from voxshell.robots.description import RobotDescription
    from voxshell.robots.lumps import Lump
    from voxshell.robots.mjcf.filters import Filters, Meeting
    from voxshell.robots.mjcf.geoms import Geom
    from voxshell.robots.mjcf.left_out import LeftOut

_Kind: TypeAlias = tuple[int, int, int, float]
"""What decides about a geom's contacts: contype, conaffinity, condim, priority."""

_CLOSE = 1e-6
"""Two frictions are the same up to this difference."""


def remove_frictions(
    robot: RobotDescription,
    filters: Filters,
    meetings: list[Meeting],
    static: set[Lump],
    left_out: LeftOut,
) -> None:
    """Remove the friction of bodies whose contacts in the file have none.

    MuJoCo decides about friction for two geoms, and a world multiplies the frictions of two bodies. So a body
    loses its friction if it meets all others without friction: first those that do not move, and then those
    that still meet other trees. A tree that meets only itself keeps its frictions for what else is in a world.

    Args:
        robot: Its links are changed.
        filters: What geoms the lumps have.
        meetings: The lumps that collide.
        static: Those that do not move.
        left_out: Gets the contacts whose friction cannot be the file's.
    """
    reader = _MeetingReader(filters)
    if not any(it.pairs or any(map(reader.find_slippery, it.lumps)) for it in meetings):
        return
    kinds = [(it, reader.read(it)) for it in meetings]
    slick = _choose_slick(kinds, static)
    for lump in slick:
        for name in lump.links:
            robot.links[name] = replace(robot.links[name], friction=0.0)
    held = (it.lumps for it, kind in kinds if True in kind and slick.isdisjoint(it.lumps))
    for lump in dict.fromkeys(chain.from_iterable(held)):
        for geom in reader.find_slippery(lump):
            where = os.path.basename(geom.element.where)
            left_out.note_once(
                'contacts without friction (condim="1"): a body has one friction for all that it touches',
                f"{geom.name or 'a geom'} at {where}",
            )
    for it in meetings:
        for pair in it.pairs:
            wanted = (0.0, 0.0) if pair.slips else pair.friction
            own = _multiply(robot, it)
            if wanted is not None and any(abs(own - friction) > _CLOSE for friction in wanted):
                left_out.note_once("friction of a <pair>: that of its bodies counts", pair.place)


def _choose_slick(kinds: list[tuple[Meeting, set[bool]]], static: set[Lump]) -> set[Lump]:
    """Return the lumps that lose their friction."""
    with_friction = {lump for it, kind in kinds if False in kind for lump in it.lumps}
    without = [it for it, kind in kinds if kind == {True}]
    slick = {lump for it in without for lump in it.lumps if lump in static} - with_friction
    for it in without:
        if slick.isdisjoint(it.lumps) and not it.is_own:
            slick.update(set(it.lumps) - with_friction)
    return slick


def _multiply(robot: RobotDescription, meeting: Meeting) -> float:
    """The friction of two lumps in a world."""
    a, b = (
        max((robot.links[name].friction or 0.0 for name in lump.links), default=0.0)
        for lump in meeting.lumps
    )
    return a * b


class _MeetingReader:
    """Which contacts of two lumps have no friction."""

    def __init__(self, filters: Filters) -> None:
        self._filters = filters
        self._kinds: dict[Lump, dict[_Kind, Geom]] = {}
        self._found: dict[tuple[frozenset[_Kind], frozenset[_Kind]], set[bool]] = {}

    def read(self, meeting: Meeting) -> set[bool]:
        """Return, for each kind of contact that two lumps may have, whether it has no friction."""
        if meeting.pairs or not meeting.by_bits:
            return {*self._contacts(meeting), *(it.slips for it in meeting.pairs)}
        a, b = (frozenset(self._sort(lump)) for lump in meeting.lumps)
        if (a, b) not in self._found:
            self._found[a, b] = set(self._contacts(meeting))
        return self._found[a, b]

    def find_slippery(self, lump: Lump) -> list[Geom]:
        """Return a geom of each kind that has no friction with some other geom."""
        return [geom for geom in self._sort(lump).values() if geom.condim == 1]

    def _contacts(self, meeting: Meeting) -> Iterator[bool]:
        """Return, for each contact that bits allow, whether it has no friction."""
        if not meeting.by_bits:
            return
        paired = {frozenset(pair.geoms) for pair in meeting.pairs}
        a, b = meeting.lumps
        for one in self._geoms(a, bool(paired)):
            for other in self._geoms(b, bool(paired)):
                if not (one.bits[0] & other.bits[1] or other.bits[0] & one.bits[1]):
                    continue
                if frozenset((one.name, other.name)) in paired:
                    continue
                leading = [
                    it for it in (one, other) if it.priority >= max(one.priority, other.priority)
                ]
                yield max(it.condim for it in leading) == 1

    def _geoms(self, lump: Lump, each: bool) -> list[Geom]:
        """Return all geoms, or one of each kind."""
        return self._filters.geoms_of(lump) if each else list(self._sort(lump).values())

    def _sort(self, lump: Lump) -> dict[_Kind, Geom]:
        """Return the first geom of each kind."""
        if lump not in self._kinds:
            own = self._filters.geoms_of(lump)
            self._kinds[lump] = {(*it.bits, it.condim, it.priority): it for it in reversed(own)}
        return self._kinds[lump]
