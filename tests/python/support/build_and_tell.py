"""Builds a model of a mesh file and tells what came of it: in a process of its own.

So a crash or an endless build is a failed test and not the end of all tests. The processes are forks of one that has
imported what they need.
"""

from __future__ import annotations

import multiprocessing
import warnings
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import numpy as np
import voxshell as vx

APART = multiprocessing.get_context("forkserver")
APART.set_forkserver_preload(["scipy.spatial", "trimesh", "voxshell"])


def build_and_tell(
    mesh: Path, resolution: int, places: np.ndarray, patience: float
) -> dict[str, Any]:
    """What came of it; a crash or a hang fails.

    Args:
        mesh: The file.
        resolution: Voxels along its longest side.
        places: (n, 3), meters, where the distance is wanted.
        patience: Seconds after which the build counts as hung.
    """
    answer, told = APART.Pipe(duplex=False)
    process = APART.Process(target=_tell, args=(mesh, resolution, places, told))
    process.start()
    told.close()
    try:
        assert answer.poll(patience), f"{mesh} is not built after {patience:g} s"
        return answer.recv()
    except EOFError:
        process.join()
        raise AssertionError(f"{mesh} ended its process with {process.exitcode}") from None
    finally:
        process.kill()
        process.join()
        answer.close()


def _tell(mesh: Path, resolution: int, places: np.ndarray, told: Connection) -> None:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            # As a solid: what becomes of open meshes is for test_open_meshes.py.
            model = vx.Model.from_mesh(mesh, resolution=resolution, target_points=500, open="solid")
        except vx.VoxshellError as error:
            told.send({"refused": str(error), "error": type(error).__name__})
            return
    told.send(
        {
            # A mesh that is faulty elsewhere must not make a field of nothing: its shell is on its surface.
            "distances": model.field.sample(places).tolist(),
            "shell": len(model.shell),
            "confidence": model.field.sign_confidence,
            "warnings": [
                str(warning.message)
                for warning in caught
                if warning.category.__module__.startswith("voxshell")
            ],
        }
    )
