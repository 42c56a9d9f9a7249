"""Scenes that the page of limits states figures of; each yields one number beside its truth.

One module a theme; :data:`SCENES` has all of them by name, in the order of the report.
"""

from __future__ import annotations

from voxshell_studies.scenes.limits import (
    blows,
    bores,
    collars,
    kinematic,
    loads,
    mechanisms,
    rolling,
    slots,
    speed,
)
from voxshell_studies.scenes.limits.scene import LimitScene

SCENES: dict[str, LimitScene] = {
    scene.name: scene
    for module in (slots, mechanisms, blows, rolling, bores, collars, kinematic, loads, speed)
    for scene in module.SCENES
}
"""All scenes by name, in the order of the report."""
