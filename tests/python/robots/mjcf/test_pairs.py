from __future__ import annotations

import pytest
import voxshell as vx
from voxshell.robots.mjcf.pairs import read_pairs
from voxshell.robots.mjcf.parts import open_part


@pytest.fixture
def pair(read):
    def pair(attributes: str, default: str = ""):
        file = read(f"<default>{default}</default><contact><pair {attributes}/></contact>")
        [one] = read_pairs(open_part(file, "p_"))
        return one

    return pair


def test_a_pair_names_geoms_and_perhaps_a_friction(pair):
    plain = pair("geom1='a' geom2='b'")
    assert plain.geoms == ("p_a", "p_b")
    assert plain.friction is None
    assert pair("geom1='a' geom2='b' friction='0.3 0.4 0.1'").friction == (0.3, 0.4)
    assert pair("geom1='a' geom2='b' friction='0.3'").friction == (0.3, 1.0)
    assert pair("geom1='a' geom2='b'", "<pair friction='2 2'/>").friction == (2, 2)


def test_a_pair_slips_without_friction_or_by_its_dimensions(pair):
    assert not pair("geom1='a' geom2='b'").slips
    assert pair("geom1='a' geom2='b' friction='0 0 0 0 0'").slips
    assert pair("geom1='a' geom2='b' condim='1'").slips
    assert pair("geom1='a' geom2='b'", "<pair condim='1'/>").slips
    assert not pair("geom1='a' geom2='b' condim='3'", "<pair condim='1'/>").slips


@pytest.mark.parametrize("attributes", ["geom1='a'", "geom1='a' geom2='b' friction='x'"])
def test_wrong_pairs_are_refused(pair, attributes):
    with pytest.raises(vx.RobotError, match=r"model\.xml:1"):
        pair(attributes)
