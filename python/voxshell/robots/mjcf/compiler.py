"""Settings in a model's ``<compiler>``, and the poses that depend on them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, cast

import numpy as np

from voxshell.base.poses import pose as make_pose

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from voxshell.robots.xml_elements import Element

_SWITCH = ("false", "true")
ROTATIONS = ("quat", "axisangle", "euler", "xyaxes", "zaxis")
"""Attributes that define a rotation; an element has at most one of them."""

_LEAST_LENGTH = 1e-10
"""Length below which a vector has no direction, as in MuJoCo."""


@dataclass(frozen=True)
class Compiler:
    """Settings of all ``<compiler>`` elements of a model; later ones replace earlier ones.

    Attributes:
        unit: The unit of angles in radians.
        euler_sequence: Axes of Euler angles; lower-case axes turn with the frame, upper-case ones
            do not.
        limits_by_range: True if a joint with a range is limited by default.
        inertia_from_geoms: Source of the mass properties; "auto": geoms, if there is no inertial.
        balances_inertia: True if an impossible inertia is replaced by a ball's.
        least_mass: Smallest mass of moving bodies, kilograms.
        least_inertia: Smallest principal moment of moving bodies, kg m2.
        total_mass: Sum to which all masses are scaled, kilograms; None for no scaling.
        groups: First and last group of the geoms that have a mass.
        mesh_folder: Folder of meshes, relative to the model's.
        strips_paths: True if folders in file names are ignored.
        fits_boxes: True if shapes are fitted to the bounds of a mesh, not to its inertia.
        fits_boxes: Whether shapes are fitted to the bounds of a mesh, instead of to its inertia.
        aligns_free: Whether free bodies that do not say so have the frames of their inertias.
    """

    unit: float = math.radians(1.0)
    euler_sequence: str = "xyz"
    limits_by_range: bool = True
    inertia_from_geoms: Literal["false", "true", "auto"] = "auto"
    balances_inertia: bool = False
    least_mass: float = 0.0
    least_inertia: float = 0.0
    total_mass: float | None = None
    groups: tuple[float, float] = (0.0, 5.0)
    mesh_folder: str = ""
    strips_paths: bool = False
    fits_boxes: bool = False
    aligns_free: bool = False

    def read_pose(self, element: Element) -> NDArray[np.float64]:
        """Return the pose of an element, from ``pos`` and any kind of rotation, (4, 4) float64.

        Raises:
            RobotError: A number is invalid, or a direction is zero.
        """
        position = element.numbers("pos", (3,)) or (0.0, 0.0, 0.0)
        made = make_pose(position)
        given = next((it for it in ROTATIONS if it in element.attributes), None)
        if given is not None:
            made[:3, :3] = self._read_rotation(element, given)
        return made

    def _read_rotation(self, element: Element, kind: str) -> NDArray[np.float64]:
        counts = {"quat": 4, "axisangle": 4, "euler": 3, "xyaxes": 6, "zaxis": 3}
        numbers = element.numbers(kind, (counts[kind],)) or []
        match kind:
            case "quat":
                if not any(numbers):  # accepted as in MuJoCo; some models contain it
                    return np.eye(3)
                wxyz = normalize(element, kind, numbers)
                return make_pose(wxyz=wxyz)[:3, :3]
            case "axisangle":
                axis = normalize(element, kind, numbers[:3])
                return make_pose(axis_angle=(axis, numbers[3] * self.unit))[:3, :3]
            case "euler":
                return self._turn_by_euler(numbers)
            case "xyaxes":
                x = normalize(element, kind, numbers[:3])
                y = normalize(element, kind, np.array(numbers[3:]) - x @ numbers[3:] * x)
                return np.column_stack([x, y, np.cross(x, y)])
            case _:
                return turn_z_to(normalize(element, kind, numbers))

    def _turn_by_euler(self, angles: list[float]) -> NDArray[np.float64]:
        turn = np.eye(3)
        for letter, angle in zip(self.euler_sequence, angles, strict=True):
            axis = np.eye(3)["xyz".index(letter.lower())]
            step = make_pose(axis_angle=(axis, angle * self.unit))[:3, :3]
            turn = turn @ step if letter.islower() else step @ turn
        return turn


def normalize(
    element: Element, attribute: str, vector: Sequence[float] | NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return a vector scaled to length 1.

    Raises:
        RobotError: Its length is zero.
    """
    largest = float(np.max(np.abs(vector)))
    if largest < _LEAST_LENGTH:
        element.refuse(
            f'has <{element.tag} {attribute}="{element.attributes.get(attribute, "")[:60]}">, which has no '
            "direction; correct it"
        )
    scaled = np.asarray(vector) / largest
    return scaled / np.linalg.norm(scaled)


def turn_z_to(direction: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the smallest rotation that turns z into a unit vector, (3, 3)."""
    axis = np.cross((0.0, 0.0, 1.0), direction)
    sine = float(np.linalg.norm(axis))
    if sine < _LEAST_LENGTH:
        return np.diag([1.0, 1.0, 1.0]) if direction[2] > 0.0 else np.diag([1.0, -1.0, -1.0])
    return make_pose(axis_angle=(axis, math.atan2(sine, direction[2])))[:3, :3]


def read_compiler(elements: list[Element]) -> Compiler:
    """Return the settings of all elements together.

    Raises:
        RobotError: A setting is invalid, or coordinates are global.
    """
    settings = Compiler()
    given: dict[str, object] = {}
    for it in elements:
        known = it.attributes
        if it.word("coordinate", ("local", "global"), "local") == "global":
            it.refuse(
                'has <compiler coordinate="global">, which MuJoCo no longer supports, either; save the model '
                "with an older MuJoCo, which writes local coordinates"
            )
        if "angle" in known:
            is_degree = it.word("angle", ("degree", "radian"), "degree") == "degree"
            given["unit"] = math.radians(1.0) if is_degree else 1.0
        if "eulerseq" in known:
            given["euler_sequence"] = _read_sequence(it)
        for attribute, name in (
            ("autolimits", "limits_by_range"),
            ("balanceinertia", "balances_inertia"),
            ("strippath", "strips_paths"),
            ("fitaabb", "fits_boxes"),
            ("alignfree", "aligns_free"),
        ):
            if attribute in known:
                given[name] = it.word(attribute, _SWITCH, "false") == "true"
        if "inertiafromgeom" in known:
            given["inertia_from_geoms"] = it.word("inertiafromgeom", (*_SWITCH, "auto"), "auto")
        for attribute, name in (("boundmass", "least_mass"), ("boundinertia", "least_inertia")):
            if attribute in known:
                given[name] = max(it.number(attribute) or 0.0, 0.0)
        if "settotalmass" in known:
            total = it.number("settotalmass") or 0.0
            given["total_mass"] = total if total > 0.0 else None
        if "inertiagrouprange" in known:
            given["groups"] = cast(
                "tuple[float, float]", tuple(it.numbers("inertiagrouprange", (2,)) or ())
            )
        if "assetdir" in known:
            given["mesh_folder"] = known["assetdir"]
        if "meshdir" in known:
            given["mesh_folder"] = known["meshdir"]
    return Compiler(**{**settings.__dict__, **given})


def _read_sequence(element: Element) -> str:
    letters = element.text("eulerseq")
    if len(letters) != 3 or not set(letters.lower()) <= set("xyz"):
        element.refuse(f"has eulerseq={letters[:60]!r}; use three of x, y, z, X, Y, Z")
    return letters
