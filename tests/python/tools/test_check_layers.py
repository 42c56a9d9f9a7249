from __future__ import annotations

import re
from pathlib import Path

import check_layers
import pytest
from trees import write_tree

ROOT = Path(__file__).resolve().parents[3]

# A tree in which every direction that is allowed is used.
CLEAN = {
    "core/include/voxshell/result.h": "#include <vector>\n",
    "core/include/voxshell/triangle_mesh.h": '#include "voxshell/result.h"\n',
    "core/include/voxshell/grid_field.h": '#include "voxshell/triangle_mesh.h"\n',
    "core/include/voxshell/point_shell.h": '#include "voxshell/triangle_mesh.h"\n',
    "core/include/voxshell/contacts.h": '#include "voxshell/grid_field.h"\n',
    "core/include/voxshell/model.h": '#include "voxshell/point_shell.h"\n',
    "core/src/mesh/triangle_mesh.cpp": '#include "voxshell/triangle_mesh.h"\n',
    "core/src/mesh/closest_point.h": "",
    "core/src/field/grid_field.cpp": '#include "mesh/closest_point.h"\n',
    "core/src/shell/point_shell.cpp": '#include "mesh/closest_point.h"\n#include "simd/wide.h"\n',
    "core/src/simd/wide.h": "#include <immintrin.h>\ninline __m256 zero() { return _mm256_setzero_ps(); }\n",
    "core/src/simd/walk_avx2.cpp": '#include "simd/wide.h"\n#include <math.h>\n',
    "core/src/query/contacts.cpp": '#include "voxshell/contacts.h"\n#include "voxshell/point_shell.h"\n',
    "core/src/model/model.cpp": '#include "voxshell/model.h"\n#include "voxshell/grid_field.h"\n',
    "bullet/src/shape.cpp": "#include <btBulletDynamicsCommon.h>\nbtVector3 zero;\n",
    "python/bindings/core.cpp": "#include <nanobind/nanobind.h>\n",
    "python/voxshell/__init__.py": "from ._core import x\nfrom voxshell.simulation import World\n",
    "python/voxshell/errors.py": "",
    "python/voxshell/testing.py": "from voxshell.query.contacts import find\n",
    "python/voxshell/base/arguments.py": "from voxshell.errors import SettingsError\n",
    "python/voxshell/model/model.py": (
        "from voxshell import _core\nfrom voxshell.base import arguments\n"
    ),
    "python/voxshell/query/contacts.py": "from voxshell.model.model import Model\n",
    "python/voxshell/simulation/world.py": (
        "import voxshell._bullet\nfrom voxshell.recording.recording import Recording\n"
    ),
    "python/voxshell/recording/recording.py": (
        "def save_html():\n    from voxshell.viewer.replay import save\n"
    ),
    "python/voxshell/viewer/__init__.py": "",
    "python/voxshell/viewer/replay.py": (
        "import viser\nfrom voxshell.recording.recording import save_html\n"
    ),
    "python/voxshell/cli/__init__.py": "from voxshell import measuring, viewer\n",
    "python/voxshell/measuring/__init__.py": "import voxshell as vx\n",
    "studies/voxshell_studies/__init__.py": (
        "import voxshell as vx\nfrom voxshell.viewer import replay\nfrom voxshell.cli import app\n"
    ),
}


def test_every_allowed_direction_passes(tmp_path: Path) -> None:
    write_tree(tmp_path, CLEAN)
    assert [str(violation) for violation in check_layers.check(tmp_path)] == []


@pytest.mark.parametrize(
    ("name", "text", "line", "message"),
    [
        pytest.param(
            "core/src/mesh/triangle_mesh.cpp",
            '#include <cmath>\n\n#include "voxshell/grid_field.h"\n',
            3,
            'mesh includes "voxshell/grid_field.h", which belongs to field; mesh may include base, simd',
            id="mesh includes field",
        ),
        pytest.param(
            "core/include/voxshell/grid_field.h",
            '#include "voxshell/point_shell.h"\n',
            1,
            'field includes "voxshell/point_shell.h", which belongs to shell',
            id="field includes shell, in a public header",
        ),
        pytest.param(
            "core/src/query/contacts.cpp",
            '#include "voxshell/model.h"\n',
            1,
            'query includes "voxshell/model.h", which belongs to model',
            id="query includes model",
        ),
        pytest.param(
            "core/src/query/contacts.cpp",
            '#include "../mesh/closest_point.h"\n',
            1,
            "named from core/src",
            id="an include path that hides its layer",
        ),
        pytest.param(
            "core/include/voxshell/contacts.h",
            '#include "query/traverse.h"\n',
            1,
            "a public core header includes no internal one",
            id="public header includes an internal one",
        ),
        pytest.param(
            "core/include/voxshell/contacts.h",
            "#include <Eigen/Dense>\n",
            1,
            "includes <Eigen/Dense>; a public core header includes the standard library alone",
            id="third-party type in a public header",
        ),
        pytest.param(
            "core/include/voxshell/surprise.h",
            "",
            1,
            "belongs to no layer; give it a source of the same name",
            id="a public header without a layer",
        ),
        pytest.param(
            "core/src/misc/things.cpp",
            "",
            1,
            "is in no layer's folder",
            id="a folder that is no layer",
        ),
        pytest.param(
            "core/src/model/model.cpp",
            "// btVector3 in a comment is fine\nbtVector3 v;\n",
            2,
            "uses Bullet's btVector3; only bullet/",
            id="a Bullet name in the core",
        ),
        pytest.param(
            "core/src/model/model.cpp",
            '#include "voxshell/bullet/model_shape.h"\n',
            1,
            "includes Bullet (voxshell/bullet/model_shape.h)",
            id="core includes the adapter",
        ),
        pytest.param(
            "tests/cpp/core/model_test.cpp",
            "#include <BulletCollision/CollisionShapes/btBoxShape.h>\n",
            1,
            "includes Bullet",
            id="a core test includes Bullet",
        ),
        pytest.param(
            "bullet/src/shape.cpp",
            "#include <Python.h>\n",
            1,
            "includes Python (Python.h); only python/bindings/ may",
            id="the adapter includes Python",
        ),
        pytest.param(
            "core/src/query/contacts.cpp",
            "#include <immintrin.h>\n",
            1,
            "includes intrinsics (immintrin.h); only core/src/simd/ may",
            id="intrinsics header outside simd",
        ),
        pytest.param(
            "core/src/query/contacts.cpp",
            "auto x = _mm_setzero_ps();\n",
            1,
            "uses the intrinsic _mm_setzero_ps",
            id="an intrinsic outside simd",
        ),
        pytest.param(
            "core/src/simd/walk_avx2.cpp",
            "#include <vector>\n",
            1,
            "a kernel for one instruction set includes C headers alone",
            id="a C++ header in a kernel",
        ),
        pytest.param(
            "python/voxshell/simulation/world.py",
            "import numpy\nimport voxshell.viewer.replay\n",
            2,
            "simulation imports voxshell.viewer.replay, which belongs to viewer; simulation may "
            "import base, bindings, model, query, recording",
            id="simulation imports viewer",
        ),
        pytest.param(
            "python/voxshell/model/model.py",
            "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n    from voxshell.query.contacts import x\n",
            3,
            "model imports voxshell.query.contacts.x, which belongs to query; model may import base",
            id="model imports query, for types alone",
        ),
        pytest.param(
            "python/voxshell/recording/recording.py",
            "import voxshell as vx\n",
            1,
            "recording imports voxshell, which belongs to front; recording may import base",
            id="recording imports the package's front",
        ),
        pytest.param(
            "python/voxshell/model/mesh_files/drop.py",
            "from ...cli import main\n",
            1,
            "model imports voxshell.cli.main, which belongs to cli",
            id="a relative import of cli from a subpackage",
        ),
        pytest.param(
            "python/voxshell/base/arguments.py",
            "from voxshell import _core\n",
            1,
            "base imports voxshell._core, which belongs to bindings; base may import no other",
            id="base imports the bindings",
        ),
        pytest.param(
            "python/voxshell/shapes/drop.py",
            "",
            1,
            "is in no room; the folders of python/voxshell are base, cli, ",
            id="a folder that is no room",
        ),
        pytest.param(
            "python/voxshell/batch.py",
            "",
            1,
            "is in no room",
            id="a module beside the rooms",
        ),
        pytest.param(
            "python/voxshell/simulation/world.py",
            "def f():\n    from voxshell_studies import ball\n",
            2,
            "simulation imports voxshell_studies.ball, which belongs to studies",
            id="a lazy import that no exception allows",
        ),
        pytest.param(
            "python/voxshell/recording/recording.py",
            "from voxshell.viewer.replay import save\n",
            1,
            "recording imports voxshell.viewer.replay.save",
            id="the lazy exception used at module level",
        ),
        pytest.param(
            "python/voxshell/viewer/replay.py",
            "from voxshell.cli import main\n",
            1,
            "viewer imports voxshell.cli.main, which belongs to cli; viewer may import base, model",
            id="viewer imports cli",
        ),
        pytest.param(
            "python/voxshell/viewer/replay.py",
            "from voxshell import measuring\n",
            1,
            "viewer imports voxshell.measuring, which belongs to measuring",
            id="viewer imports measuring",
        ),
        pytest.param(
            "python/voxshell/cli/__init__.py",
            "import voxshell_studies.cli\n",
            1,
            "cli imports voxshell_studies.cli, which belongs to studies",
            id="cli imports the studies",
        ),
        pytest.param(
            "studies/voxshell_studies/ball.py",
            "from voxshell._bullet import World\n",
            1,
            "studies imports voxshell._bullet.World, which belongs to bindings",
            id="the studies go round the public names",
        ),
    ],
)
def test_a_violation_is_reported_where_it_is(
    tmp_path: Path, name: str, text: str, line: int, message: str
) -> None:
    write_tree(tmp_path, {**CLEAN, name: text})
    found = [str(violation) for violation in check_layers.check(tmp_path)]
    # An import against the direction may close a circle besides.
    violations = [violation for violation in found if "circle of imports" not in violation]
    assert len(violations) == 1, violations
    assert violations[0].startswith(f"{name}:{line}: ")
    assert message in violations[0]


@pytest.mark.parametrize("inside", ["", "    "], ids=["at the top", "for types alone"])
def test_a_circle_of_imports_is_reported(tmp_path: Path, inside: str) -> None:
    guard = "from typing import TYPE_CHECKING\nif TYPE_CHECKING:\n" if inside else ""
    recorder = f"{guard}{inside}from voxshell.simulation.world import World\n"
    world = "import voxshell._bullet\nfrom voxshell.simulation.recorder import Recorder\n"
    files = {
        "python/voxshell/simulation/world.py": world,
        "python/voxshell/simulation/recorder.py": recorder,
    }
    write_tree(tmp_path, {**CLEAN, **files})
    [violation] = [str(violation) for violation in check_layers.check(tmp_path)]
    assert "circle of imports: " in violation
    assert "voxshell.simulation.world -> voxshell.simulation.recorder" in violation


def test_the_table_of_folders_has_the_directions_that_are_checked() -> None:
    text = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `([^`]+)` \|.*\| (.+) \|$", text, re.MULTILINE)
    stated = {folder: set(cell.split(", ")) - {"-"} for folder, cell in rows}
    places = {"front": "python/voxshell/__init__.py", "studies": "studies/voxshell_studies"}
    checked = {f"core/src/{layer}": may for layer, may in check_layers.CORE_MAY_INCLUDE.items()}
    for room, may in check_layers.PYTHON_MAY_IMPORT.items():
        checked[places.get(room, f"python/voxshell/{room}")] = may
    assert {folder: stated.get(folder) for folder in checked} == checked


def test_command_line_says_how_many_and_fails(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_tree(tmp_path, {**CLEAN, "core/src/mesh/closest_point.h": "btScalar x;\n__m128 y;\n"})
    assert check_layers.main([str(tmp_path)]) == 1
    printed = capsys.readouterr().out.splitlines()
    assert len(printed) == 3
    assert printed[-1].startswith("2 against the layers")


def test_command_line_is_silent_when_all_is_well(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_tree(tmp_path, CLEAN)
    assert check_layers.main([str(tmp_path)]) == 0
    assert capsys.readouterr().out == ""
