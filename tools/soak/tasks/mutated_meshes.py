"""Meshes with random damage, and mesh files with random bytes changed, through the mesh builder."""

from __future__ import annotations

import resource
import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
import voxshell as vx

from soak.task import Check, Outcome, Task, Totals

SECONDS = 2.0  # of processor time that a mesh may take
LIMIT = 4 << 30  # bytes of address space on top of what is used at the start

Arrays = tuple[np.ndarray, np.ndarray]


def bodies() -> list[Arrays]:
    made = (
        trimesh.creation.box((0.1, 0.2, 0.3)),
        trimesh.creation.icosphere(1, 0.1),
        trimesh.creation.torus(0.1, 0.03, 12, 8),
        trimesh.creation.cylinder(0.05, 0.2, sections=8),
        trimesh.creation.cone(0.1, 0.2, sections=6),
    )
    return [(np.array(mesh.vertices), np.array(mesh.faces)) for mesh in made]


# ---- damage: each takes a mesh and returns another -----------------------------------------------


def some(count: int, rng: np.random.Generator) -> np.ndarray:
    return rng.choice(count, rng.integers(1, max(2, count // 4)), replace=False)


def move_vertices(vertices: np.ndarray, faces: np.ndarray, rng: np.random.Generator) -> Arrays:
    rows = some(len(vertices), rng)
    vertices[rows] += rng.normal(0.0, 10.0 ** rng.uniform(-9, 1), (len(rows), 3))
    return vertices, faces


def put_strange_numbers(
    vertices: np.ndarray, faces: np.ndarray, rng: np.random.Generator
) -> Arrays:
    strange = (np.nan, np.inf, -np.inf, 1e308, -1e300, 1e38, 1e16, 5e-324, -0.0)
    vertices[rng.integers(len(vertices)), rng.integers(3)] = rng.choice(strange)
    return vertices, faces


def scale(vertices: np.ndarray, faces: np.ndarray, rng: np.random.Generator) -> Arrays:
    return vertices * 10.0 ** rng.uniform(-30, 30, rng.choice((1, 3))), faces


def shift(vertices: np.ndarray, faces: np.ndarray, rng: np.random.Generator) -> Arrays:
    return vertices + rng.normal(size=3) * 10.0 ** rng.uniform(-3, 12), faces


def flatten(vertices: np.ndarray, faces: np.ndarray, rng: np.random.Generator) -> Arrays:
    vertices[:, rng.choice(3, rng.integers(1, 4), replace=False)] *= rng.choice((0.0, 1e-12, 1e-5))
    return vertices, faces


def drop_faces(vertices: np.ndarray, faces: np.ndarray, rng: np.random.Generator) -> Arrays:
    return vertices, np.delete(faces, rng.choice(len(faces), rng.integers(len(faces) + 1)), axis=0)


def turn_faces(vertices: np.ndarray, faces: np.ndarray, rng: np.random.Generator) -> Arrays:
    rows = some(len(faces), rng)
    faces[rows] = faces[rows][:, ::-1]
    return vertices, faces


def repeat_faces(vertices: np.ndarray, faces: np.ndarray, rng: np.random.Generator) -> Arrays:
    return vertices, np.concatenate([faces, faces[some(len(faces), rng)]])


def change_indices(vertices: np.ndarray, faces: np.ndarray, rng: np.random.Generator) -> Arrays:
    rows = some(len(faces), rng)
    faces[rows, rng.integers(3)] = rng.integers(len(vertices), size=len(rows))
    return vertices, faces


def leave_the_range(vertices: np.ndarray, faces: np.ndarray, rng: np.random.Generator) -> Arrays:
    beyond = (-1, len(vertices), 2**31 - 1, 2**31, 2**32 - 1, 2**32, 2**62)
    faces = faces.astype(np.int64)
    faces[rng.integers(len(faces)), rng.integers(3)] = rng.choice(beyond)
    return vertices, faces


def add_a_copy(vertices: np.ndarray, faces: np.ndarray, rng: np.random.Generator) -> Arrays:
    """Overlapping, nested, in itself or far away."""
    other = vertices * rng.choice((-1.0, 0.5, 1.0, 1.5)) + rng.normal(
        0, rng.choice((0, 0.05, 9)), 3
    )
    return np.concatenate([vertices, other]), np.concatenate([faces, faces + len(vertices)])


def split_vertices(vertices: np.ndarray, faces: np.ndarray, rng: np.random.Generator) -> Arrays:
    """A soup whose corners agree, or nearly."""
    soup = vertices[faces].reshape(-1, 3)
    soup += rng.normal(0.0, rng.choice((0.0, 1e-15, 1e-9, 1e-4)), soup.shape)
    return soup, np.arange(len(soup)).reshape(-1, 3)


def empty(vertices: np.ndarray, faces: np.ndarray, rng: np.random.Generator) -> Arrays:
    return (vertices[:0], faces[:0]) if rng.integers(2) else (vertices[: rng.integers(3)], faces)


DAMAGE: tuple[Callable[[np.ndarray, np.ndarray, np.random.Generator], Arrays], ...] = (
    *(move_vertices, put_strange_numbers, scale, shift, flatten, drop_faces, turn_faces),
    *(repeat_faces, change_indices, leave_the_range, add_a_copy, split_vertices, empty),
)


def mutate(arrays: Arrays, rng: np.random.Generator) -> Arrays:
    vertices, faces = (array.copy() for array in arrays)
    for damage in rng.choice(len(DAMAGE), rng.integers(1, 4)):
        if len(vertices) > 0 and len(faces) > 0 and faces.max() < len(vertices):
            vertices, faces = DAMAGE[damage](vertices, faces, rng)
    return vertices, faces


def write_damaged(arrays: Arrays, folder: Path, rng: np.random.Generator) -> Path:
    """A mesh file with some of its bytes changed, left out or repeated."""
    kind = rng.choice(["stl", "stl_ascii", "ply", "obj", "off", "glb"])
    path = folder / f"mesh.{kind.removesuffix('_ascii')}"
    made = trimesh.Trimesh(*arrays, process=False).export(file_type=kind)
    content = bytearray(made.encode() if isinstance(made, str) else made)
    for _ in range(rng.integers(1, 9)):
        at = int(rng.integers(len(content)))
        match rng.integers(4):
            case 0:
                content[at] = rng.integers(256)
            case 1:
                del content[at : at + int(rng.integers(1, 200))]
            case 2:
                content[at:at] = content[at : at + int(rng.integers(1, 200))]
            case 3:
                content[at : at + 4] = rng.choice([b"\xff" * 4, bytes(4), b" nan", b" 1e9"])
        if not content:
            break
    path.write_bytes(content)
    return path


# ---- the task ------------------------------------------------------------------------------------


def settings(rng: np.random.Generator) -> dict[str, Any]:
    chosen: dict[str, Any] = dict(
        [{"resolution": 8}, {"resolution": 16}, {"tolerance": 0.01}, {"target_points": 50}][
            rng.integers(4)
        ]
    )
    chosen["sign"] = str(rng.choice(["auto", "auto", "closed", "winding"]))
    chosen["open"] = str(rng.choice(["auto", "auto", "solid", "sheet"]))
    return chosen


def prepare() -> Check:
    warnings.simplefilter("ignore")
    originals = bodies()
    folder = Path(tempfile.mkdtemp(prefix="voxshell-soak-"))
    with open("/proc/self/statm") as file:
        used = int(file.read().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + LIMIT, resource.RLIM_INFINITY))

    def check(case: int) -> Outcome:
        rng = np.random.default_rng([case, 4])
        original = originals[rng.integers(len(originals))]
        from_file = rng.integers(5) == 0
        mesh = write_damaged(original, folder, rng) if from_file else mutate(original, rng)
        before = resource.getrusage(resource.RUSAGE_SELF)
        try:
            model = vx.Model.from_mesh(mesh, **settings(rng), cache=False, threads=1)
        except vx.VoxshellError:
            model = None
        after = resource.getrusage(resource.RUSAGE_SELF)
        seconds = after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime
        assert seconds <= SECONDS, f"took {seconds:.1f} s of processor time"
        if model is not None:
            low, high = model.bounds
            points = rng.uniform(low - 0.1, high + 0.1, (50, 3))
            assert np.isfinite(model.field.sample(points)).all(), "distances that are not finite"
            assert len(model.shell) > 0, "no points"
            vx.contacts(model, model, shell="both")
        return Outcome(
            1, {"models": model is not None, "files": int(from_file)}, {"seconds": seconds}
        )

    return check


def describe(totals: Totals) -> str:
    models, files = (totals.tallies[name] / totals.count for name in ("models", "files"))
    return (
        f"{models:.0%} became models, {1 - models:.0%} typed errors; {files:.0%} from files; "
        f"longest {totals.peaks['seconds']:.2f} s"
    )


def doubt(totals: Totals) -> str:
    models = totals.tallies["models"] / totals.count
    return "" if totals.count < 500 or 0.1 <= models <= 0.9 else f"{models:.0%} became models"


TASK = Task(
    promise="A damaged mesh becomes a model or a typed error within two seconds, without a crash",
    oracle="a monitored process, and the sampled values",
    unit="meshes",
    target=100_000,
    prepare=prepare,
    describe=describe,
    doubt=doubt,
    patience=60.0,
)
