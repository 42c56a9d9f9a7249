from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import trimesh
from voxshell.robots.description import Primitive
from voxshell.robots.mjcf.shells import weigh_shell
from voxshell.robots.solids import weigh_primitive

SHAPES = (
    Primitive("sphere", (0.1,)),
    Primitive("box", (0.2, 0.4, 0.6)),
    Primitive("cylinder", (0.1, 0.5)),
    Primitive("capsule", (0.1, 0.5)),
    Primitive("ellipsoid", (0.1, 0.2, 0.3)),
)


def grow(shape: Primitive, step: float) -> Primitive:
    """The shape with a surface that is further out by a step."""
    by = {
        "sphere": (1,),
        "box": (2, 2, 2),
        "cylinder": (1, 2),
        "capsule": (1, 0),
        "ellipsoid": (1, 1, 1),
    }
    return replace(
        shape, sizes=tuple(np.add(shape.sizes, np.multiply(by[shape.kind], step)).tolist())
    )


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape.kind)
def test_a_shell_is_what_a_solid_gains_when_it_grows(shape):
    step = 1e-5
    outer, inner = (weigh_primitive(grow(shape, sign * step / 2), 1 / step) for sign in (1, -1))
    gained = outer.mass - inner.mass
    shell = weigh_shell(shape)
    np.testing.assert_allclose(
        shell.inertia / shell.mass, (outer.inertia - inner.inertia) / gained, rtol=1e-5, atol=1e-9
    )
    if shape.kind != "ellipsoid":  # whose skin so made is thicker at the ends
        assert shell.mass == pytest.approx(gained, rel=1e-6)


def test_an_ellipsoid_has_its_area():
    ball = trimesh.creation.icosphere(subdivisions=6)
    ball.apply_scale((0.1, 0.2, 0.3))
    assert weigh_shell(SHAPES[-1]).mass == pytest.approx(ball.area, rel=0.011)


def test_a_plane_has_no_shell():
    assert weigh_shell(Primitive("plane", ())).mass == 0.0
