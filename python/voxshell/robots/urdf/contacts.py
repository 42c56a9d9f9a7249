"""Materials of links, from the element ``<contact>`` that pybullet adds to URDF."""

from __future__ import annotations

from typing import TYPE_CHECKING

from voxshell.errors import SettingsError
from voxshell.simulation.material import Material

if TYPE_CHECKING:
    from voxshell.robots.xml_elements import Element

_PROPERTIES = {
    "lateral_friction": "friction",
    "restitution": "restitution",
    "rolling_friction": "rolling_friction",
    "spinning_friction": "spinning_friction",
}
"""Elements that are read, with the property of a material that each is."""


def read_material(link: Element, unread: dict[str, list[str]]) -> dict[str, float]:
    """Return the properties of a :class:`Material` that a link's ``<contact>`` states, by name.

    Args:
        link: The link.
        unread: Receives the link's name by the tag of each of the other elements.

    Raises:
        RobotError: A value is missing, no number, or out of range.
    """
    contact = link.first("contact")
    stated: dict[str, float] = {}
    for child in () if contact is None else contact.children:
        name = _PROPERTIES.get(child.tag)
        if name is None:
            names = unread.setdefault(child.tag[:60], [])
            names.append(link.attributes.get("name", ""))
            continue
        child.text("value")
        stated[name] = child.number("value") or 0.0
        try:
            Material(**{name: stated[name]})
        except SettingsError as error:
            child.refuse(f"has a <{child.tag}> out of range: {error}")
    return stated
