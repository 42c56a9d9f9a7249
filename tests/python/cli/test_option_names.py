"""Messages name options as people type them."""

from __future__ import annotations

import pytest
from voxshell.cli import app
from voxshell.cli.option_names import find_command, list_options, name_options

OPTIONS = ("voxel-size", "resolution", "sign", "tolerance", "point-spacing", "a-pose")


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("voxel_size must be above 0, not 0", "--voxel-size must be above 0, not 0"),
        (
            "sizes (voxel_size, resolution, point_spacing), not both",
            "sizes (--voxel-size, --resolution, --point-spacing), not both",
        ),
        ("sign='winding' silences this warning", "--sign winding silences this warning"),
        (
            "such as tolerance=0.0042, or voxel_size=0.042 for a uniform model",
            "such as --tolerance 0.0042, or --voxel-size 0.042 for a uniform model",
        ),
        ("without voxel_size= and resolution=", "without --voxel-size and --resolution"),
        ("tolerance=1e-05; repair it", "--tolerance 1e-05; repair it"),
        ("a_pose: an entry is not finite", "--a-pose: an entry is not finite"),
    ],
)
def test_arguments_of_python_become_options(text, named):
    assert name_options(text, OPTIONS) == named
    assert name_options(text, ()) == text


@pytest.mark.parametrize(
    "text",
    [
        "the resolution is 3, and the sign is open",
        "meshes.part.resolution and meshes.part.voxel_size cannot both be given",
        "cannot read voxel_size.stl: it does not exist",
        "cannot read 'a_pose'",
        "folder/voxel_size is a folder",
        "pass Model.from_mesh(..., tolerance=0.001)",
        "a_poses[0]: the last row must be 0, 0, 0, 1",
        "max_points must be at least 1",
    ],
)
def test_what_is_no_option_of_the_command_stays(text):
    assert name_options(text, OPTIONS) == text


def test_options_are_those_of_the_command():
    assert find_command(app, ["simulate", "drop", "part.stl"]) == ["simulate", "drop"]
    assert "voxel-size" in list_options(app, ["build", "part.stl", "--json"])
    assert "a-pose" in list_options(app, ["query", "a.vxs", "plane"])
    assert "voxel-size" not in list_options(app, ["simulate", "scene.toml"])
    for arguments in ([], ["--json"], ["nonsense"], ["reproduce"]):
        assert "voxel-size" not in list_options(app, arguments)
