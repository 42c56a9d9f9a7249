"""Checks of the arguments of queries: two bodies, the choice of a shell, and lengths and counts."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np

from voxshell import _core
from voxshell.base.arguments import as_integer, as_real
from voxshell.errors import InputTypeError, SettingsError
from voxshell.model.field import Field
from voxshell.model.model import Model
from voxshell.query.accuracy_warning import Parts, judge
from voxshell.query.scratch import QueryScratch

Collidable: TypeAlias = Model | Field
"""A body in a query: a model, or a field without a shell such as a plane, box or sphere."""

Shell: TypeAlias = Literal["auto", "fewest", "a", "b", "both"]
"""The choice of the body whose points are tested against the other's field."""

SHELLS = {
    "auto": _core.Shells.AUTOMATIC,
    "fewest": _core.Shells.FEWEST,
    "a": _core.Shells.A,
    "b": _core.Shells.B,
    "both": _core.Shells.BOTH,
}
_HINTS = {
    "Body": (
        "; pass its shape and its pose, as in {name}=body.shape and {name}_pose=body.pose, or ask its world: "
        "World.query_contacts() and World.overlaps() take bodies"
    ),
    "Compound": "; pass its parts one by one, or add it to a World and call World.query_contacts()",
    "Link": "; pass the shape and the pose of its body, which is link.body",
    "Robot": "; pass the shape and the pose of one of its bodies, which robot.bodies lists",
}
"""What to pass instead of what only a world has, by its type, which cannot be imported here."""
_OF_BOTH = ("auto", "both")  # choices that may use the shell of an analytic shape, too
_MOST = 2**63 - 1
_SINGLE_MAX = float(np.finfo(np.float32).max)


def parts(body: Collidable, name: str) -> tuple[_core.Field, _core.Model | None]:
    """Return the field of a body for the core, and its model if it is one."""
    if isinstance(body, Model):
        return body._field._core, body._core
    if isinstance(body, Field):
        return body._core, None
    *others, last = ("Model", *(kind.__name__ for kind in Field.__subclasses__()))
    kind = type(body).__name__
    if isinstance(body, (str, Path)):
        hint = f"; build a model of the file: Model.from_mesh({os.fspath(body)!r})"
    elif hasattr(body, "vertices") and hasattr(body, "faces"):  # trimesh's and ours
        hint = "; build a model of the mesh: Model.from_mesh(mesh)"
    else:
        hint = _HINTS.get(kind, "").format(name=name)
    raise InputTypeError(f"{name} must be a {', '.join(others)} or {last}, not {kind}{hint}")


def as_pair(a: Any, b: Any, shell: Any) -> tuple[Parts, _core.Shells]:
    """Return two bodies as the core takes them; warn if their automatic role may miss much."""
    shells = as_shells(shell)
    bodies = parts_of_pair(a, b, shell)
    if shell == "auto" and b._serial not in a._judged and (bodies[1] or bodies[3]):
        judge(a, b, bodies)
    return bodies, shells


def parts_of_pair(a: Any, b: Any, shell: Any) -> Parts:
    """Return fields and models with usable shells; an analytic shape may have a model, too."""
    field_a, model_a = parts(a, "a")
    field_b, model_b = parts(b, "b")
    if shell in _OF_BOTH:
        if isinstance(b, Model) and b._is_sparse and isinstance(a, Field):
            model_a = _find_shell(a)
        elif isinstance(a, Model) and a._is_sparse and isinstance(b, Field):
            model_b = _find_shell(b)
    return field_a, model_a, field_b, model_b


def _find_shell(shape: Field) -> _core.Model | None:
    if shape._shell_model is not None:
        return shape._shell_model
    from voxshell.model.shape_shells import find_shell  # importing trimesh takes long

    return find_shell(shape)


def as_shells(shell: Any) -> _core.Shells:
    """Return the core's value for a choice of shells."""
    if isinstance(shell, str) and shell in SHELLS:
        return SHELLS[shell]
    *others, last = (repr(choice) for choice in SHELLS)
    raise SettingsError(f"shell must be {', '.join(others)} or {last}, not {shell!r}")


def as_margin(value: Any, name: str = "margin") -> float:
    """Return a margin in meters that the core accepts."""
    if type(value) is float and -_SINGLE_MAX <= value <= _SINGLE_MAX:
        return value
    margin = as_real(value, name)
    if abs(margin) > _SINGLE_MAX:
        raise SettingsError(f"{name} must fit single precision, not {margin:g} m")
    return margin


def as_level(level: Any) -> int:
    """Return a level of the tree; the first by default."""
    if level is None:
        return 1
    return as_integer(level, "level", 1, _core.PointSphereTree.deepest_level)


def as_max_points(max_points: Any) -> int | None:
    """Return a number of contacts, or None for all."""
    return None if max_points is None else as_integer(max_points, "max_points", 0, _MOST)


def as_budget(budget: Any) -> int | None:
    """Return a number of nodes, or None for no limit."""
    return None if budget is None else as_integer(budget, "budget", 1, _MOST)


def as_scratch(scratch: Any) -> _core.QueryScratch | None:
    """Return the core's part of a scratch, or None."""
    if scratch is None:
        return None
    if not isinstance(scratch, QueryScratch):
        raise InputTypeError(f"scratch must be a QueryScratch, not {type(scratch).__name__}")
    return scratch._core
