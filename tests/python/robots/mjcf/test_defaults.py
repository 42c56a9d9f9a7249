from __future__ import annotations

import pytest
import voxshell as vx
from voxshell.robots.mjcf.defaults import MAIN, Defaults

CLASSES = """<default>
  <geom size="1" density="5"/><joint damping="1"/>
  <default class="small"><geom size="0.1"/>
    <default class="soft"><geom rgba="1 0 0 1"/></default>
  </default>
  <geom friction="2"/>
</default>"""


def test_classes_inherit_from_the_one_that_they_lie_in(read):
    defaults = Defaults(read(CLASSES).sections("default"))
    [geom] = read("<geom pos='1 2 3' density='7'/>").root.children
    assert defaults.complete(geom, MAIN).attributes == {
        "size": "1", "density": "7", "friction": "2", "pos": "1 2 3",
    }  # fmt: skip
    assert defaults.complete(geom, "soft").attributes["size"] == "0.1"
    assert defaults.complete(geom, "soft").attributes["friction"] == "2"


def test_the_class_of_an_element_comes_before_that_of_its_body(read):
    defaults = Defaults(read(CLASSES).sections("default"))
    [geom] = read("<geom class='main'/>").root.children
    assert defaults.complete(geom, "small").attributes["size"] == "1"


def test_an_elements_rotation_replaces_that_of_its_class(read):
    defaults = Defaults(
        read("<default><geom euler='9 0 0' size='1'/></default>").sections("default")
    )
    [turned] = read("<geom quat='1 0 0 1'/>").root.children
    assert defaults.complete(turned, MAIN).attributes == {"size": "1", "quat": "1 0 0 1"}
    [plain] = read("<geom/>").root.children
    assert defaults.complete(plain, MAIN).attributes == {"size": "1", "euler": "9 0 0"}


def test_an_unknown_class_is_refused(read):
    defaults = Defaults([])
    [geom] = read("<geom class='none'/>").root.children
    with pytest.raises(vx.RobotError, match="default class 'none', but there is no such class"):
        defaults.complete(geom, MAIN)
    with pytest.raises(vx.RobotError, match="<default> without class"):
        Defaults(read("<default><default/></default>").sections("default"))
