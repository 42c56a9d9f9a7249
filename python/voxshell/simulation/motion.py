"""Motion of a body (by forces, none, or by the user), with the mass and surface it permits."""

from __future__ import annotations

from typing import Literal, TypeAlias

from voxshell import _bullet
from voxshell.base.arguments import as_choice, as_not_negative, as_positive
from voxshell.errors import SettingsError
from voxshell.model.mass_properties import MassProperties
from voxshell.model.shapes import Plane

Motion: TypeAlias = Literal["dynamic", "static", "kinematic"]
"""What moves a body: forces, nothing, or the user, who sets its poses."""

MOTIONS: dict[Motion, _bullet.Motion] = {
    "dynamic": _bullet.Motion.DYNAMIC,
    "static": _bullet.Motion.STATIC,
    "kinematic": _bullet.Motion.KINEMATIC,
}


def as_mass_and_motion(mass: float, motion: Motion | None) -> tuple[float, Motion]:
    """Return mass, kilograms, 0 unless dynamic, and motion; the mass decides it by default."""
    kilograms = as_not_negative(mass, "mass")
    if motion is None:
        motion = "dynamic" if kilograms > 0.0 else "static"
    elif as_choice(motion, "motion", MOTIONS) == "dynamic" and kilograms == 0.0:
        raise SettingsError("a dynamic body needs a mass above 0")
    return (kilograms if motion == "dynamic" else 0.0), motion


def decide_mass_and_motion(
    shape: object, mass: float | None, inertia: object, motion: Motion | None
) -> tuple[float, Motion]:
    """Return kilograms and the motion, with the defaults of the shape.

    Raises:
        SettingsError: They do not fit each other, or a plane is not static.
    """
    if mass is not None:
        kilograms, motion = as_mass_and_motion(mass, motion)
    elif isinstance(shape, Plane) and motion is None:
        return 0.0, "static"
    else:
        is_known = isinstance(inertia, MassProperties)
        default = as_positive(inertia.mass, "inertia.mass") if is_known else 1.0
        kilograms, motion = as_mass_and_motion(default, motion)
    if isinstance(shape, Plane) and motion != "static":
        raise SettingsError("a plane is unbounded and cannot move: leave out mass and motion")
    return kilograms, motion


def check_surface(motion: Motion, name: str, moves_surfaces: bool) -> None:
    """Check that a body's surface can move while the body stays.

    Raises:
        SettingsError: It cannot.
    """
    if motion != "kinematic":
        raise SettingsError(
            f"surface_velocity needs a kinematic body, but {name} is {motion}: pass motion='kinematic'"
        )
    if not moves_surfaces:
        raise SettingsError(
            "surface_velocity needs a world with solver='coulomb' and friction_directions=2"
        )
