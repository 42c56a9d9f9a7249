#!/usr/bin/env python3
"""Writes the tables of names in docs/api/python.md, which are read where Sphinx has not built the page.

usage: tools/list_reference.py [--write]

Before each block of directives stands a table of the names in it, with the first line of their docstrings, and
of the public members of classes and the arguments of functions. --write renews the tables; without it, the page is printed.
"""

from __future__ import annotations

import importlib
import inspect
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import voxshell
from voxshell.base.near_names import Absent

PAGE = Path(__file__).resolve().parent.parent / "docs/api/python.md"

BEGIN, END = "<!-- names -->", "<!-- end of names -->"
_BLOCK = re.compile(r"^```\{eval-rst\}\n(?P<directives>.*?)^```$", re.MULTILINE | re.DOTALL)
_TABLE = re.compile(rf"^{BEGIN}\n.*?^{END}\n\n", re.MULTILINE | re.DOTALL)
_DIRECTIVE = re.compile(r"^\.\. auto(\w+):: voxshell\.(\w+)\n((?: +:.*\n)*)", re.MULTILINE)
_ROLE = re.compile(r":\w+:`~?([^`]+)`")
_OF_DATA = {"__version__": "The version of the package, as text."}


def complete(page: str) -> str:
    """The page with a table before each block of directives."""

    def put_table(block: re.Match[str]) -> str:
        rows = "".join(f"| {' | '.join(row)} |\n" for row in _list_rows(block["directives"]))
        head = "| name | summary | members or arguments |\n|---|---|---|\n"
        return f"{BEGIN}\n{head}{rows}{END}\n\n{block[0]}"

    return _BLOCK.sub(put_table, _TABLE.sub("", page))


def _list_rows(directives: str) -> Iterator[tuple[str, str, str]]:
    for kind, name, options in _DIRECTIVE.findall(directives):
        if kind == "module":
            module = importlib.import_module(f"voxshell.{name}")
            yield f"`{name}`", _summarize(name, module), ""
            for each, thing in vars(module).items():
                if each.startswith("_") or getattr(thing, "__module__", "") != module.__name__:
                    continue
                yield f"`{name}.{each}`", _summarize(each, thing), _list_members(thing, ":members:")
            continue
        thing = getattr(voxshell, name)
        yield f"`{name}`", _summarize(name, thing), _list_members(thing, options)


def _summarize(name: str, thing: Any) -> str:
    """The first sentence of a docstring as Markdown."""
    if name in _OF_DATA:
        return _OF_DATA[name]
    first = (inspect.getdoc(thing) or "").split("\n\n")[0].replace("\n", " ")
    plain = _ROLE.sub(r"`\1`", first).replace("``", "`").replace("|", r"\|")
    return re.sub(r"(?<=[^.]\.) .*", "", plain)


def _list_members(thing: Any, options: str) -> str:
    """The members of a class that the directive shows, with () after methods; a function's arguments."""
    if inspect.isfunction(thing):
        return ", ".join(f"`{name}`" for name in inspect.signature(thing).parameters)
    if not inspect.isclass(thing) or issubclass(thing, BaseException):
        return ""
    shown = re.search(r":members:(.*)", options)
    if shown is not None and shown[1].strip():
        names = [name.strip() for name in shown[1].split(",")]
    else:
        names = list(_find_members(thing))
    return ", ".join(f"`{name}{_brackets(thing, name)}`" for name in names)


def _find_members(cls: type) -> Iterator[str]:
    """Public members of our classes, those of bases first."""
    seen = set(vars(Exception))
    ours = [base for base in cls.__mro__ if base.__module__.startswith("voxshell")]
    for base in reversed(ours):
        fields = [name for name in getattr(base, "__annotations__", {}) if name.isidentifier()]
        for name in dict.fromkeys([*fields, *vars(base)]):
            if name in seen or name.startswith("_") or isinstance(vars(base).get(name), Absent):
                continue
            seen.add(name)
            yield name


def _brackets(cls: type, name: str) -> str:
    member = inspect.getattr_static(cls, name, None)
    is_method = inspect.isfunction(member) or isinstance(member, (classmethod, staticmethod))
    return "()" if is_method else ""


def main(arguments: list[str]) -> int:
    """The command line; returns the exit code."""
    if arguments not in ([], ["--write"]):
        print(__doc__)
        return 2
    page = complete(PAGE.read_text(encoding="utf-8"))
    if arguments:
        PAGE.write_text(page, encoding="utf-8")
    else:
        print(page, end="")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
