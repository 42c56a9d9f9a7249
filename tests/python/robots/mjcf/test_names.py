from __future__ import annotations

import re
from typing import Any

import pytest
import voxshell as vx
from voxshell.robots.mjcf.names import Names, check_names, read_names

WRONG = {
    "<worldbody><body><geomm size='1'/></body></worldbody>": "the robot has an unknown element <geomm> in <body>; did you mean <geom>?",
    "<worldbody><geom name='a' sise='1'/></worldbody>": "geom 'a' has an unknown attribute 'sise' in <geom>; did you mean 'size'?",
    "<worldbdy/>": "the robot has an unknown element <worldbdy> in <mujoco>; did you mean <worldbody>?",
    "<default><default class='a' group='1'/></default>": "the robot has an unknown attribute 'group' in <default>; correct or remove it",
    "<worldbody><body name='b'><joint name='j' Range='0 1'/></body></worldbody>": "joint 'j' has an unknown attribute 'Range' in <joint>; did you mean 'range'?",
    "<option><flag gravty='disable'/></option>": "the robot has an unknown attribute 'gravty' in <flag>; did you mean 'gravity'?",
    "<worldbody><frame><body><motor/></body></frame></worldbody>": "the robot has an unknown element <motor> in <body>; correct or remove it",
}


@pytest.mark.parametrize("text", WRONG)
def test_unknown_names_are_refused_with_the_closest_one(write, text):
    rest = "" if "world" in text else "<worldbody/>"
    path = write("\n", text, rest)
    with pytest.raises(vx.RobotError) as refusal:
        vx.load_mjcf(vx.World(), path)
    assert str(refusal.value) == f"{path}:2: {WRONG[text]}"


def test_names_of_included_and_attached_files_are_checked_too(write, tmp_path):
    (tmp_path / "part.xml").write_text("<mujoco>\n<worldbody><body nam='a'/></worldbody></mujoco>")
    included = write("<include file='part.xml'/>")
    attached = write(
        "<asset><model name='m' file='part.xml'/></asset>",
        "<worldbody><attach model='m' prefix='p'/></worldbody>",
        name="whole.xml",
    )
    for path in (included, attached):
        with pytest.raises(vx.RobotError, match=r"part\.xml:2: .*; did you mean 'name'\?"):
            vx.load_mjcf(vx.World(), path)


def test_valid_names_are_not_refused(read):
    check_names(read(
        "<compiler convexhull='true'/><option apirate='100' collision='all'><flag passive='enable'/></option>",
        "<default class='main'><default class='a'><geom shellinertia='true'/><default class='b'/></default></default>",
        "<worldbody><frame name='f' euler='1 2 3'><replicate count='2' offset='1 0 0' sep='-'><body><body/>",
        "<geom><plugin instance='i'><config key='k' value='v'/></plugin></geom></body></replicate></frame>",
        "<body><composite type='cable' count='5 1 1'><joint kind='main'/></composite></body></worldbody>",
        "<sensor><user dim='1'/></sensor><keyframe><key qpos='1'/></keyframe>",
    ).root)  # fmt: skip


def test_every_name_of_mujoco_is_known():
    """The installed MuJoCo prints its names, each element indented by three for each one that it lies in."""
    mujoco: Any = pytest.importorskip("mujoco", reason="compares with the package mujoco")
    levels: list[Names] = []
    count = 0
    for line in mujoco.mj_printSchema(False, False).splitlines():
        head = re.match(r"( *)(\S+) \(.\)(.*)", line)
        attributes = head[3] if head else line
        if head:
            tag = head[2].replace("(world)body", "worldbody")
            del levels[len(head[1]) // 3 :]
            levels.append(levels[-1].children[tag] if levels else read_names())
            count += 1
        assert set(attributes.split()) <= levels[-1].attributes, line
    assert count > 150
