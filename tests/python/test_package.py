"""The package as a whole: what importing it does, what it leaves behind, what it says."""

from __future__ import annotations

import doctest
import inspect
import subprocess
import sys

import pytest
import voxshell as vx
from voxshell import errors


def run(program: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=False, timeout=60
    )


def test_importing_it_imports_nothing_heavy():
    result = run(
        "import sys, voxshell\n"
        "heavy = {'trimesh', 'matplotlib', 'viser', 'scipy', 'PIL', 'cyclopts', 'rich',\n"
        "         'dask', 'distributed', 'pyarrow', 'manifold3d', 'vhacdx', 'voxshell.simulation',\n"
        "         'voxshell._bullet', 'voxshell.viewer'}\n"
        "print(sorted(heavy & set(sys.modules)))"
    )
    assert result.stdout == "[]\n", result.stderr


def test_it_leaks_nothing():
    # nanobind reports on stderr what is left when the interpreter ends.
    result = run(
        "import gc, numpy as np, trimesh, voxshell as vx\n"
        "model = vx.Model.from_mesh(trimesh.creation.box(), resolution=10)\n"
        "contacts = vx.contacts(model, vx.Plane(offset=-0.4), level=2)\n"
        "kept = [contacts.depths, model.shell.points, model.shell.tree.spheres(1)]\n"
        "kept += [contacts.manifold(), contacts.deepest_per_segment(), model.mesh, model.field]\n"
        "batch = vx.contacts_batch(model, vx.Plane(offset=-0.4), progress=lambda *report: None)\n"
        "kept += [batch[0], batch.depths, vx.collide_batch(model, vx.Plane()), vx.QueryScratch()]\n"
        "kept += [vx.distance(model, vx.Plane()), vx.contacts(model, model, shell='a', scratch=kept[-1])]\n"
        "for bad in (lambda: vx.contacts(model, vx.Plane(), a_pose=2 * np.eye(4)),\n"
        "            lambda: vx.contacts_batch(model, vx.Plane(), [2 * np.eye(4)]),\n"
        "            lambda: vx.collide_batch(model, vx.Plane(), progress=lambda: 0),\n"
        "            lambda: model.field.sample([[np.nan] * 3]),\n"
        "            lambda: vx.Model.from_mesh(([[0, 0, 0]], [[0, 0, 0]])),\n"
        "            lambda: vx.Model.from_mesh(trimesh.creation.box(), progress=lambda: 0)):\n"
        "    try: bad()\n"
        "    except (vx.VoxshellError, TypeError): pass\n"
        "    else: raise SystemExit('nothing raised')\n"
    )
    assert (result.returncode, result.stderr) == (0, "")


def test_memory_does_not_grow():
    result = run(
        "import resource, numpy as np, trimesh, voxshell as vx\n"
        "mesh = trimesh.creation.box()\n"
        "def work():\n"
        "    model = vx.Model.from_mesh(mesh, resolution=40, threads=1)  # 0.5 MB of field\n"
        "    for i in range(20):\n"
        "        vx.contacts(model, vx.Plane()).manifold()\n"
        "        model.field.sample(np.zeros((10_000, 3)))\n"
        "def peak(): return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        "for i in range(10): work()\n"
        "before = peak()\n"
        "for i in range(40): work()\n"
        "print(peak() - before)"
    )
    assert int(result.stdout) < 8_000, result.stderr  # kB; a leaked field a round would be 20 MB


def test_its_version_is_the_installed_one():
    from importlib.metadata import version

    assert vx.__version__ == version("voxshell")


PUBLIC = [name for name in vx.__all__ if not name.startswith("_") and name != "testing"]


@pytest.mark.parametrize("name", [*PUBLIC, "testing.contacts_flat"])
def test_each_public_name_explains_itself(name: str):
    thing = vx
    for part in name.split("."):
        thing = getattr(thing, part)
    assert inspect.getdoc(thing)
    if not inspect.isclass(thing):
        examples = [test.examples for test in doctest.DocTestFinder(recurse=False).find(thing)]
        assert any(examples), f"{name} has no example"


def test_errors_are_one_family():
    for name, thing in vars(errors).items():
        if inspect.isclass(thing):
            assert issubclass(thing, vx.VoxshellError), name
            assert getattr(vx, name) is thing
    for name in ("MeshError", "PoseError", "SettingsError", "MemoryLimitError"):
        assert issubclass(getattr(vx, name), ValueError)
    assert issubclass(vx.InputTypeError, TypeError)
