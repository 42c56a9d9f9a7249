"""``voxshell build``: a model file from a mesh."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter
from rich.console import Console

from voxshell.base.outputs import check_output_file, check_suffix
from voxshell.cli.bodies import DEFAULTS, ModelOptions, describe_model, is_model_file, require_file
from voxshell.cli.model_facts import describe_facts
from voxshell.cli.progress import open_progress, tracked
from voxshell.cli.tables import list_facts
from voxshell.errors import SettingsError
from voxshell.measuring.files import finite
from voxshell.measuring.units import format_size, format_time
from voxshell.model.meshes import MODEL_SUFFIX


def build(
    mesh: Path,
    /,
    *,
    output: Annotated[Path, Parameter(name=["--output", "-o"])],
    options: ModelOptions = DEFAULTS,
    json_only: Annotated[bool, Parameter(name="--json", negative="")] = False,
) -> None:
    """Build a model file from a mesh: its distance field and its shell of points.

    `voxshell query`, `voxshell.Model.load` and `voxshell/model_file.h` read the file in
    milliseconds. The file appears only once it is complete. `voxshell info MESH --advise` helps to
    choose sizes of uniform models.

    For example, a part in millimeters with errors of at most 0.1 mm, and a uniform model of a bunny
    with a given number of points, as in the thesis:

        voxshell build part.stl -o part.vxs --scale 0.001 --tolerance 0.0001
        voxshell build bunny.obj -o bunny.vxs --resolution 200 --target-points 5000

    Args:
        mesh: The mesh file: STL, OBJ, PLY, OFF, GLB, glTF, DAE or 3MF
        output: The model file to write, which ends in .vxs.
        options: How to build the model.
        json_only: Print only JSON: what was built.
    """
    require_file(mesh)
    if is_model_file(mesh):
        raise SettingsError(f"{mesh} is a model already; pass the mesh that it was built from")
    check_output_file(output)
    if output.exists() and output.samefile(mesh):
        raise SettingsError(f"{output} is the mesh itself; choose another name for the model")
    check_suffix(output, (MODEL_SUFFIX,), "a model file")
    start = time.perf_counter()
    progress = open_progress(Console(quiet=json_only, stderr=True))
    with progress, tracked(progress, f"build {mesh.name}") as track:
        model = options.build(mesh, track.update)
    seconds = time.perf_counter() - start
    model.save(output)
    size = output.stat().st_size
    if json_only:
        facts = describe_model(model) | {"file": str(output), "file_bytes": size}
        print(json.dumps(finite(facts | {"seconds": seconds})))
        return
    console = Console(highlight=False)
    console.print(list_facts(describe_facts(model)))
    console.print(f"{output}: {format_size(size)}, built in {format_time(seconds)}", soft_wrap=True)
