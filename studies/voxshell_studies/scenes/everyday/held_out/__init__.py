"""Scenes chosen by someone who has not seen the code: judge by these, and tune by the others.

Each has ``held_out=True``. Truths and bars were written before voxshell ran any of them. Measure them
after the code they judge is finished.
"""

from __future__ import annotations

from voxshell_studies.scenes.everyday.held_out import (
    balance,
    bounces,
    edges,
    fits,
    landing,
    mechanisms,
    pulling,
    rolls,
    shots,
)

SCENES = tuple(
    scene
    for module in (pulling, rolls, edges, bounces, shots, balance, landing, mechanisms, fits)
    for scene in module.SCENES
)
"""All of them, in the order of the report."""
