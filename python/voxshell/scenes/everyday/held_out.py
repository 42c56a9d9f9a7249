"""Scenes chosen by someone who has not seen the code: judge by these, and tune by the others.

Each has ``held_out=True``. Whoever adds one measures it once, after the code it judges is finished.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from voxshell.scenes.everyday.scene import EverydayScene

SCENES: tuple[EverydayScene, ...] = ()
