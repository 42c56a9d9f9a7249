from __future__ import annotations

import pytest
import voxshell as vx
from voxshell.robots.mjcf.reading import read_mjcf

DOWN = (0.0, 0.0, -9.81)
BALL = "<geom size='0.1' mass='2'/>"


def test_a_model_is_called_as_it_says_or_as_its_file(write, tmp_path):
    assert read_mjcf(write("<worldbody/>"), DOWN, 0.0025).robot.name == "tester"
    (tmp_path / "lamp.xml").write_text("<mujoco><worldbody/></mujoco>")
    assert read_mjcf(tmp_path / "lamp.xml", DOWN, 0.0025).robot.name == "lamp"


def test_the_total_mass_counts_static_bodies_and_not_the_world(write):
    path = write(
        "<compiler settotalmass='12'/>",
        f"<worldbody>{BALL}<body name='a'>{BALL}</body><body name='b'><joint/>{BALL}</body></worldbody>",
    )
    links = read_mjcf(path, DOWN, 0.0025).robot.links
    assert [links[name].inertial.mass for name in "ab"] == pytest.approx([6.0, 6.0])
    assert links["world"].inertial is None


def test_errors_of_other_files_name_the_model(write, tmp_path):
    (tmp_path / "part.xml").write_text("<robot/>")
    path = write("<include file='part.xml'/>")
    with pytest.raises(vx.RobotError) as refusal:
        read_mjcf(path, DOWN, 0.0025)
    assert "part.xml:1: it is a <robot>, not a <mujoco>" in str(refusal.value)
    assert f"(while reading {path})" in str(refusal.value)


def test_parts_of_models_are_refused(write):
    with pytest.raises(vx.RobotError, match="no <worldbody>: it is empty, or meant for"):
        read_mjcf(write("<asset/>"), DOWN, 0.0025)
