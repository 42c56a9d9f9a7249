from __future__ import annotations

import pytest
import voxshell as vx
from voxshell.robots.mjcf.model_file import read_model


def test_includes_are_replaced_by_what_the_files_hold(write, tmp_path):
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts/inner.xml").write_text("<mujocoinclude><mesh name='c'/></mujocoinclude>")
    (tmp_path / "parts/outer.xml").write_text(
        "<mujoco><mesh name='b'/><include file='parts/inner.xml'/><include file='inner.xml'/></mujoco>"
    )
    path = write(
        "<asset><mesh name='a'/><include file='parts\\outer.xml'/><mesh name='d'/></asset>"
    )
    [asset] = read_model(path).sections("asset")
    assert [mesh.attributes["name"] for mesh in asset.children] == ["a", "b", "c", "c", "d"]
    assert asset.children[1].path.endswith("outer.xml")


def test_what_lies_in_an_element_is_named_by_its_body_or_geom(read):
    [world] = read("<worldbody><body name='arm'><geom/><body><joint name='x'/></body></body></worldbody>").sections("worldbody")  # fmt: skip
    body = world.children[0]
    geom, inner = body.children
    assert body.owner == "body 'arm'"
    assert geom.owner == "a geom of body 'arm'"
    assert inner.owner == "body 'arm'"
    assert inner.children[0].owner == "joint 'x'"


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("<include file='model.xml'/>", "includes 'model.xml' in itself"),
        ("<include file='none.xml'/>", "names the file 'none.xml', which does not exist"),
        ("<a>" * 200 + "</a>" * 200, "nested more than 100 deep"),
        ("<robot/><include file='part.xml'/>" * 101, "limit of 100 files"),
    ],
)
def test_what_is_wrong_with_files_is_said_with_file_and_line(write, tmp_path, content, message):
    (tmp_path / "part.xml").write_text("<mujocoinclude/>")
    path = write(content)
    with pytest.raises(vx.RobotError) as refusal:
        read_model(path)
    assert message in str(refusal.value)
    assert f"{path}:1" in str(refusal.value)


def test_deep_elements_of_included_files_count_together(write, tmp_path):
    deep = "<a>" * 60 + "<include file='{}'/>" + "</a>" * 60
    (tmp_path / "part.xml").write_text(f"<mujoco>{deep.format('empty.xml')}</mujoco>")
    (tmp_path / "empty.xml").write_text("<mujoco/>")
    with pytest.raises(vx.RobotError, match="is nested in more than 100 elements"):
        read_model(write(deep.format("part.xml")))


def test_a_missing_file_is_no_robots_fault(tmp_path):
    with pytest.raises(vx.MissingFileError, match=r"cannot read .*none\.xml: it does not exist"):
        read_model(tmp_path / "none.xml")
