"""The falling bunny with every method, timed: the section's main benchmark."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell._arguments import as_integer
from voxshell.experiments.drop import FULL_OPERATION, DropRun, run_drop
from voxshell.experiments.motion import read_poses, restore, tabulate
from voxshell.experiments.part import Part
from voxshell.experiments.timing import pinned, time_poses
from voxshell.scenes.bunny import ORIENTATIONS_WXYZ, find_bunny
from voxshell.scenes.drop import METHODS, DropSettings, DropShapes, build_shapes, build_world

if TYPE_CHECKING:
    from collections.abc import Mapping

    from voxshell.experiments.motion import Surface
    from voxshell.experiments.part import Columns, Tables
    from voxshell.scenes.drop import Method

CURVES = (
    *("narrow_phase", "query", "reduction", "manifold"),
    *("contacts", "depth", "speed", "angular_speed", "lowest"),
)


@dataclass(frozen=True)
class BunnyFallSettings(DropSettings):
    """Settings of the bunny's fall.

    Attributes:
        mesh: Path of another mesh; the bunny by default.
        steps: How many, for every method
        slow_steps: but GImpact on the block, which takes tens of milliseconds a step.
        orientations: How many of :data:`voxshell.scenes.bunny.ORIENTATIONS_WXYZ`.
        equal_poses: In how many poses of the fine fall all methods are timed once more.
        repeats: How often, in turn.
    """

    mesh: str = ""
    steps: int = 2000
    slow_steps: int = 2000
    orientations: int = 3
    equal_poses: int = 50
    repeats: int = 3

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("steps", "slow_steps"):
            as_integer(getattr(self, name), name, FULL_OPERATION[1], 1_000_000)
        for name in ("equal_poses", "repeats"):
            as_integer(getattr(self, name), name, 1, 10_000)
        as_integer(self.orientations, "orientations", 1, len(ORIENTATIONS_WXYZ))


def plan(settings: BunnyFallSettings) -> list[Part]:
    """A part for each orientation: all methods in one process."""
    return [
        Part(
            f"orientation-{orientation}",
            run_methods,
            {"settings": settings, "orientation": orientation},
            timed=True,
            cost=20.0 + 0.05 * (settings.slow_steps + settings.equal_poses * settings.repeats),
        )
        for orientation in range(settings.orientations)
    ]


def run_methods(settings: BunnyFallSettings, orientation: int) -> Tables:
    """Each method's fall, and all methods in the poses of the fine one.

    Returns:
        "steps": of every method; "equal_poses": times; "hulls": points of hull and decomposition;
        "KEY_poses" and "KEY_contacts": the recordings.
    """
    shapes = build_all_shapes(settings, find_mesh(settings))
    rotation = orientation_of(orientation)
    tables: dict[str, Columns] = {}
    curves = []
    with pinned():
        for method in METHODS:
            steps = settings.slow_steps if method.is_slow else settings.steps
            run = run_drop(shapes, method, settings, steps, rotation=rotation)
            curves.append(
                {
                    "method": np.full(steps, method.key),
                    "step": np.arange(1, steps + 1),
                    **{name: getattr(run, name) for name in CURVES},
                }
            )
            motion = tabulate(run.recording)
            tables |= {f"{method.key}_{name}": table for name, table in motion.items()}
        tables["equal_poses"] = _time_equal_poses(settings, shapes, tables)
    tables["steps"] = {key: np.concatenate([curve[key] for curve in curves]) for key in curves[0]}
    tables["hulls"] = _tabulate_hulls(shapes)
    return tables


def orientation_of(number: int) -> np.ndarray:
    """``world_from_body`` without a place, (4, 4)."""
    from trimesh.transformations import quaternion_matrix

    return np.array(quaternion_matrix(ORIENTATIONS_WXYZ[number]))


def build_all_shapes(settings: DropSettings, mesh: Path) -> DropShapes:
    """Every method's shapes, built once a process for all experiments with the same drop."""
    known = {field.name for field in fields(DropSettings)}
    return _build_shapes(DropSettings(**{name: getattr(settings, name) for name in known}), mesh)


@cache
def _build_shapes(settings: DropSettings, mesh: Path) -> DropShapes:
    return build_shapes(mesh, settings)


def find_mesh(settings: BunnyFallSettings) -> Path:
    """The path of the mesh that falls."""
    return Path(settings.mesh) if settings.mesh else find_bunny()


def _time_equal_poses(
    settings: BunnyFallSettings, shapes: DropShapes, tables: Mapping[str, Columns]
) -> Columns:
    fine = {"poses": tables["vps-fine_poses"], "contacts": tables["vps-fine_contacts"]}
    chosen = np.linspace(*FULL_OPERATION, settings.equal_poses, endpoint=False).astype(int)
    poses = read_poses(fine, "body")[chosen]
    rows: dict[str, list[Any]] = {"method": [], "repeat": [], "step": [], "narrow_phase": []}
    for repeat in range(settings.repeats):
        for method in METHODS:
            world, body = build_world(shapes, method, settings, gravity=0.0)
            # The first pose warms caches and Bullet's pair up.
            times = time_poses(world, body, np.concatenate([poses[:1], poses]))["narrow_phase"][1:]
            rows["method"] += [method.key] * len(poses)
            rows["repeat"] += [repeat] * len(poses)
            rows["step"] += chosen.tolist()
            rows["narrow_phase"] += times.tolist()
    return {name: np.array(values) for name, values in rows.items()}


def _tabulate_hulls(shapes: DropShapes) -> Columns:
    points, kinds, numbers = [], [], []
    for key in ("hull", "decomposition"):
        for number, hull in enumerate(getattr(shapes.bodies[key], "hulls")):  # noqa: B009
            points.append(hull)
            kinds += [key] * len(hull)
            numbers += [number] * len(hull)
    stacked = np.concatenate(points)
    return {
        "kind": np.array(kinds),
        "number": np.array(numbers),
        **{axis: stacked[:, i] for i, axis in enumerate("xyz")},
    }


def read_run(
    tables: Tables, method: Method, surfaces: Mapping[str, Surface], time_step: float
) -> DropRun:
    """A method's fall as it was run, from the tables of an orientation."""
    steps = tables["steps"]
    mine = steps["method"] == method.key
    motion = {name: tables[f"{method.key}_{name}"] for name in ("poses", "contacts")}
    return DropRun(
        method=method,
        recording=restore(motion, surfaces, time_step),
        **{name: steps[name][mine] for name in CURVES},
    )
