"""Carriers: links between the joints of a body that has several."""

from __future__ import annotations

from collections import Counter
from typing import TYPE_CHECKING

from voxshell.model.mass_properties import MassProperties

if TYPE_CHECKING:
    from collections.abc import Mapping

    from voxshell.robots.lumps import Lump
    from voxshell.robots.matter import Matter

_FRACTION = 0.1
"""Fraction of a body's mass that a carrier gets. Mass, center and inertia of the whole are
unchanged while it turns as one. A far smaller one would make Bullet's solver converge slowly; a far
larger one would change how the last joints move."""


def share_matter(matter: Matter, carriers: Mapping[str, str], lump_of: Mapping[str, Lump]) -> None:
    """Give carriers a fraction of the mass of their bodies.

    Args:
        matter: Mass properties of all other lumps; those of the carriers are added.
        carriers: The body of each carrier, by name.
        lump_of: Lumps by the names of links.
    """
    counts = Counter(carriers.values())
    for body, count in counts.items():
        fraction = min(_FRACTION, 1.0 / (count + 1))
        whole = matter.of_lumps[lump_of[body]]
        matter.of_lumps[lump_of[body]] = _scale(whole, 1.0 - count * fraction)
        for carrier, owner in carriers.items():
            if owner == body:
                matter.of_lumps[lump_of[carrier]] = _scale(whole, fraction)


def _scale(matter: MassProperties, factor: float) -> MassProperties:
    return MassProperties(matter.mass * factor, matter.center_of_mass, matter.inertia * factor)
