"""``voxshell info``: properties of a mesh or a model, and a suitable tolerance and voxel sizes."""

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
    THINNEST,
    describe_facts,
    format_extents,
)
from voxshell.cli.progress import open_progress, tracked
from voxshell.cli.tables import list_facts, new_table
from voxshell.errors import MeshError, SettingsError
from voxshell.measuring.files import finite
from voxshell.measuring.units import format_length, format_size, format_time
from voxshell.model.build_settings import SHEET_OF_SIDE, choose_tolerance
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
    """Describe a mesh or a model file, and with --advise recommend how to build it.

    For most uses, the advice is the default tolerance. For uniform models, it estimates memory,
    points, the field's error, and the times to build and to query over voxel sizes. It measures
    coarse models on this machine and extrapolates to finer ones, which takes some seconds.

    For example:

        voxshell info bunny.vxs
        voxshell info part.stl --scale 0.001 --advise
        voxshell info part.stl --json

    Args:
        file: A model file (.vxs), or a mesh file.
        advise: Recommend a tolerance, and estimate what uniform models would cost.
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
        longest = float(np.ptp(model.bounds, axis=0).max())
        tolerance = choose_tolerance(longest, model.thickness)
        facts = describe_facts(model)
        facts.append(("center of mass", f"{_format_point(matter.center_of_mass)} m"))
        facts.append(("file", format_size(file.stat().st_size)))
    else:
        require_file(file)
        mesh = read_mesh(file, scale)
        described, facts = _describe_mesh(mesh, file)
        tolerance = described["default_tolerance"]
        if scale is None and (doubt := doubt_unit(file, mesh.vertices)):
            facts.append(("hint", doubt))
            described["hint"] = doubt
        described = {"kind": "mesh"} | described
    estimates = _measure(mesh, console_quiet=json_only) if advise else []
    if json_only:
        if estimates:
            described["advice"] = _describe_advice(estimates, tolerance)
        print(json.dumps(finite(described)))
        return
    console.print(list_facts(facts))
    if estimates:
        build = _write_command(file, scale)
        console.print(
            f"\nFor most uses, build to the default tolerance, {format_length(tolerance)}; a larger one makes\n"
            f"a smaller model:\n{build}\n{build} --tolerance {2.0 * tolerance:.2g}\n\n"
            "Uniform models have one voxel size everywhere, and no edge segments:",
            soft_wrap=True,
        )
        for table in _make_tables(estimates):
            console.print(table)
        console.print(_explain(estimates, build), soft_wrap=True)


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
    longest = float(np.ptp(mesh.vertices, axis=0).max())
    thickness = model.thickness
    *_, sheet = model._core.openings
    if sheet > 0.0:  # its thickness, which is larger in a coarse model
        thickness = min(thickness, SHEET_OF_SIDE * longest)
    tolerance = choose_tolerance(longest, thickness)
    facts = [
        ("mesh", f"{len(faces):,} triangles, {len(vertices):,} vertices"),
        ("extents", format_extents(model.bounds)),
        ("from, to", " to ".join(_format_point(corner) for corner in model.bounds)),
        ("area", f"{area:.4g} m2"),
        ("volume", f"{volume:.4g} m3"),
        (THINNEST, format_length(thickness)),
        ("default tolerance", format_length(tolerance)),
        ("closed", "yes" if model.field.sign_method == "closed" else "no"),
        *(("warning", each) for each in complaints),
    ]
    described = {
        "vertices": len(vertices),
        "triangles": len(faces),
        "bounds": model.bounds.tolist(),
        "area": area,
        "volume": volume,
        "thickness": thickness,
        "default_tolerance": tolerance,
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


def _describe_advice(estimates: list[Estimate], tolerance: float) -> dict[str, Any]:
    from voxshell.cli.advice import recommend

    best = recommend(estimates)
    return {
        "recommended": {"tolerance": tolerance},
        "estimates": [asdict(each) for each in estimates],
        "recommended_uniform": {"voxel_size": best.size, "point_spacing": best.size},
    }


def _make_tables(estimates: list[Estimate]) -> list[Table]:
    from voxshell.cli.advice import recommend

    best = recommend(estimates)
    fields = new_table(
        *("voxel", "along", "field", MEASURED_FIELD, "proven", "build"),
        title="Field, by voxel size",
    )
    shells = new_table(
        *("spacing", "points", MEASURED_SHELL, "proven", "contacts", "yes or no"),
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


def _write_command(file: Path, scale: float | None) -> str:
    """Return the command that builds a model to the default tolerance."""
    if is_model_file(file):
        return f"  voxshell build MESH -o {file.name}"
    arguments = "" if scale is None else f" --scale {scale:g}"
    return f"  voxshell build {file}{arguments} -o {file.with_suffix('.vxs').name}"


def _explain(estimates: list[Estimate], build: str) -> str:
    from voxshell.cli.advice import (
        MOST_BUILD_SECONDS,
        MOST_BYTES,
        MOST_QUERY_SECONDS,
        recommend,
    )

    best = recommend(estimates)
    return "\n".join(
        [
            f"{'along':15} number of voxels along the longest side",
            f"{MEASURED_FIELD:15} measured: 99 % of the surface has a smaller error",
            f"{MEASURED_SHELL:15} measured: the shell misses less depth on 99 % of the surface",
            f"{'proven':15} proven bound of the field error, or of the distance to the shell",
            f"{'build':15} time to build a field and a shell of that size on this machine",
            f"{'contacts':15} median time to find the contacts of two such bodies that touch",
            f"{'yes or no':15} median time to find out whether they touch",
            f"{'~':15} extrapolated from coarser models",
            f"{'*':15} the finest size within {MOST_BUILD_SECONDS:g} s, {format_size(MOST_BYTES)} "
            f"and {format_time(MOST_QUERY_SECONDS)}:",
            f"{build} --voxel-size {best.size:.4g}",
        ]
    )


def _format_point(point: Any) -> str:
    return f"({', '.join(f'{x:.4g}' for x in point)})"
