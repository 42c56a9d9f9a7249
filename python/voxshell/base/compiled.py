"""Compiled modules, of which a process can load only one copy: nanobind ends it at the second."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from types import ModuleType

_kept: dict[str, ModuleType] = sys.__dict__.setdefault("_voxshell_compiled", {})
"""By name. Modules of ``sys`` outlive what tests and reloaders remove from ``sys.modules``."""


def keep_compiled(*modules: ModuleType) -> None:
    """Keep loaded modules for later imports of the package."""
    _kept.update((module.__name__, module) for module in modules)


def reuse_compiled() -> None:
    """Put kept modules back where imports look for them."""
    for name, module in _kept.items():
        sys.modules.setdefault(name, module)
