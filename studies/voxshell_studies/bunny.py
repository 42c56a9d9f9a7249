"""The falling bunny with every method, timed: the main benchmark of the thesis' section."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from voxshell.base.arguments import as_integer
from voxshell.measuring.timing import pinned
from voxshell.model.meshes import Mesh, read_mesh
from voxshell.model.model import Model
from voxshell.simulation.comparison_shapes import ConvexDecomposition

from voxshell_studies.convex_parts import RECIPES, split
from voxshell_studies.drop import FULL_OPERATION, DropRun, run_drop
from voxshell_studies.hull_tables import tabulate_hulls
from voxshell_studies.motion import read_poses, restore, tabulate
from voxshell_studies.part import Part
from voxshell_studies.scenes.bunny import ORIENTATIONS_WXYZ, find_bunny
from voxshell_studies.scenes.drop import (
    BULLET_MARGIN,
    METHODS,
    DropSettings,
    DropShapes,
    Method,
    build_shapes,
    build_world,
)
from voxshell_studies.timing import STAGES, time_poses

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from voxshell_studies.motion import Surface
    from voxshell_studies.part import Columns, Tables

CURVES = (
    *("narrow_phase", *STAGES),
    *("contacts", "depth", "speed", "angular_speed", "lowest"),
)


LEVELS = (1, 2, 3, 4, 5)
"""Of segments."""

Decomposer = Literal["hacd", "coacd"]
"""HACD from Bullet's extras, as published, and CoACD, which is in use today; see
:data:`voxshell_studies.convex_parts.RECIPES`."""

_DECOMPOSITION = next(method for method in METHODS if method.key == "decomposition")
DECOMPOSERS = (
    Method("hacd", "HACD", "box", _DECOMPOSITION.thesis_ratio),
    Method("coacd", "CoACD", "box"),
)


@dataclass(frozen=True)
class BunnyFallSettings(DropSettings):
    """Settings of the bunny's fall.

    Attributes:
        mesh: Path of another mesh; the bunny by default.
        steps: Number of steps for every method.
        slow_steps: Number of steps for GImpact on the block, which takes tens of milliseconds per
            step.
        orientations: Number of :data:`voxshell_studies.scenes.bunny.ORIENTATIONS_WXYZ` to use.
        equal_poses: Number of poses of the fine fall in which all methods are timed once more.
        repeats: Number of repetitions, in turn.
        decomposers: Further convex decompositions that fall, besides V-HACD's.
    """

    mesh: str = ""
    steps: int = 2000
    slow_steps: int = 2000
    orientations: int = 3
    equal_poses: int = 50
    repeats: int = 3
    decomposers: tuple[Decomposer, ...] = ("hacd", "coacd")

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("steps", "slow_steps"):
            as_integer(getattr(self, name), name, FULL_OPERATION[1], 1_000_000)
        for name in ("equal_poses", "repeats"):
            as_integer(getattr(self, name), name, 1, 10_000)
        as_integer(self.orientations, "orientations", 1, len(ORIENTATIONS_WXYZ))


def plan(settings: BunnyFallSettings) -> list[Part]:
    """Return a part for each orientation, with all methods, after slow decompositions."""
    here = {"mesh": str(find_mesh(settings)), "size": settings.size}
    # V-HACD always falls: without it, the fall says what to install.
    splits = find_decomposers(settings)
    if RECIPES["vhacd"].version is not None:
        splits = ["vhacd", *splits]
    # The libraries' versions are included, so a missing library makes the part run after
    # installation.
    libraries = {key: RECIPES[key].identity for key in find_decomposers(settings)}
    return [
        *(
            Part(
                f"split-{key}",
                split_mesh,
                {**here, "decomposer": key, "library": RECIPES[key].identity},
                cost={"vhacd": 9.0, "hacd": 10.0, "coacd": 160.0}[key],
            )
            for key in splits
        ),
        *(
            Part(
                f"orientation-{orientation}",
                run_methods,
                {"settings": settings, "orientation": orientation, "libraries": libraries},
                timed=True,
                cost=20.0 + 0.05 * (settings.slow_steps + settings.equal_poses * settings.repeats),
            )
            for orientation in range(settings.orientations)
        ),
    ]


def find_decomposers(settings: BunnyFallSettings) -> list[Decomposer]:
    """Return the decomposers in the settings that are installed."""
    return [key for key in settings.decomposers if RECIPES[key].version is not None]


def split_mesh(mesh: str, size: float, decomposer: str, library: str) -> Tables:
    """Put the convex parts into the cache for the timed parts; return the numbers of their points.

    Args:
        mesh: Path.
        size: Longest side to which the mesh is scaled, meters.
        decomposer: The decomposer.
        library: Version of its library.
    """
    assert library
    hulls = split(read_scaled(Path(mesh), size), RECIPES[decomposer]).hulls
    return {"hulls": {"points": np.array([len(hull) for hull in hulls])}}


def read_scaled(path: Path, size: float) -> Mesh:
    """Return a mesh whose longest side is ``size``, meters."""
    mesh = read_mesh(path)
    return Mesh(mesh.vertices * (size / np.ptp(mesh.vertices, axis=0).max()), mesh.faces)


def run_methods(
    settings: BunnyFallSettings, orientation: int, libraries: Mapping[Decomposer, str]
) -> Tables:
    """Run each method's fall, and all methods in the poses of the fine one.

    Returns:
        "steps": of every method; "equal_poses": times; "hulls": points of hull and decompositions;
        "split": what further decompositions took, seconds; "body", "shells" and "segments": the
        set-up as it was built; "KEY_poses" and "KEY_contacts": the recordings.
    """
    shapes = build_all_shapes(settings, find_mesh(settings))
    made = {key: split(shapes.mesh, RECIPES[key]) for key in libraries}
    bodies = {
        key: ConvexDecomposition(parts.hulls, margin=BULLET_MARGIN) for key, parts in made.items()
    }
    shapes = replace(shapes, bodies=shapes.bodies | bodies)
    methods = (*METHODS, *(method for method in DECOMPOSERS if method.key in libraries))
    rotation = orientation_of(orientation)
    tables: dict[str, Columns] = {}
    curves = []
    with pinned():
        for method in methods:
            steps = settings.slow_steps if method.is_slow else settings.steps
            run = run_drop(shapes, method, settings, steps, rotation=rotation)
            curves.append(
                {
                    "method": np.full(steps, method.key),
                    "step": np.arange(1, steps + 1),
                    **{name: getattr(run, name) for name in CURVES},
                }
            )
            for name, columns in tabulate(run.recording).items():
                tables[f"{method.key}_{name}"] = columns
        tables["equal_poses"] = _time_equal_poses(settings, shapes, methods, tables)
    tables["steps"] = {key: np.concatenate([curve[key] for curve in curves]) for key in curves[0]}
    tables["hulls"] = tabulate_hulls(
        {
            key: body.hulls
            for key, body in shapes.bodies.items()
            if isinstance(body, ConvexDecomposition)
        }
    )
    tables |= _measure_shapes(shapes)
    tables["split"] = {
        "method": np.array(list(made), np.str_),
        "seconds": np.array([parts.seconds for parts in made.values()]),
    }
    return tables


def _measure_shapes(shapes: DropShapes) -> dict[str, Columns]:
    """Return sides, meters, moments of inertia, kg m2, points of shells, and segments."""
    shells = {key: body.shell for key, body in shapes.bodies.items() if isinstance(body, Model)}
    tree = shells["vps-fine"].tree
    return {
        "body": {
            "side": np.ptp(shapes.mesh.vertices, axis=0),
            "moment": np.diag(shapes.mass_properties.inertia),
        },
        "shells": {
            "method": np.array(list(shells)),
            "points": np.array([len(shell) for shell in shells.values()]),
        },
        "segments": {
            "level": np.array(LEVELS),
            "segments": np.array([len(np.unique(tree.segments(level))) for level in LEVELS]),
        },
    }


def orientation_of(number: int) -> np.ndarray:
    """Return ``world_from_body`` at the origin, (4, 4)."""
    from trimesh.transformations import quaternion_matrix

    return np.array(quaternion_matrix(ORIENTATIONS_WXYZ[number]))


def build_all_shapes(settings: DropSettings, mesh: Path) -> DropShapes:
    """Return every method's shapes, built once per process for equal drops."""
    known = {field.name for field in fields(DropSettings)}
    return _build_shapes(DropSettings(**{name: getattr(settings, name) for name in known}), mesh)


@cache
def _build_shapes(settings: DropSettings, mesh: Path) -> DropShapes:
    others = tuple(method for method in METHODS if method is not _DECOMPOSITION)
    shapes = build_shapes(mesh, settings, others)
    parts = split(shapes.mesh, RECIPES["vhacd"])
    body = ConvexDecomposition(parts.hulls, margin=BULLET_MARGIN)
    return replace(shapes, bodies=shapes.bodies | {_DECOMPOSITION.key: body})


def find_mesh(settings: BunnyFallSettings) -> Path:
    """Return the path of the mesh that falls."""
    return Path(settings.mesh) if settings.mesh else find_bunny()


def methods_of(tables: Tables) -> tuple[Method, ...]:
    """Return the methods that fell."""
    present = set(tables["steps"]["method"].tolist())
    return tuple(method for method in (*METHODS, *DECOMPOSERS) if method.key in present)


def _time_equal_poses(
    settings: BunnyFallSettings,
    shapes: DropShapes,
    methods: Sequence[Method],
    tables: Mapping[str, Columns],
) -> Columns:
    fine = {"poses": tables["vps-fine_poses"], "contacts": tables["vps-fine_contacts"]}
    chosen = np.linspace(*FULL_OPERATION, settings.equal_poses, endpoint=False).astype(int)
    poses = read_poses(fine, "body")[chosen]
    rows: dict[str, list[Any]] = {"method": [], "repeat": [], "step": [], "narrow_phase": []}
    for repeat in range(settings.repeats):
        for method in methods:
            world, body = build_world(shapes, method, settings, gravity=0.0)
            # The first pose warms up the caches and Bullet's pair.
            times = time_poses(world, body, np.concatenate([poses[:1], poses]))["narrow_phase"][1:]
            rows["method"] += [method.key] * len(poses)
            rows["repeat"] += [repeat] * len(poses)
            rows["step"] += chosen.tolist()
            rows["narrow_phase"] += times.tolist()
    return {name: np.array(values) for name, values in rows.items()}


def read_run(
    tables: Tables, method: Method, surfaces: Mapping[str, Surface], time_step: float
) -> DropRun:
    """Return a method's fall as it was run, from the tables of an orientation."""
    steps = tables["steps"]
    mine = steps["method"] == method.key
    motion = {name: tables[f"{method.key}_{name}"] for name in ("poses", "contacts")}
    return DropRun(
        method=method,
        recording=restore(motion, surfaces, time_step),
        **{name: steps[name][mine] for name in CURVES},
    )
