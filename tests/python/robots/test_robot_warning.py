"""The warning about what a robot's file lacks, and what of it is faulty."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh
import voxshell as vx
from voxshell.model.build_warnings import Finding
from voxshell.robots.description import RobotDescription
from voxshell.robots.matter import Matter
from voxshell.robots.robot_warning import warn_of_robot

INERTIAL = (
    '<inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>'
    "</inertial>"
)
MESH = '<collision><geometry><mesh filename="{}"/></geometry></collision>'
BALL = '<collision><geometry><sphere radius="0.1"/></geometry></collision>'
SEEN = '<visual><geometry><box size="1 1 1"/></geometry></visual>'


def link(name: str, content: str) -> str:
    return f'<link name="{name}">{INERTIAL}{content}</link>'


def joint(name: str, parent: str, child: str, content: str = "", kind: str = "revolute") -> str:
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f"{content}</joint>"
    )


LIMIT = '<limit lower="{}" upper="{}" effort="9" velocity="1"/>'


@pytest.fixture
def write(tmp_path: Path) -> Callable[..., Path]:
    def write(*content: str) -> Path:
        path = tmp_path / "robot.urdf"
        path.write_text(f'<robot name="tester">{"".join(content)}</robot>')
        return path

    return write


@pytest.fixture
def open_box(tmp_path: Path) -> str:
    """The name of a mesh without one triangle."""
    box = trimesh.creation.box((0.1, 0.1, 0.1))
    box.update_faces(np.arange(11))
    box.export(tmp_path / "open.stl")
    return "open.stl"


def load(path: Path, **options: object) -> tuple[vx.Robot, list[str]]:
    """The robot and all warnings, which are one about the robot, or none."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        robot = vx.load_urdf(vx.World(), path, **options)  # pyright: ignore[reportArgumentType]
    assert all(it.category is vx.RobotWarning and it.filename == __file__ for it in caught)
    assert len(caught) <= 1
    return robot, [str(it.message) for it in caught]


def test_faulty_meshes_are_listed_with_their_links_and_files(write, open_box, tmp_path):
    inverted = trimesh.creation.box((0.1, 0.1, 0.1))
    inverted.invert()
    inverted.export(tmp_path / "inverted.stl")
    path = write(
        link("a", MESH.format(open_box)), link("b", MESH.format(open_box)),
        link("c", MESH.format("inverted.stl")),
        joint("x", "a", "b", LIMIT.format(-1, 1)), joint("y", "b", "c", LIMIT.format(-1, 1)),
    )  # fmt: skip
    _, [said] = load(path)
    assert said.startswith(f"{path}:\n- has faulty meshes; winding numbers decide what is inside")
    assert "'a', 'b' (open.stl: 3 open edges, 1 opening, the largest 0.141 m across)" in said
    assert "voxshell turned it: 'c' (inverted.stl: inside out as a whole)" in said
    assert (
        ", the largest 0.141 m across); repair them, or pass open='solid', open='sheet' or mesh_as='hull'"
        in said
    )
    assert said.endswith("; repair them, or pass mesh_as='hull', to avoid this warning")
    assert "sign=" not in said
    assert load(path, mesh_as="hull")[1] == []


def test_models_that_miss_the_tolerance_are_listed(write, tmp_path):
    rng = np.random.default_rng(1)
    rough = trimesh.creation.icosphere(4, radius=0.1)
    rough.vertices *= 1.0 + 0.2 * rng.random((len(rough.vertices), 1))
    faces = np.arange(len(rough.faces) - 1)  # without exact cells, which need a closed mesh
    rough.update_faces(faces)
    rough.export(tmp_path / "rough.ply")
    _, [said] = load(write(link("a", MESH.format("rough.ply"))), tolerance=1e-4)
    assert (
        "models that are inaccurate or large: 'a' (rough.ply: misses the tolerance of 0.1 m" in said
    )
    assert "or pass another tolerance=" in said


def test_faults_of_meshes_are_listed_up_to_a_number():
    robot = RobotDescription("f", "r", {}, {})
    for number in range(40):
        fault = Finding(vx.MeshWarning, "", f"{number} open edges", "it was closed")
        robot.note_flaws(f"link{number}", "folder/part.stl", [fault])
        robot.note_flaws(f"link{number}", "folder/part.stl", [fault])
    with pytest.warns(vx.RobotWarning) as caught:
        warn_of_robot(robot, Matter())
    said = str(caught[0].message)
    assert said.startswith("f has faulty meshes; it was closed: 'link0' (part.stl: 0 open edges), ")
    assert said.count("(part.stl: ") == 30
    assert ", and 10 more; repair them" in said


@pytest.mark.parametrize("fixed_base", [True, False])
def test_links_that_are_seen_but_cannot_be_touched_are_named(write, fixed_base):
    path = write(
        link("a", SEEN), link("b", SEEN), link("frame", ""),
        joint("x", "a", "b", LIMIT.format(-1, 1)), joint("y", "a", "frame", LIMIT.format(-1, 1)),
    )  # fmt: skip
    _, [said] = load(path, fixed_base=fixed_base)
    assert "2 links without <collision> cannot be touched, although visible ('a', 'b');" in said


def test_links_that_are_part_of_a_body_that_can_be_touched_are_not_named(write):
    path = write(link("a", BALL), link("b", SEEN), joint("x", "a", "b", kind="fixed"))
    assert load(path)[1] == []


def test_joints_that_cannot_begin_at_0_are_named_and_begin_at_the_nearest_limit(write):
    path = write(
        link("a", ""), link("b", ""), link("c", ""), link("d", ""), link("e", ""),
        joint("x", "a", "b", LIMIT.format(-3.07, -0.07)), joint("y", "b", "c", LIMIT.format(0, 1)),
        joint("z", "c", "d", LIMIT.format(0.5, 2)),
        joint("follower", "c", "e", LIMIT.format(-1, 1) + '<mimic joint="x" multiplier="2"/>'),
    )  # fmt: skip
    robot, [said] = load(path)
    assert robot.positions == pytest.approx({"x": -0.07, "y": 0.0, "z": 0.5, "follower": -0.14})
    assert said == (
        f"{path} has joints that would begin beyond their limits, and begin at the nearest limit ('x', 'z'); "
        "pass positions= to begin elsewhere"
    )
    robot, said = load(path, positions={"x": -1.0, "z": 1.0})
    assert said == []
    assert robot.positions["follower"] == pytest.approx(-1.0)


def test_each_cause_is_a_short_line_that_counts_and_names_the_first_links(write):
    path = write(
        *(f'<link name="arm{n}"><inertial><mass value="1"/></inertial>{BALL}</link>' for n in range(12)),
        *(joint(f"j{n}", f"arm{n}", f"arm{n + 1}") for n in range(11)),
    )  # fmt: skip
    _, [said] = load(path, fixed_base=False)
    head, *causes = said.splitlines()
    assert head == f"{path}:"
    assert causes == [
        "- 12 links without a valid inertia got that of the convex hulls of the collision geometry "
        "('arm0', 'arm1', 'arm2', 'arm3', 'arm4', and 7 more); complete the file to avoid this warning",
        "- 11 joints without <limit>, or with a lower limit above the upper one, got no limits "
        "('j0', 'j1', 'j2', 'j3', 'j4', and 6 more); complete the file to avoid this warning",
    ]


def test_a_single_cause_is_one_line(write):
    path = write(link("a", BALL), link("b", BALL), joint("x", "a", "b"))
    _, [said] = load(path)
    assert said == (
        f"{path}: 1 joint without <limit>, or with a lower limit above the upper one, got no limits "
        "('x'); complete the file to avoid this warning"
    )


def test_the_worst_of_many_doubtful_inertias_are_named():
    times = {f"link{n}": float(10 + n) for n in range(33)}
    with pytest.warns(vx.RobotWarning) as caught:
        warn_of_robot(RobotDescription("f", "r", {}, {}), Matter(with_large_inertia=times))
    said = str(caught[0].message)
    assert "can have ('link32': 42 times, 'link31': 41 times, " in said
    assert "'link3': 13 times, and 3 more); " in said
