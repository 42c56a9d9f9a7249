"""Names that a robot does not have."""

from __future__ import annotations

import copy

import pytest
from voxshell.robots.named_parts import NamedParts


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("zz", "robot 'r' has no link 'zz'; it has 'arm', 'hand'"),
        ("hnad", "robot 'r' has no link 'hnad': did you mean 'hand'? It has 'arm', 'hand'"),
        (3, "robot 'r' has no link 3; it has 'arm', 'hand'"),
    ],
)
def test_a_name_that_a_robot_does_not_have_is_answered_with_those_that_it_has(name, message):
    links = NamedParts({"arm": 1, "hand": 2}, "robot 'r'", "link")
    for parts in (links, copy.deepcopy(links)):
        with pytest.raises(KeyError) as refusal:
            parts[name]
        assert refusal.value.args == (message,)
        assert name not in parts
        assert parts.get(name) is None


def test_a_robot_without_such_parts_has_none():
    with pytest.raises(KeyError, match="has no joint 'x'; it has none"):
        NamedParts({}, "robot 'r'", "joint")["x"]


def test_parts_are_a_dict():
    assert NamedParts({"arm": 1}, "robot 'r'", "link") == {"arm": 1}
