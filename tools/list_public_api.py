#!/usr/bin/env python3
"""Lists everything public of the Python package, one name a line, with signatures.

usage: tools/list_public_api.py [--write]

The list is committed as tests/python/public_api.txt, so that a review shows each change of the public
interface. --write renews that file; without it, the list is printed.
"""

from __future__ import annotations

import enum
import inspect
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import voxshell
import voxshell.recording
from voxshell.base.near_names import Absent, Refusal

COMMITTED = Path(__file__).resolve().parent.parent / "tests/python/public_api.txt"
# Modules that users import by their own path. All other names are `voxshell.<name>`.
MODULES = (voxshell, voxshell.errors, voxshell.recording, voxshell.testing)
_SPECIAL = ("__contains__", "__enter__", "__getitem__", "__iter__", "__len__")
# What the library makes classes of that users do not make.
_MADE_BY_US = ("(core:", "(simulation:", "(world:")
_FIELD = ": attribute"
_ATTRIBUTE = re.compile(r"^ +self\.([a-z]\w*)(?::([^=\n]+))? = ", re.MULTILINE)


def list_api() -> str:
    """The list, in the order of the alphabet within each module."""
    return "".join(f"{line}\n" for module in MODULES for line in _list_module(module))


def _list_module(module: ModuleType) -> Iterator[str]:
    names = getattr(module, "__all__", None) or [
        name
        for name, thing in vars(module).items()
        if not name.startswith("_") and getattr(thing, "__module__", "") == module.__name__
    ]
    for name in sorted(names):
        path, thing = f"{module.__name__}.{name}", getattr(module, name)
        if inspect.isclass(thing):
            yield from _list_class(path, thing)
        elif callable(thing):
            yield path + _describe_signature(thing)
        else:
            yield f"{path}: {type(thing).__name__}"


def _list_class(path: str, cls: type) -> Iterator[str]:
    bases = ", ".join(base.__name__ for base in cls.__bases__ if _is_public(base))
    made = "" if issubclass(cls, BaseException) else _describe_signature(cls)
    if made.startswith(_MADE_BY_US):
        made = ""
    yield f"class {path}{made}" + (f" is a {bases}" if bases else "")
    ours = [base for base in cls.__mro__ if base.__module__.startswith("voxshell")]
    members: dict[str, str] = {}
    for base in reversed(ours):
        init = vars(base).get("__init__")
        init = inspect.unwrap(init) if inspect.isfunction(init) else init
        if inspect.isfunction(init) and init.__code__.co_filename != "<string>":  # of a dataclass
            for match in _ATTRIBUTE.finditer(inspect.getsource(init)):
                members[match[1]] = f": {(match[2] or 'attribute').strip()}"
        for name, member in vars(base).items():
            if isinstance(member, Absent):
                continue
            if name in _SPECIAL or not name.startswith("_"):
                described = _describe_member(base, name, member)
                members[name] = members.get(name, described) if described == _FIELD else described
    for name in inspect.signature(cls).parameters if made else ():
        if members.get(name) == _FIELD:  # the line of the class says as much
            del members[name]
    for name in sorted(members):
        yield f"    {name}{members[name]}"


def _is_public(base: type) -> bool:
    """Whether it is a name of ours that is public, or Python's own."""
    return base is not object and (
        base.__module__ == "builtins" or base.__name__ in voxshell.__all__
    )


def _describe_member(cls: type, name: str, member: Any) -> str:
    if isinstance(member, property):
        signature = inspect.signature(member.fget) if member.fget else None
        answer = _describe_type(signature.return_annotation) if signature else "?"
        settable = member.fset is not None and not isinstance(member.fset, Refusal)
        return f": {answer} (property{', settable' if settable else ''})"
    if isinstance(member, (classmethod, staticmethod)):
        return f"{_describe_signature(getattr(cls, name))} ({type(member).__name__})"
    if callable(member):
        return _describe_signature(member)
    return _FIELD


def _describe_signature(function: Any) -> str:
    signature = inspect.signature(function)
    parts: list[str] = []
    after_positional = False
    for parameter in signature.parameters.values():
        kind = parameter.kind
        if kind is parameter.KEYWORD_ONLY and not after_positional:
            after_positional = True
            parts.append("*")
        if kind is parameter.VAR_POSITIONAL:
            after_positional = True
        star = {parameter.VAR_POSITIONAL: "*", parameter.VAR_KEYWORD: "**"}.get(kind, "")
        text = star + parameter.name
        if parameter.annotation is not parameter.empty:
            text += f": {_describe_type(parameter.annotation)}"
        if parameter.default is not parameter.empty:
            text += f" = {_describe_value(parameter.default)}"
        parts.append(text)
    answer = signature.return_annotation
    back = "" if answer is signature.empty else f" -> {_describe_type(answer)}"
    return f"({', '.join(parts)}){back}"


def _describe_type(annotation: Any) -> str:
    annotation = getattr(annotation, "__forward_arg__", annotation)  # of a NamedTuple
    return annotation if isinstance(annotation, str) else inspect.formatannotation(annotation)


def _describe_value(value: Any) -> str:
    return str(value) if isinstance(value, enum.Enum) else repr(value)


def main(arguments: list[str]) -> int:
    """The command line; returns the exit code."""
    if arguments not in ([], ["--write"]):
        print(__doc__)
        return 2
    if arguments:
        COMMITTED.write_text(list_api(), encoding="utf-8")
    else:
        print(list_api(), end="")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
