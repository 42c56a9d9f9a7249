"""Everyday scenes in a :class:`voxshell.World` at its defaults: models, or Bullet's own shapes."""

from __future__ import annotations

import math
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from voxshell.errors import SettingsError
from voxshell.model.model import Model
from voxshell.model.shapes import Box, Capsule, Cylinder, Plane, Sphere
from voxshell.simulation.comparison_shapes import ConvexDecomposition, ConvexHull
from voxshell.simulation.compound import Compound
from voxshell.simulation.joint_kinds import HingeJoint, PointJoint, SliderJoint
from voxshell.simulation.world import World

from voxshell_studies.scenes.everyday.forms import matter, spheroid_points
from voxshell_studies.scenes.everyday.scene import shift

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from voxshell.simulation.body import Body
    from voxshell.simulation.body_shapes import Shape
    from voxshell.simulation.compound import Part
    from voxshell.simulation.joint_kinds import JointKind

    from voxshell_studies.scenes.everyday.scene import Engine, Form, Item, Piece, Stage


class WorldStage:
    """A stage in a world.

    Args:
        stage: The bodies and their places.
        engine: "voxshell": bodies are models at default settings; "bullet": Bullet's own shapes.
        time_step: Seconds.
    """

    def __init__(self, stage: Stage, engine: Engine, time_step: float) -> None:
        self.world = World(gravity=stage.gravity, time_step=time_step)
        self._bodies: dict[str, Body] = {}
        self._driven: list[tuple[Item, Body]] = []
        self._steps = 0
        for item in stage.items:
            body = self._add(item, engine)
            # Bullet multiplies the coefficients of two bodies.
            body.friction = math.sqrt(stage.friction)
            body.restitution = math.sqrt(stage.restitution)
            self._bodies[item.name] = body
            if item.path is not None or item.force != (0.0, 0.0, 0.0):
                self._driven.append((item, body))

    def _add(self, item: Item, engine: Engine) -> Body:
        if item.form.is_plane:
            normal = item.pose[:3, 2]
            plane = Plane(normal, float(normal @ item.pose[:3, 3]))
            return self.world.add(plane, mass=0.0, name=item.name)
        own = engine == "bullet" or item.plain
        shape = make_shape(item.form) if own else build_model(item.form)
        if not item.moves:
            return self.world.add(
                shape,
                pose=item.pose,
                name=item.name,
                motion="static" if item.path is None else "kinematic",
            )
        body = self.world.add(
            shape,
            mass=item.mass,
            pose=item.pose,
            name=item.name,
            inertia=matter(item.form, item.mass),
        )
        body.linear_velocity = item.velocity
        body.angular_velocity = item.spin
        if item.joint is not None:
            joint = item.joint
            kinds: dict[str, JointKind] = {
                "hinge": HingeJoint(axis=joint.axis),
                "slider": SliderJoint(axis=joint.axis),
                "point": PointJoint(),
            }
            self.world.add_joint(kinds[joint.kind], None, body, world_from_joint=shift(*joint.at))
        return body

    def step(self) -> bool:
        """Make a step; return False if a body's pose is not finite."""
        self._steps += 1
        time = self._steps * self.world.time_step
        for item, body in self._driven:
            if item.path is not None:
                body.pose = item.path(time)
            else:
                body.apply_force(item.force)
        self.world.step()
        return True

    def state(
        self, name: str
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Return a body's ``world_from_body``, (4, 4), velocity of its center, and spin, (3,)."""
        body = self._bodies[name]
        return body.pose, body.linear_velocity, body.angular_velocity


_MODELS: dict[str, Model] = {}


def build_model(form: Form) -> Model:
    """Build a model at default settings, once per process."""
    if form.name not in _MODELS:
        assert form.mesh is not None
        _MODELS[form.name] = Model.from_mesh(form.mesh)
    return _MODELS[form.name]


@cache
def make_shape(form: Form) -> Shape:
    """Return Bullet's own shape or compound, with this package's margins.

    Raises:
        SettingsError: No convex parts represent the form.
    """
    if not form.pieces:
        raise SettingsError(f"no convex parts represent {form.name!r}")
    parts = [(_make_part(piece), piece.pose) for piece in form.pieces]
    if len(parts) == 1 and np.array_equal(parts[0][1], np.eye(4)):
        return parts[0][0]
    if all(piece.kind == "hull" and np.array_equal(piece.pose, np.eye(4)) for piece in form.pieces):
        return ConvexDecomposition(
            [piece.points for piece in form.pieces if piece.points is not None]
        )
    return Compound(parts)


def _make_part(piece: Piece) -> Part:
    match piece.kind:
        case "box":
            return Box(piece.size)
        case "sphere":
            return Sphere(piece.size[0])
        case "capsule":
            return Capsule(*piece.size)
        case "cylinder":
            return Cylinder(*piece.size)
        case "ellipsoid":
            return ConvexHull(spheroid_points(piece.size))
        case "hull":
            assert piece.points is not None
            return ConvexHull(piece.points)
