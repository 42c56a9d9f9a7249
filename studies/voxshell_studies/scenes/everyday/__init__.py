"""Ordinary scenes with truths from outside: what a body does that slides, rolls, bounces, spins or rests.

The list, its truths and its bars were written before anything was measured by it. One module a group;
:data:`SCENES` has all of them by name, in the order of the report.
"""

from __future__ import annotations

from voxshell_studies.scenes.everyday import (
    crowds,
    drops,
    held_out,
    impacts,
    machines,
    overlaps,
    rolling,
    sliding,
    spinning,
    stacks,
)
from voxshell_studies.scenes.everyday.scene import EverydayScene

SCENES: dict[str, EverydayScene] = {
    scene.name: scene
    for module in (
        sliding,
        rolling,
        impacts,
        spinning,
        stacks,
        overlaps,
        machines,
        crowds,
        drops,
        held_out,
    )
    for scene in module.SCENES
}
"""All scenes by name, in the order of the report."""
