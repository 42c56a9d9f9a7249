"""What a state needs of a world that it is restored in: the same settings, bodies and joints, as plain data."""

from __future__ import annotations

import hashlib
import math
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell.model.model import Model
from voxshell.model.shapes import Box, Capsule, Cone, Cylinder, Plane, Sphere
from voxshell.simulation.comparison_shapes import ConvexDecomposition, GImpact
from voxshell.simulation.compound import Compound
from voxshell.simulation.joint_kinds import HingeJoint, SliderJoint

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from numpy.typing import NDArray

    from voxshell.simulation.body import Body
    from voxshell.simulation.body_shapes import Shape
    from voxshell.simulation.joints import Joint

_RELATIVE, _ABSOLUTE = 1e-9, 1e-12
"""Largest difference of equal numbers: other processors may round masses and frames otherwise."""


def describe_scene(
    settings: Mapping[str, Any], bodies: Sequence[Body], joints: Sequence[Joint]
) -> dict[str, Any]:
    """Return a scene as data that JSON can hold, without what a state contains.

    Meshes appear as digests, so that the description is small.

    Args:
        settings: Of the world, by the names of its arguments.
        bodies: All bodies, in order.
        joints: All joints between them, in order.
    """
    places = {body.number: place for place, body in enumerate(bodies)}
    digests: dict[int, list[Any]] = {}  # bodies may share large models

    def describe_once(shape: Shape) -> list[Any]:
        if id(shape) not in digests:
            digests[id(shape)] = _describe_shape(shape)
        return digests[id(shape)]

    return {
        "settings": dict(settings),
        "bodies": [
            {
                "name": body.name,
                "motion": body.motion,
                "mass": body.mass,
                "center of mass": body._center.tolist(),
                "inertia": body._inertia.tolist(),
                "shape": describe_once(body.shape),
            }
            for body in bodies
        ],
        "joints": [_describe_joint(joint, places) for joint in joints],
    }


def find_difference(then: Mapping[str, Any], now: Mapping[str, Any]) -> str:
    """Return how a scene differs from another one, for an error message; "" if they are equal.

    Args:
        then: A description by :func:`describe_scene`, which may come from a file.
        now: That of the world.
    """
    settings = then["settings"]
    others = [
        name for name, value in now["settings"].items() if not _same(settings.get(name), value)
    ]
    if others:
        return f"the world was made with another {' and another '.join(others)}"
    for what in ("bodies", "joints"):
        if len(then[what]) != len(now[what]):
            return f"it has {len(then[what])} {what}, and the world has {len(now[what])}"
        one = "body" if what == "bodies" else "joint"
        for place, (saved, own) in enumerate(zip(then[what], now[what], strict=True)):
            for name, value in own.items():
                if not _same(saved.get(name), value):
                    return f"{one} {place} of the world, {own['name']!r}, has another {name}"
    return ""


def _describe_joint(joint: Joint, places: Mapping[int, int]) -> dict[str, Any]:
    kind = joint.kind
    described: dict[str, Any] = {
        "name": joint.name,
        "kind": type(kind).__name__,
        "parent": -1 if joint.parent is None else places[joint.parent.number],
        "child": places[joint.child.number],
        "frame in its parent": joint._frames[0].tolist(),
        "frame in its child": joint._frames[1].tolist(),
        "collide": joint._collides,
    }
    if isinstance(kind, (HingeJoint, SliderJoint)):
        described["limits"] = None if kind.limits is None else [float(it) for it in kind.limits]
        for name in ("friction", "damping", "stiffness", "spring_position", "armature"):
            described[name] = float(getattr(kind, name))
    return described


def _describe_shape(shape: Shape) -> list[Any]:
    """Return the kind of a shape, and what tells it from others of this kind."""
    kind = type(shape).__name__
    match shape:
        case Model():
            return [kind, hashlib.sha256(shape._core.to_bytes()).hexdigest()]
        case Plane():
            return [kind, shape.normal.tolist(), shape.offset]
        case Box():
            return [kind, shape.half_extents.tolist()]
        case Sphere():
            return [kind, shape.radius]
        case Capsule() | Cylinder():
            return [kind, shape.radius, shape.length]
        case Cone():
            return [kind, shape.radius, shape.height]
        case GImpact():
            return [kind, shape.margin, _digest(*shape.mesh)]
        case ConvexDecomposition():
            return [kind, shape.margin, _digest(*shape.hulls)]
        case Compound():
            parts = [[_describe_shape(part), pose.tolist()] for part, pose in shape.parts]
            return [kind, parts]


def _digest(*arrays: NDArray[Any]) -> str:
    """Return a digest of arrays and their shapes."""
    digest = hashlib.sha256()
    for array in arrays:
        digest.update(f"{array.dtype.str} {array.shape};".encode())
        digest.update(np.ascontiguousarray(array).tobytes())
    return digest.hexdigest()


def _same(a: object, b: object) -> bool:
    """Return whether two values of descriptions are equal, up to rounding of numbers."""
    if isinstance(a, (list, tuple)) and isinstance(b, (list, tuple)):
        return len(a) == len(b) and all(map(_same, a, b))
    if isinstance(a, (int, float)) and isinstance(b, (int, float)):
        return math.isclose(a, b, rel_tol=_RELATIVE, abs_tol=_ABSOLUTE)
    return a == b
