from __future__ import annotations

import subprocess
import sys

import pytest


@pytest.mark.parametrize(
    "forget",
    [
        "with mock.patch.dict(sys.modules):\n    import voxshell\n    voxshell.World()\n",
        "import voxshell\nwith mock.patch.dict(sys.modules):\n    voxshell.World()\n",
        "import voxshell\nvoxshell.World()\n"
        "for name in [name for name in sys.modules if name.startswith('voxshell')]:\n"
        "    del sys.modules[name]\n",
    ],
)
def test_it_can_be_imported_again(forget: str):
    """nanobind ended the process."""
    program = (
        f"import sys\nfrom unittest import mock\nimport numpy, trimesh\n{forget}"
        "import voxshell as vx\n"
        "world = vx.World()\n"
        "world.add(vx.ConvexHull(trimesh.creation.box().vertices))\n"
        "world.step(1)\n"
        "try: vx.Model.load('/')\n"
        "except vx.FileAccessError: print(vx.Accuracy.__name__)\n"
    )
    result = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, timeout=60, check=False
    )
    assert (result.returncode, result.stdout, result.stderr) == (0, "Accuracy\n", "")
