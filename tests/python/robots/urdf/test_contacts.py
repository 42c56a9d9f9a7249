"""Materials of links from pybullet's element <contact>."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from pathlib import Path

import pytest
import voxshell as vx

BALL = '<collision><geometry><sphere radius="0.1"/></geometry></collision>'
INERTIAL = (
    '<inertial><mass value="1"/><inertia ixx="0.004" iyy="0.004" izz="0.004" ixy="0" ixz="0" iyz="0"/>'
    "</inertial>"
)
FIXED = '<joint name="j" type="fixed"><parent link="a"/><child link="b"/></joint>'


@pytest.fixture
def load(tmp_path: Path) -> Callable[..., tuple[vx.Body, list[str]]]:
    def load(a: str, b: str | None = None, **options: object) -> tuple[vx.Body, list[str]]:
        """The body of one link, or of two that are fixed to each other, and all warnings."""
        links = {"a": a} if b is None else {"a": a, "b": b}
        text = "".join(
            f'<link name="{name}">{it}{INERTIAL}{BALL}</link>' for name, it in links.items()
        )
        path = tmp_path / "robot.urdf"
        path.write_text(f'<robot name="tester">{text}{"" if b is None else FIXED}</robot>')
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            robot = vx.load_urdf(vx.World(), path, fixed_base=False, **options)  # pyright: ignore[reportArgumentType]
        return robot.bodies[0], [str(it.message) for it in caught]

    return load


def contact(**values: float) -> str:
    inside = "".join(f'<{name} value="{it}"/>' for name, it in values.items())
    return f"<contact>{inside}</contact>"


def test_a_contact_is_the_material_of_its_link(load):
    stated = contact(
        lateral_friction=1.5, restitution=0.25, rolling_friction=0.001, spinning_friction=0.002
    )
    body, said = load(stated)
    assert body.material == vx.Material(1.5, 0.25, 0.001, 0.002)
    assert said == []
    assert load(contact(lateral_friction=0))[0].material == vx.Material(0.0)
    assert load(contact(restitution=0.25))[0].material == vx.Material(restitution=0.25)
    assert load("")[0].material == vx.Material(0.5)


def test_a_friction_that_is_passed_wins(load):
    stated = contact(lateral_friction=1.5, restitution=0.25)
    assert load(stated, friction=0.3)[0].material == vx.Material(0.3, 0.25)


def test_a_body_of_several_links_has_the_largest_of_each_property(load):
    a = contact(lateral_friction=0.2, restitution=0.5)
    b = contact(lateral_friction=0.4, restitution=0.1, rolling_friction=0.01)
    assert load(a, b)[0].material == vx.Material(0.4, 0.5, 0.01)
    assert load(a, "")[0].material == vx.Material(0.2, 0.5)


def test_what_is_not_read_of_a_contact_is_named(load):
    stated = contact(lateral_friction=1, stiffness=30000, damping=1000, contact_cfm=0)
    _, [said] = load(stated, contact(stiffness=1))
    assert said.endswith(
        "contains what is not simulated: <stiffness> of <contact> ('a', 'b'); "
        "<damping>, <contact_cfm> of <contact> ('a')"
    )


@pytest.mark.parametrize(
    ("stated", "message"),
    [
        (contact(lateral_friction=-1), "link 'a' has a <lateral_friction> out of range: friction"),
        (contact(restitution=2), "link 'a' has a <restitution> out of range: restitution"),
        ("<contact><restitution/></contact>", "link 'a' has a <restitution> without value"),
        ('<contact><restitution value="x"/></contact>', r'link \'a\' has <restitution value="x">'),
    ],
)
def test_values_out_of_range_are_refused(load, stated, message):
    with pytest.raises(vx.RobotError, match=message):
        load(stated)
