"""Geoms: their shapes and places."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from voxshell.base.arguments import FARTHEST, join_choices
from voxshell.model.mass_properties import MassProperties
from voxshell.robots.description import Collision, Primitive
from voxshell.robots.mjcf.compiler import turn_z_to
from voxshell.robots.mjcf.principal_axes import find_principal_axes
from voxshell.robots.mjcf.shells import weigh_shell
from voxshell.robots.solids import weigh_primitive

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell.robots.description import Color, Geometry
    from voxshell.robots.mjcf.parts import Part
    from voxshell.robots.xml_elements import Element

_DENSITY = 1000.0
_FRICTION = 1.0
_TYPES = ("plane", "hfield", "sphere", "capsule", "ellipsoid", "cylinder", "box", "mesh", "sdf")
_NOT_READ = ("hfield", "sdf")
_CONDIMS = (1, 3, 4, 6)
_WITH_FROMTO = ("capsule", "cylinder", "ellipsoid", "box")


@dataclass(frozen=True, eq=False)
class Geom:
    """A geom of a body.

    Attributes:
        element: As in the file, with the attributes of its class.
        part: The model that it belongs to.
        type: One of MuJoCo's types.
        surface: Shape in the body's frame; None for unsupported types.
        bits: Its contype and conaffinity.
        condim: Dimensions of its contacts; 1 is without friction.
        priority: The geom with the higher one decides about a contact.
        collides: Whether it meets anything; others are only seen, and may have a mass.
        friction: Coulomb coefficient.
        color: None where the file gives none.
        weighs: Whether it counts where a body's mass is computed.
    """

    element: Element
    part: Part
    type: str
    surface: Collision | None
    bits: tuple[int, int]
    condim: int
    priority: float
    collides: bool
    friction: float
    color: Color | None
    weighs: bool

    @property
    def name(self) -> str:
        """Name with the prefix of its model; empty if the geom has none."""
        name = self.element.attributes.get("name")
        return self.part.prefix + name if name else ""

    def move(self, new_from_old: NDArray[np.float64]) -> Geom:
        """Return the geom in another frame of its body."""
        surface = self.surface
        if surface is None:
            return self
        place = new_from_old @ surface.link_from_geometry
        return replace(self, surface=Collision(surface.geometry, place))

    def weigh(self) -> MassProperties | None:
        """Return its mass properties in its own frame; None if it has no mass.

        Raises:
            RobotError: A mesh cannot be read, or is to be a shell, or the mass is below 0.
        """
        if self.surface is None or not self.weighs:
            return None
        mass, density = self.element.number("mass"), self.element.number("density")
        if min(mass or 0.0, density or 0.0) < 0.0:
            self.element.refuse("has a mass or density below 0")
        if mass == 0.0:
            return None
        geometry = self.surface.geometry
        is_shell = self.element.word("shellinertia", ("false", "true"), "false") == "true"
        if isinstance(geometry, Primitive):
            solid = weigh_shell(geometry) if is_shell else weigh_primitive(geometry, 1.0)
        elif is_shell:
            self.element.refuse(
                'is a mesh with shellinertia="true"; give its <mesh> inertia="shell" instead'
            )
        else:
            solid = self.part.meshes.weigh(self.element)
        if mass is None:
            mass = solid.mass * (_DENSITY if density is None else density)
        if not (mass > 0.0 and solid.mass > 0.0):
            return None
        return MassProperties(mass, solid.center_of_mass, solid.inertia * (mass / solid.mass))


def read_geom(
    element: Element,
    frame: NDArray[np.float64],
    part: Part,
    is_paired: bool,
) -> Geom:
    """Read a geom.

    Args:
        element: The element with the attributes of its class.
        frame: ``body_from_frame`` of the frame that contains it.
        part: The model that it belongs to.
        is_paired: True if a ``<pair>`` makes it collide, whatever its bits.

    Raises:
        RobotError: A number is invalid, or there is no such mesh.
    """
    kind = element.word("type", _TYPES, "sphere")
    bits = _read_bits(element, "contype"), _read_bits(element, "conaffinity")
    condim = element.number("condim")
    if condim is not None and condim not in _CONDIMS:
        element.refuse(f"has a condim of {condim:g}; it must be {join_choices(map(str, _CONDIMS))}")
    group = element.number("group") or 0.0
    first, last = part.compiler.groups
    weighs = first <= group <= last and kind != "plane"
    friction = (element.numbers("friction", (1, 2, 3)) or [_FRICTION])[0]
    if friction < 0.0:
        element.refuse("has a friction below 0")
    surface = None
    if kind not in _NOT_READ:
        geometry, place = _read_surface(element, kind, part)
        surface = Collision(geometry, frame @ place)
    return Geom(
        element,
        part,
        kind,
        surface,
        bits,
        3 if condim is None else int(condim),
        element.number("priority") or 0.0,
        any(bits) or is_paired,
        friction,
        _read_color(element, part.materials),
        weighs,
    )


def _read_bits(element: Element, attribute: str) -> int:
    value = element.number(attribute)
    if value is None:
        return 1
    if value != math.floor(value) or not 0 <= value < 2**32:
        element.refuse(f"has a {attribute} of {value:g}; give a whole number from 0 to 4294967295")
    return int(value)


def _read_color(element: Element, materials: dict[str, Element]) -> Color | None:
    """Return the color of the geom or of its material; ignore invalid colors."""
    material = materials.get(element.attributes.get("material", ""))
    for it in (element, material):
        if it is not None and "rgba" in it.attributes:
            try:
                numbers = [float(word) for word in it.attributes["rgba"].split()[:3]]
                red, green, blue = (round(255.0 * min(max(it, 0.0), 1.0)) for it in numbers)
            except ValueError:
                return None
            return red, green, blue
    return None


def _read_surface(element: Element, kind: str, part: Part) -> tuple[Geometry, NDArray[np.float64]]:
    place = part.compiler.read_pose(element)
    if kind == "mesh":
        return part.meshes.find(element), place
    if kind == "plane":
        return Primitive("plane", ()), place
    if "mesh" in element.attributes:
        return _fit(element, kind, place, part)
    sizes = element.numbers("size", (1, 2, 3)) or []
    ends = element.numbers("fromto", (6,)) if kind in _WITH_FROMTO else None
    if ends is not None:
        sizes, place = _read_ends(element, kind, ends, sizes)
    return _make(element, kind, sizes), place


def _read_ends(
    element: Element, kind: str, ends: list[float], sizes: list[float]
) -> tuple[list[float], NDArray[np.float64]]:
    """Return half sizes, and the pose between two ends with z along the line."""
    start, end = np.array(ends[:3]), np.array(ends[3:])
    length = float(np.linalg.norm(start - end))
    if length < 1e-9 or not math.isfinite(length):
        element.refuse(f"has a fromto of length {length:g}; its ends must be apart")
    place = np.eye(4)
    place[:3, :3] = turn_z_to((start - end) / length)
    place[:3, 3] = (start + end) / 2.0
    radius = sizes[:1]
    across = radius * 2 if kind in ("box", "ellipsoid") else radius
    return [*across, length / 2.0], place


def _make(element: Element, kind: str, sizes: list[float]) -> Primitive:
    needed = {"sphere": 1, "capsule": 2, "cylinder": 2, "ellipsoid": 3, "box": 3}[kind]
    sizes = sizes[:needed]
    if len(sizes) < needed or not 0.0 < min(sizes) <= max(sizes) <= FARTHEST:
        element.refuse(
            f"has a {kind} of size {sizes}; use {needed} numbers above 0, and at most {FARTHEST:g}"
        )
    match kind:
        case "box":
            return Primitive("box", tuple(2.0 * it for it in sizes))
        case "sphere":
            return Primitive("sphere", tuple(sizes))
        case "ellipsoid":
            return Primitive("ellipsoid", tuple(sizes))
        case "capsule":
            return Primitive("capsule", (sizes[0], 2.0 * sizes[1]))
        case _:
            return Primitive("cylinder", (sizes[0], 2.0 * sizes[1]))


def _fit(
    element: Element,
    kind: str,
    place: NDArray[np.float64],
    part: Part,
) -> tuple[Primitive, NDArray[np.float64]]:
    """Return a shape fitted to a mesh: by its inertia, or by its bounds."""
    matter = part.meshes.weigh(element)
    if not matter.mass > 0.0:
        element.refuse(f"fits a {kind} to a mesh that encloses nothing; give it a size")
    moments, axes = find_principal_axes(matter.inertia)  # the longest side last
    inner = np.eye(4)
    inner[:3, :3], inner[:3, 3] = axes, matter.center_of_mass
    if part.compiler.fits_boxes:
        points = (part.meshes.read(element).vertices - matter.center_of_mass) @ axes
        low, high = points.min(axis=0), points.max(axis=0)
        inner[:3, 3] += axes @ (low + high) / 2.0
        sizes = _enclose_box(kind, *((high - low) / 2.0).tolist())
    else:
        squares = moments.sum() - 2.0 * moments
        half = np.sqrt(np.maximum(1.5 * squares / matter.mass, 0.0))
        sizes = _match_box(kind, *half.tolist())
    scale = element.number("fitscale")
    return _make(
        element, kind, [it * (1.0 if scale is None else scale) for it in sizes]
    ), place @ inner


def _match_box(kind: str, x: float, y: float, z: float) -> list[float]:
    """Return the sizes of a shape about as large as a box of these half sides."""
    match kind:
        case "sphere":
            return [(x + y + z) / 3.0]
        case "capsule":
            return [(x + y) / 2.0, max(z - (x + y) / 4.0, 1e-9)]
        case "cylinder":
            return [(x + y) / 2.0, z]
        case _:
            return [x, y, z]


def _enclose_box(kind: str, x: float, y: float, z: float) -> list[float]:
    """Return the sizes of the smallest shape whose bounds enclose a box of these half sides."""
    match kind:
        case "sphere":
            return [max(x, y, z)]
        case "capsule":
            return [max(x, y), z - max(x, y)]
        case "cylinder":
            return [max(x, y), z]
        case _:
            return [x, y, z]
