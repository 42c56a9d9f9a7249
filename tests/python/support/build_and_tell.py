"""Builds a model of a mesh file and tells what came of it, as JSON: a process of its own.

usage: build_and_tell.py MESH RESOLUTION PLACES.npy

So a crash or an endless build is a failed test and not the end of all tests.
"""

from __future__ import annotations

import json
import sys
import warnings
from pathlib import Path

import numpy as np
import voxshell as vx


def main(mesh: str, resolution: str, places: str) -> None:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            # As a solid: what becomes of open meshes is for test_open_meshes.py.
            model = vx.Model.from_mesh(
                Path(mesh), resolution=int(resolution), target_points=500, open="solid"
            )
        except vx.VoxshellError as error:
            print(json.dumps({"refused": str(error), "error": type(error).__name__}))
            return
    points = np.load(places)
    # A mesh that is faulty elsewhere must not make a field of nothing: its shell is on its surface.
    answer = {
        "distances": model.field.sample(points).tolist(),
        "shell": len(model.shell),
        "confidence": model.field.sign_confidence,
        "warnings": [
            str(warning.message)
            for warning in caught
            if warning.category.__module__.startswith("voxshell")
        ],
    }
    print(json.dumps(answer))


if __name__ == "__main__":
    main(*sys.argv[1:])
