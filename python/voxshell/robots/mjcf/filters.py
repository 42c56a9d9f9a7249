"""MuJoCo's rules for which bodies of a model collide."""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from functools import reduce
from itertools import combinations
from operator import or_
from typing import TYPE_CHECKING

from voxshell.robots.mjcf.left_out import is_disabled
from voxshell.robots.mjcf.pairs import Pair, read_pairs

if TYPE_CHECKING:
    from collections.abc import Sequence

    from voxshell.robots.lumps import Lump
    from voxshell.robots.mjcf.geoms import Geom
    from voxshell.robots.mjcf.parts import Part
    from voxshell.robots.xml_elements import Element


@dataclass(frozen=True, eq=False, slots=True)
class Meeting:
    """Two lumps that collide.

    Attributes:
        lumps: The two.
        is_own: Whether they are of one tree.
        by_bits: Whether their geoms' bits count.
        pairs: Those that name geoms of both.
    """

    lumps: tuple[Lump, Lump]
    is_own: bool
    by_bits: bool
    pairs: Sequence[Pair]


@dataclass(frozen=True, eq=False)
class SortedPairs:
    """The pairs of lumps that do not collide, and those that do."""

    apart: list[tuple[Lump, Lump]] = field(default_factory=list)
    meetings: list[Meeting] = field(default_factory=list)


class Filters:
    """Geoms of links, their places in the tree, and excluded or explicit pairs.

    Args:
        root: The model, whose flags apply to all parts.

    Raises:
        RobotError: A flag has an invalid value.
    """

    def __init__(self, root: Element) -> None:
        self._geoms: dict[str, list[Geom]] = {}
        self._above: dict[str, str] = {}
        self._tops: dict[str, str] = {}
        self._excluded: list[tuple[str, str]] = []
        self._pairs: list[Pair] = []
        self._paired: set[str] = set()
        self._link_of: dict[str, str] = {}
        self._collides = not _disables(root, "contact")
        self._parents_collide = _disables(root, "filterparent")

    def read_pairs(self, part: Part) -> None:
        """Read the pairs of a model, before its geoms.

        Raises:
            RobotError: A pair lacks a name, or a number is wrong.
        """
        prefix = part.prefix
        for section in part.file.sections("contact"):
            for it in section.all("exclude"):
                self._excluded.append((prefix + it.text("body1"), prefix + it.text("body2")))
        for pair in read_pairs(part):
            self._pairs.append(pair)
            self._paired.update(pair.geoms)

    def is_paired(self, geom: str) -> bool:
        """Return whether a ``<pair>`` names the geom."""
        return geom in self._paired

    def place(self, link: str, above: str, is_top: bool) -> None:
        """Store the body that contains a link."""
        self._above[link] = above
        self._tops[link] = link if is_top else self._tops[above]

    def add(self, link: str, geoms: list[Geom]) -> None:
        """Store the geoms of a link that may collide."""
        self._geoms[link] = geoms
        self._link_of.update((geom.name, link) for geom in geoms if geom.name)

    def find_lost_pairs(self) -> list[Pair]:
        """Return the pairs that name a missing geom, or one that no link has."""
        return [it for it in self._pairs if not all(name in self._link_of for name in it.geoms)]

    def geoms_of(self, lump: Lump) -> list[Geom]:
        """Return the geoms of a lump that may collide."""
        return [geom for link in lump.links for geom in self._geoms.get(link, ())]

    def sort_pairs(
        self, lump_of: dict[str, Lump], static: set[Lump], lumps: list[Lump]
    ) -> SortedPairs:
        """Sort the pairs of lumps by whether they collide.

        Args:
            lump_of: Lumps by the names of links.
            static: Lumps that do not move.
            lumps: Lumps from which pairs are made.
        """
        found = SortedPairs()
        excluded = {
            frozenset((lump_of[a], lump_of[b]))
            for a, b in self._excluded
            if a in lump_of and b in lump_of
        }
        pairs: dict[frozenset[Lump], list[Pair]] = defaultdict(list)
        for pair in self._pairs:
            if all(name in self._link_of for name in pair.geoms):
                pairs[frozenset(lump_of[self._link_of[name]] for name in pair.geoms)].append(pair)
        bits = {lump: self._join_bits(lump) for lump in lumps}
        parents = {lump: lump_of.get(self._above.get(lump.first, "")) for lump in lumps}
        tops = {lump: self._tops.get(lump.first) for lump in lumps}
        for a, b in combinations(lumps, 2):
            if a in static and b in static:
                continue
            (type_a, affinity_a), (type_b, affinity_b) = bits[a], bits[b]
            both = frozenset((a, b))
            is_near = a not in static and b not in static and (parents[a] is b or parents[b] is a)
            meets = bool(type_a & affinity_b or type_b & affinity_a) and not (
                both in excluded or (is_near and not self._parents_collide)
            )
            if self._collides and (meets or both in pairs):
                is_own = tops[a] == tops[b]
                found.meetings.append(Meeting((a, b), is_own, meets, pairs.get(both, ())))
            else:
                found.apart.append((a, b))
        return found

    def _join_bits(self, lump: Lump) -> tuple[int, int]:
        """Combine the bits of all geoms: two lumps meet if any two of their geoms do."""
        own = [geom.bits for geom in self.geoms_of(lump)]
        return reduce(or_, (it[0] for it in own), 0), reduce(or_, (it[1] for it in own), 0)


def _disables(root: Element, flag: str) -> bool:
    return any(
        is_disabled(element, flag)
        for option in root.all("option")
        for element in option.all("flag")
    )
