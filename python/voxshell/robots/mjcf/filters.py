"""MuJoCo's rules for which bodies of a model collide."""

from __future__ import annotations

from functools import reduce
from itertools import combinations
from operator import or_
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from voxshell.robots.lumps import Lump
    from voxshell.robots.xml_elements import Element


class Filters:
    """Collision bits of links, their places in the tree, and excluded or explicit pairs.

    Args:
        root: The model, whose flags apply to all parts.

    Raises:
        RobotError: A flag has an invalid value.
    """

    def __init__(self, root: Element) -> None:
        self._bits: dict[str, tuple[int, int]] = {}
        self._above: dict[str, str] = {}
        self._tops: dict[str, str] = {}
        self._excluded: list[tuple[str, str]] = []
        self._paired_geoms: list[tuple[str, str]] = []
        self._body_of: dict[str, str] = {}
        self._paired: set[str] = set()
        self._collides = not _disables(root, "contact")
        self._parents_collide = _disables(root, "filterparent")

    def read_pairs(self, root: Element, prefix: str) -> None:
        """Read the pairs of a model, before its geoms.

        Raises:
            RobotError: A pair lacks a name.
        """
        for section in root.all("contact"):
            for it in section.all("exclude"):
                self._excluded.append((prefix + it.text("body1"), prefix + it.text("body2")))
            for it in section.all("pair"):
                pair = prefix + it.text("geom1"), prefix + it.text("geom2")
                self._paired_geoms.append(pair)
                self._paired.update(pair)

    def is_paired(self, geom: str, body: str) -> bool:
        """Store a geom's body; return whether a ``<pair>`` names the geom."""
        self._body_of[geom] = body
        return geom in self._paired

    def place(self, link: str, above: str, is_top: bool) -> None:
        """Store the body that contains a link."""
        self._above[link] = above
        self._tops[link] = link if is_top else self._tops[above]

    def add(self, link: str, bits: list[tuple[int, int]]) -> None:
        """Store contype and conaffinity of the geoms of a link."""
        self._bits[link] = (
            reduce(or_, (it[0] for it in bits), 0),
            reduce(or_, (it[1] for it in bits), 0),
        )

    def sort_pairs(
        self, lump_of: dict[str, Lump], static: set[Lump], lumps: list[Lump]
    ) -> tuple[list[tuple[Lump, Lump]], list[tuple[Lump, Lump]]]:
        """Return the pairs of lumps that do not collide, and those of one tree that may.

        Args:
            lump_of: Lumps by the names of links.
            static: Lumps that do not move.
            lumps: Lumps from which pairs are made.
        """
        apart, own = [], []
        excluded = {
            frozenset((lump_of[a], lump_of[b]))
            for a, b in self._excluded
            if a in lump_of and b in lump_of
        }
        paired = {
            frozenset(lump_of[self._body_of[name]] for name in pair)
            for pair in self._paired_geoms
            if all(name in self._body_of for name in pair)
        }
        bits = {lump: self._join_bits(lump) for lump in lumps}
        parents = {lump: lump_of.get(self._above.get(lump.first, "")) for lump in lumps}
        tops = {lump: self._tops.get(lump.first) for lump in lumps}
        for a, b in combinations(lumps, 2):
            if a in static and b in static:
                continue
            (type_a, affinity_a), (type_b, affinity_b) = bits[a], bits[b]
            both = frozenset((a, b))
            is_near = a not in static and b not in static and (parents[a] is b or parents[b] is a)
            meets = (type_a & affinity_b or type_b & affinity_a) and not (
                both in excluded or (is_near and not self._parents_collide)
            )
            if not (self._collides and (meets or both in paired)):
                apart.append((a, b))
            elif tops[a] == tops[b]:
                own.append((a, b))
        return apart, own

    def _join_bits(self, lump: Lump) -> tuple[int, int]:
        """Combine the bits of all geoms: two lumps collide if any two of their geoms do."""
        own = [self._bits.get(name, (0, 0)) for name in lump.links]
        return reduce(or_, (it[0] for it in own), 0), reduce(or_, (it[1] for it in own), 0)


def _disables(root: Element, flag: str) -> bool:
    return any(
        element.word(flag, ("enable", "disable"), "enable") == "disable"
        for option in root.all("option")
        for element in option.all("flag")
    )
