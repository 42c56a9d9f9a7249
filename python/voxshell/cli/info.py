"""``voxshell info``: properties of a mesh or a model, and suitable voxel sizes."""

from __future__ import annotations

import json
import warnings
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from cyclopts import Parameter
from rich.console import Console

from voxshell.cli.bodies import describe_model, is_model_file, load_model, require_file
from voxshell.cli.model_facts import (
    MEASURED_FIELD,
    MEASURED_SHELL,
    describe_facts,
    format_extents,
)
from voxshell.cli.progress import open_progress, tracked
from voxshell.cli.tables import list_facts, new_table
from voxshell.errors import MeshError, SettingsError
from voxshell.measuring.files import finite
from voxshell.measuring.units import format_length, format_size, format_time
from voxshell.model.meshes import Mesh, MeshWarning, doubt_unit, read_mesh
from voxshell.model.model import Model

if TYPE_CHECKING:
    from rich.table import Table

    from voxshell.cli.advice import Estimate

_COARSE = 20
"""Resolution of the coarse model that shows whether a model can be built from a mesh."""


def info(
    file: Path,
    /,
    *,
    advise: Annotated[bool, Parameter(negative="")] = False,
    scale: float | None = None,
    json_only: Annotated[bool, Parameter(name="--json", negative="")] = False,
) -> None:
    """Describe a mesh or a model file, and with --advise suggest voxel sizes.

    The advice estimates memory, points, the field's error, and the times to build and to query. It
    measures coarse models on this machine and extrapolates to finer ones, which takes some seconds.

    For example:

        voxshell info bunny.vxs
        voxshell info part.stl --scale 0.001 --advise
        voxshell info part.stl --json

    Args:
        file: A model file (.vxs), or a mesh file.
        advise: Estimate what other voxel sizes and point spacings would cost.
        scale: Factor that converts a mesh to meters: 0.001 for millimeters.
        json_only: Print only JSON, in meters, bytes and seconds.
    """
    console = Console(highlight=False)
    if is_model_file(file):
        if scale is not None:
            raise SettingsError("scale is for meshes; a model has its size")
        model = load_model(file)
        mesh = Mesh(np.array(model.mesh.vertices), model.mesh.faces)
        matter = model.mass_properties()
        described: dict[str, Any] = {
            "kind": "model",
            **describe_model(model),
            "file_bytes": file.stat().st_size,
            "center_of_mass": matter.center_of_mass.tolist(),
        }
        facts = describe_facts(model)
        facts.append(("center of mass", _format_point(matter.center_of_mass)))
        facts.append(("file", format_size(file.stat().st_size)))
    else:
        require_file(file)
        mesh = read_mesh(file, scale)
        described, facts = _describe_mesh(mesh, file)
        if scale is None and (doubt := doubt_unit(file, mesh.vertices)):
            facts.append(("hint", doubt))
            described["hint"] = doubt
        described = {"kind": "mesh"} | described
    estimates = _measure(mesh, console_quiet=json_only) if advise else []
    if json_only:
        if estimates:
            described["advice"] = _describe_advice(estimates)
        print(json.dumps(finite(described)))
        return
    console.print(list_facts(facts))
    if estimates:
        for table in _make_tables(estimates):
            console.print(table)
        console.print(_explain(estimates, file, scale), soft_wrap=True)


def _describe_mesh(mesh: Mesh, file: Path) -> tuple[dict[str, Any], list[tuple[str, str]]]:
    """Describe a mesh for JSON and in words, from itself and a coarse model of it."""
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", MeshWarning)
            model = Model.from_mesh(mesh, resolution=_COARSE, cache=False)
    except MeshError as error:
        raise MeshError(f"{file}: {error}") from None
    complaints = [str(each.message) for each in caught if each.category is MeshWarning]
    volume, area = _measure_mesh(model.mesh)
    vertices, faces = model.mesh
    facts = [
        ("mesh", f"{len(faces):,} triangles, {len(vertices):,} vertices"),
        ("extents", format_extents(model.bounds)),
        ("from, to", " to ".join(_format_point(corner) for corner in model.bounds)),
        ("area", f"{area:.4g} m2"),
        ("volume", f"{volume:.4g} m3"),
        ("closed", "yes" if model.field.sign_method == "closed" else "no"),
        *(("warning", each) for each in complaints),
    ]
    described = {
        "vertices": len(vertices),
        "triangles": len(faces),
        "bounds": model.bounds.tolist(),
        "area": area,
        "volume": volume,
        "closed": model.field.sign_method == "closed",
        "sign_confidence": model.field.sign_confidence,
        "warnings": complaints,
    }
    return described, facts


def _measure_mesh(mesh: Mesh) -> tuple[float, float]:
    """Return enclosed volume and area, m3 and m2, by the divergence theorem."""
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    middle = mesh.vertices.mean(axis=0)
    volume = np.einsum("ij,ij->", a - middle, normals) / 6.0
    return float(volume), float(np.linalg.norm(normals, axis=1).sum() / 2.0)


def _measure(mesh: Mesh, *, console_quiet: bool) -> list[Estimate]:
    from voxshell.cli.advice import estimate

    progress = open_progress(Console(quiet=console_quiet, stderr=True))
    with progress, tracked(progress, "measure") as track:
        return estimate(mesh, track.update)


def _describe_advice(estimates: list[Estimate]) -> dict[str, Any]:
    from voxshell.cli.advice import recommend

    best = recommend(estimates)
    return {
        "estimates": [asdict(each) for each in estimates],
        "recommended": {"voxel_size": best.size, "point_spacing": best.size},
    }


def _make_tables(estimates: list[Estimate]) -> list[Table]:
    from voxshell.cli.advice import recommend

    best = recommend(estimates)
    fields = new_table(
        *("voxel", "along", "field", MEASURED_FIELD, "proved", "to build"),
        title="Field, by voxel size",
    )
    shells = new_table(
        *("spacing", "points", MEASURED_SHELL, "proved", "contacts", "yes or no"),
        title="Shell, by point spacing",
    )
    for each in estimates:
        about = "" if each.measured else "~"
        style = "bold" if each is best else ""
        size = format_length(each.size) + (" *" if each is best else "")
        fields.add_row(
            size,
            str(each.resolution),
            about + format_size(each.field_bytes),
            about + format_length(each.error),
            about + format_length(each.field_bound),
            about + format_time(each.build_seconds),
            style=style,
        )
        shells.add_row(
            size,
            f"{about}{float(f'{each.points:.3g}'):,.0f}",
            about + format_length(each.coverage),
            about + format_length(each.shell_bound),
            about + format_time(each.contacts_seconds),
            about + format_time(each.collide_seconds),
            style=style,
        )
    return [fields, shells]


def _explain(estimates: list[Estimate], file: Path, scale: float | None) -> str:
    from voxshell.cli.advice import (
        MOST_BUILD_SECONDS,
        MOST_BYTES,
        MOST_QUERY_SECONDS,
        recommend,
    )

    best = recommend(estimates)
    arguments = "" if scale is None else f" --scale {scale:g}"
    command = f"  voxshell build {file}{arguments} -o {file.with_suffix('.vxs').name}"
    if is_model_file(file):
        command = f"  voxshell build MESH -o {file.name}"
    return "\n".join(
        [
            f"{MEASURED_FIELD:16} measured: 99 % of the surface has a smaller error",
            f"{MEASURED_SHELL:16} measured: 99 % of it stands out less above the shell",
            f"{'proved':16} bound on that error; on the way from surface to shell",
            f"{'to build':16} field and shell of that size, on this machine",
            f"{'contacts':16} median of two such bodies that touch; likewise yes or no",
            f"{'~':16} extrapolated from coarser models",
            f"{'*':16} the finest built in {MOST_BUILD_SECONDS:g} s that takes "
            f"{format_size(MOST_BYTES)} and {format_time(MOST_QUERY_SECONDS)}:",
            f"{command} --voxel-size {best.size:.4g}",
            "These are uniform models. Without sizes, a model is built to a tolerance:",
            "edges and corners are elements of its shell, and cells at creases and in",
            "thin walls are exact. For most uses:",
            command,
        ]
    )


def _format_point(point: Any) -> str:
    return f"({', '.join(f'{x:.4g}' for x in point)})"
