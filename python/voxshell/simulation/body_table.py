"""The table of a body that notebooks show."""

from __future__ import annotations

from typing import Any

from voxshell.base.notebook import make_table


def make_body_table(body: Any) -> str:
    """Return the facts of a body as HTML; those of a removed one without its motion."""
    matter = f"{body.mass:g} kg" if body.motion == "dynamic" else f"none: {body.motion}"
    facts = {"number": f"{body.number}", "shape": repr(body.shape), "mass": matter}
    if body.removed:
        facts["world"] = "none: removed"
    else:
        for what, vector, unit in (
            ("position", body.position, "m"),
            ("linear velocity", body.linear_velocity, "m/s"),
            ("angular velocity", body.angular_velocity, "rad/s"),
        ):
            x, y, z = (vector + 0.0).tolist()
            facts[what] = f"({x:.4g}, {y:.4g}, {z:.4g}) {unit}"
    return make_table(f"Body {body.name!r}", facts)
