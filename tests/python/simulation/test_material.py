from __future__ import annotations

import dataclasses

import pytest
import voxshell as vx

RUBBER = vx.Material(friction=1.0, restitution=0.6, rolling_friction=0.002, spinning_friction=0.001)
NAMES = [field.name for field in dataclasses.fields(vx.Material)]


def test_a_body_without_a_material_has_the_usual_one():
    assert vx.World().add(vx.Sphere(0.1)).material == vx.Material()


def test_a_material_says_the_same_as_its_properties_one_by_one():
    world = vx.World()
    whole = world.add(vx.Sphere(0.1), material=RUBBER)
    single = world.add(vx.Sphere(0.1), **dataclasses.asdict(RUBBER))
    assert whole.material == single.material == RUBBER
    for name in NAMES:
        assert getattr(whole, name) == getattr(single, name) == getattr(RUBBER, name)


@pytest.mark.parametrize("name", NAMES)
def test_a_property_replaces_that_of_the_material(name: str):
    body = vx.World().add(vx.Sphere(0.1), material=RUBBER, **{name: 0.0})
    assert body.material == dataclasses.replace(RUBBER, **{name: 0.0}) != RUBBER


def test_a_material_given_later_counts_from_then_on():
    world = vx.World()
    world.add(vx.Plane(), mass=0, friction=1.0)
    slope = world.add(vx.Box((0.1, 0.1, 0.1)), pose=(0, 0, 0.1), material=vx.Material(0.0))
    slope.linear_velocity = (1.0, 0.0, 0.0)
    world.step(100)
    assert slope.linear_velocity[0] == pytest.approx(1.0, abs=1e-6)
    slope.material = RUBBER
    world.step(100)
    assert slope.linear_velocity[0] == pytest.approx(0.0, abs=1e-3)
    assert slope.material == RUBBER


@pytest.mark.parametrize("name", NAMES)
def test_a_property_out_of_range_is_named(name: str):
    with pytest.raises(vx.SettingsError, match=f"^{name} must be "):
        vx.Material(**{name: -0.1})
    with pytest.raises(vx.SettingsError, match=f"^{name} must be "):
        vx.World().add(vx.Sphere(0.1), material=RUBBER, **{name: -0.1})


@pytest.mark.parametrize("material", ["rubber", 0.5, {"friction": 1.0}])
def test_what_is_no_material_is_refused(material: object):
    body = vx.World().add(vx.Sphere(0.1))
    with pytest.raises(vx.InputTypeError, match="material must be a Material, not "):
        vx.World().add(vx.Sphere(0.1), material=material)  # type: ignore[arg-type]
    with pytest.raises(vx.InputTypeError, match="material must be a Material, not "):
        body.material = material  # type: ignore[assignment]


def test_numbers_of_other_types_are_taken_as_floats():
    assert vx.Material(1, 0) == vx.Material(1.0, 0.0)
    assert repr(vx.Material(1, 0).friction) == "1.0"
