#!/usr/bin/env python3
"""Checks that includes and imports only go in the directions that ARCHITECTURE.md draws.

usage: tools/check_layers.py [ROOT]

Prints one line for each violation (file:line, what, which directions are allowed) and exits 1 if
there is one. A circle of Python imports is a violation, too, also if some of them only serve types.
"""

from __future__ import annotations

import ast
import re
import sys
from collections.abc import Iterator, Set
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

# ---- the directions ------------------------------------------------------------------------------

# Layer of core/src/<layer> -> the layers whose headers it may include, itself apart.
CORE_MAY_INCLUDE: dict[str, set[str]] = {
    "base": set(),
    "simd": set(),
    "mesh": {"base", "simd"},
    "field": {"base", "simd", "mesh"},
    "shell": {"base", "simd", "mesh"},
    "query": {"base", "simd", "field", "shell"},
    "model": {"base", "simd", "mesh", "field", "shell"},
}

# A public header belongs to the layer that has the source of the same name
# (voxshell/contacts.h: query, because of core/src/query/contacts.cpp). These have no such source.
HEADER_ONLY: dict[str, str] = {
    "accuracy.h": "base",
    "bounds.h": "base",
    "cache_lines.h": "base",
    "progress.h": "base",
    "result.h": "base",
    "vector.h": "base",
    "version.h": "base",
    "field.h": "field",
    "bucket_points.h": "shell",
}

PYTHON_PACKAGES = {"voxshell": "python/voxshell", "voxshell_studies": "studies/voxshell_studies"}

# Room of voxshell, a folder -> the rooms that it may import, itself apart. "bindings" are the compiled
# modules, "front" is voxshell/__init__.py, which collects the public names; "studies" is the second
# package, which the first must work without.
_PHYSICS = {"base", "model", "query", "recording", "simulation"}
PYTHON_MAY_IMPORT: dict[str, set[str]] = {
    "base": set(),
    "model": {"base", "bindings"},
    "query": {"base", "model", "bindings"},
    "recording": {"base"},
    "simulation": {"base", "model", "query", "recording", "bindings"},
    "robots": {"base", "model", "simulation"},
    "front": {*_PHYSICS, "robots", "bindings"},
    "viewer": _PHYSICS,
    "scenes": _PHYSICS,
    "measuring": {*_PHYSICS, "front"},
    "cli": {*_PHYSICS, "front", "viewer", "scenes", "measuring"},
    "studies": {*_PHYSICS, "robots", "front", "viewer", "scenes", "measuring", "cli"},
}
PYTHON_FOLDERS = PYTHON_MAY_IMPORT.keys() - {"front", "studies"}
PYTHON_BINDINGS = {"_core", "_bullet", "_hacd"}
# Modules that are in no folder: users and the bindings import them by these names.
PYTHON_ALONE = {"errors": "base", "testing": "query"}

# (module file, room): imports against the direction that are allowed inside a function.
PYTHON_LAZY_IMPORTS: dict[tuple[str, str], str] = {
    (
        "recording/recording.py",
        "viewer",
    ): "exports and notebooks: only a caller who wants a page or a file pays",
    (
        "simulation/world_view.py",
        "viewer",
    ): "view opens the page, and only a caller who wants one pays",
}

# Where Bullet's names may appear: its adapter, the bindings, and what tests, shows or measures it.
BULLET_HOME = ("bullet/", "python/bindings/", "tests/cpp/bullet/", "benchmarks/", "examples/")
PYTHON_C_API_HOME = ("python/bindings/",)
SIMD_HOME = "core/src/simd/"

# ---- patterns ------------------------------------------------------------------------------------

CPP_ROOTS = ("core", "bullet", "python/bindings", "tests/cpp", "benchmarks", "fuzz", "examples")
CPP_SUFFIXES = {".h", ".cpp", ".inl"}
INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
COMMENT_OR_STRING = re.compile(
    r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'', re.DOTALL
)
BULLET_NAME = re.compile(r"\bbt[A-Z]\w*|\bBT_[A-Z]\w*")
BULLET_HEADER = re.compile(r"^(bt\w+\.h|(Bullet|LinearMath)\w*/.*|voxshell/bullet/.*)$")
PYTHON_C_HEADER = re.compile(r"^(Python\.h|nanobind/.*|pybind11/.*)$")
INTRINSIC_NAME = re.compile(
    r"\b_mm(?:256|512)?_\w+|\b__m(?:64|128|256|512)[di]?\b|\bv\w+q_[fsu]\d+\b"
)
INTRINSIC_HEADER = re.compile(r"^(\w*intrin\.h|arm_neon\.h|hwy/.*)$")
STANDARD_HEADER = re.compile(r"^[a-z_0-9]+$")
# A kernel compiled for one instruction set must not emit inline functions of C++ headers: the
# linker may pick that copy for every machine.
KERNEL_FILE = re.compile(r"_(scalar|sse\d*|avx\d*|neon)\.cpp$")


@dataclass(frozen=True)
class Violation:
    """One include, import or name that goes the wrong way."""

    path: str
    line: int
    what: str
    allowed: str

    def __str__(self) -> str:
        """One line, clickable in most editors."""
        return f"{self.path}:{self.line}: {self.what}; {self.allowed}"


def check(root: Path) -> list[Violation]:
    """All violations below `root`, by file and line."""
    found = [*check_cpp(root), *check_python(root), *check_circles(root)]
    return sorted(found, key=lambda violation: (violation.path, violation.line))


# ---- C++ -----------------------------------------------------------------------------------------


def check_cpp(root: Path) -> Iterator[Violation]:
    """Violations in C++ sources."""
    layers = _public_header_layers(root)
    for top in CPP_ROOTS:
        for path in sorted((root / top).rglob("*")):
            if path.suffix not in CPP_SUFFIXES:
                continue
            name = path.relative_to(root).as_posix()
            text = path.read_text(encoding="utf-8")
            yield from _check_names(name, text)
            for line, bracket, header in _includes(text):
                yield from _check_foreign_header(name, line, header)
                if name.startswith("core/"):
                    yield from _check_core_include(name, line, bracket, header, layers)
            if name.startswith("core/"):
                yield from _check_core_place(name, layers)


def _public_header_layers(root: Path) -> dict[str, str | None]:
    layers: dict[str, str | None] = {}
    for header in sorted((root / "core/include/voxshell").rglob("*.h")):
        sources = [
            layer
            for layer in CORE_MAY_INCLUDE
            if (root / "core/src" / layer / f"{header.stem}.cpp").exists()
        ]
        layers[header.name] = sources[0] if len(sources) == 1 else HEADER_ONLY.get(header.name)
    return layers


def _includes(text: str) -> Iterator[tuple[int, str, str]]:
    for number, line in enumerate(text.splitlines(), start=1):
        if match := INCLUDE.match(line):
            yield number, match[1], match[2]


def _core_layer(name: str, layers: dict[str, str | None]) -> str | None:
    parts = name.split("/")
    if name.startswith("core/src/"):
        return parts[2] if parts[2] in CORE_MAY_INCLUDE else None
    return layers.get(parts[-1])


def _check_core_place(name: str, layers: dict[str, str | None]) -> Iterator[Violation]:
    if _core_layer(name, layers) is not None:
        return
    if name.startswith("core/src/"):
        folders = ", ".join(CORE_MAY_INCLUDE)
        yield Violation(
            name, 1, "is in no layer's folder", f"the folders of core/src are {folders}"
        )
    elif name.startswith("core/include/"):
        yield Violation(
            name,
            1,
            "belongs to no layer",
            f"give it a source of the same name in one folder of core/src (core/src/<layer>/"
            f"{Path(name).stem}.cpp), or name it in HEADER_ONLY of tools/check_layers.py",
        )


def _check_core_include(
    name: str, line: int, bracket: str, header: str, layers: dict[str, str | None]
) -> Iterator[Violation]:
    public = name.startswith("core/include/")
    if bracket == "<" and not header.startswith("voxshell/"):
        if public and not STANDARD_HEADER.match(header):
            yield Violation(
                name,
                line,
                f"includes <{header}>",
                "a public core header includes the standard library alone",
            )
        if KERNEL_FILE.search(name) and not header.endswith(".h"):
            yield Violation(
                name,
                line,
                f"includes <{header}>",
                "a kernel for one instruction set includes C headers alone",
            )
        return
    if header.startswith("voxshell/bullet/"):
        return  # reported as a foreign header
    if header.startswith("voxshell/"):
        included = layers.get(header.removeprefix("voxshell/"))
    else:
        if public:
            yield Violation(
                name, line, f'includes "{header}"', "a public core header includes no internal one"
            )
            return
        folder = header.split("/")[0]
        included = folder if folder in CORE_MAY_INCLUDE else None
        if included is None:
            yield Violation(
                name,
                line,
                f'includes "{header}"',
                "internal headers are named from core/src, with their layer: "
                '"mesh/closest_point.h"',
            )
            return
    layer = _core_layer(name, layers)
    if layer is None or included is None or included == layer:
        return
    if included not in CORE_MAY_INCLUDE[layer]:
        yield Violation(
            name,
            line,
            f'{layer} includes "{header}", which belongs to {included}',
            f"{layer} may include {_listed(CORE_MAY_INCLUDE[layer])}",
        )


def _check_foreign_header(name: str, line: int, header: str) -> Iterator[Violation]:
    if BULLET_HEADER.match(header) and not name.startswith(BULLET_HOME):
        yield Violation(
            name, line, f"includes Bullet ({header})", f"only {_places(BULLET_HOME)} may"
        )
    if PYTHON_C_HEADER.match(header) and not name.startswith(PYTHON_C_API_HOME):
        yield Violation(
            name, line, f"includes Python ({header})", f"only {_places(PYTHON_C_API_HOME)} may"
        )
    if INTRINSIC_HEADER.match(header) and not name.startswith(SIMD_HOME):
        yield Violation(name, line, f"includes intrinsics ({header})", f"only {SIMD_HOME} may")


def _check_names(name: str, text: str) -> Iterator[Violation]:
    code = COMMENT_OR_STRING.sub(lambda match: "\n" * match[0].count("\n"), text)
    for number, line in enumerate(code.splitlines(), start=1):
        if line.lstrip().startswith("#"):
            continue
        if not name.startswith(BULLET_HOME) and (match := BULLET_NAME.search(line)):
            yield Violation(
                name, number, f"uses Bullet's {match[0]}", f"only {_places(BULLET_HOME)} may"
            )
        if not name.startswith(SIMD_HOME) and (match := INTRINSIC_NAME.search(line)):
            yield Violation(name, number, f"uses the intrinsic {match[0]}", f"only {SIMD_HOME} may")


# ---- Python --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Import:
    """One import of one of the packages."""

    path: str
    line: int
    importer: tuple[str, ...]
    module: tuple[str, ...]
    excepted: bool


def check_python(root: Path) -> Iterator[Violation]:
    """Violations in the Python packages."""
    for path in _python_files(root, "voxshell"):
        first = path.relative_to(root / PYTHON_PACKAGES["voxshell"]).parts[0]
        if first.removesuffix(".py") not in {"__init__", *PYTHON_FOLDERS, *PYTHON_ALONE}:
            yield Violation(
                path.relative_to(root).as_posix(),
                1,
                "is in no room",
                f"the folders of {PYTHON_PACKAGES['voxshell']} are {_listed(PYTHON_FOLDERS)}",
            )
    for each in _all_imports(root):
        room, imported = _python_room(each.importer), _python_room(each.module)
        if imported == room or imported in PYTHON_MAY_IMPORT[room] or each.excepted:
            continue
        yield Violation(
            each.path,
            each.line,
            f"{room} imports {'.'.join(each.module)}, which belongs to {imported}",
            f"{room} may import {_listed(PYTHON_MAY_IMPORT[room])}",
        )


def check_circles(root: Path) -> Iterator[Violation]:
    """A circle of imports, if there is one. Packages' own files may collect what is below them."""
    imports = [each for each in _all_imports(root) if not each.excepted]
    known = {each.importer for each in imports}
    graph: dict[tuple[str, ...], dict[tuple[str, ...], Import]] = {}
    for each in imports:
        module = each.module
        while module and module not in known:
            module = module[:-1]
        if module and module != each.importer and "__init__" not in each.importer:
            graph.setdefault(each.importer, {}).setdefault(module, each)
    try:
        TopologicalSorter({module: set(others) for module, others in graph.items()}).prepare()
    except CycleError as error:
        # Each module of this list is imported by the one after it.
        circle: list[tuple[str, ...]] = error.args[1][::-1]
        first = graph[circle[0]][circle[1]]
        ring = " -> ".join(".".join(module) for module in circle)
        yield Violation(first.path, first.line, f"circle of imports: {ring}", "none may be")


def _python_files(root: Path, package: str) -> list[Path]:
    return sorted((root / PYTHON_PACKAGES[package]).rglob("*.py"))


def _all_imports(root: Path) -> Iterator[Import]:
    for name, folder in PYTHON_PACKAGES.items():
        package = root / folder
        for path in _python_files(root, name):
            inner = path.relative_to(package)
            tree = ast.parse(path.read_text(encoding="utf-8"), filename=str(path))
            for line, module, lazy in _python_imports(tree, (name, *inner.parent.parts)):
                yield Import(
                    path.relative_to(root).as_posix(),
                    line,
                    (name, *inner.with_suffix("").parts),
                    module,
                    lazy and (inner.as_posix(), _python_room(module)) in PYTHON_LAZY_IMPORTS,
                )


def _python_room(module: tuple[str, ...]) -> str:
    """The room that a module of one of the packages belongs to."""
    package, first = module[0], module[1] if len(module) > 1 else ""
    if package == "voxshell_studies":
        return "studies"
    if first in PYTHON_BINDINGS:
        return "bindings"
    if first in PYTHON_ALONE:
        return PYTHON_ALONE[first]
    return first if first in PYTHON_FOLDERS else "front"


def _python_imports(
    tree: ast.Module, package: tuple[str, ...]
) -> Iterator[tuple[int, tuple[str, ...], bool]]:
    """(line, module, whether inside a function) of each import of the packages, made in a package."""
    lazy = {
        id(node)
        for function in ast.walk(tree)
        if isinstance(function, (ast.FunctionDef, ast.AsyncFunctionDef))
        for node in ast.walk(function)
    }
    for node in ast.walk(tree):
        modules: list[tuple[str, ...]] = []
        if isinstance(node, ast.Import):
            modules = [tuple(alias.name.split(".")) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            base = tuple(node.module.split(".")) if node.module else ()
            if node.level > 0:
                base = package[: len(package) - (node.level - 1)] + base
            # `from voxshell import viewer` imports voxshell.viewer.
            modules = [(*base, alias.name) for alias in node.names]
        else:
            continue
        for module in modules:
            if module[0] in PYTHON_PACKAGES:
                yield node.lineno, module, id(node) in lazy


# ---- output --------------------------------------------------------------------------------------


def _listed(names: Set[str]) -> str:
    return ", ".join(sorted(names)) if names else "no other"


def _places(prefixes: tuple[str, ...]) -> str:
    return ", ".join(prefixes)


def main(arguments: list[str]) -> int:
    """The command line; returns the exit code."""
    root = Path(arguments[0]) if arguments else Path(__file__).resolve().parent.parent
    violations = check(root)
    for violation in violations:
        print(violation)
    if violations:
        print(f"{len(violations)} against the layers (tools/check_layers.py has the directions)")
    return 1 if violations else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
