"""Masses and inertias of bodies by MuJoCo's rules."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from voxshell.model.mass_properties import MassProperties
from voxshell.robots.description import Inertial, Primitive
from voxshell.robots.mjcf.principal_axes import find_principal_axes
from voxshell.robots.solids import add_up, is_sound

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell.robots.description import Collision
    from voxshell.robots.mjcf.compiler import Compiler
    from voxshell.robots.mjcf.geoms import Geom
    from voxshell.robots.xml_elements import Element


@dataclass(eq=False)
class BodyMatter:
    """The elements that determine the mass properties of a body."""

    element: Element
    inertial: Element | None
    frame: NDArray[np.float64]
    geoms: list[Geom]

    def compute(self, compiler: Compiler) -> MassProperties | None:
        """Return the mass properties in the body's frame; None if it has none.

        Raises:
            RobotError: A number is invalid, or a mesh cannot be read.
        """
        matter = None
        given = self._find_given(compiler)
        if given is not None:
            matter = self._read(given, compiler)
        else:
            matter = _join(self._weigh_geoms(compiler))
        if matter is not None and not (np.isfinite(matter.inertia).all() and matter.mass < np.inf):
            self.element.refuse("has a mass or inertia that overflows; correct it")
        return None if matter is None else _bound(matter, compiler)

    def find_frame(self, compiler: Compiler) -> NDArray[np.float64] | None:
        """``body_from_inertia``: center and principal axes, as MuJoCo chooses them; None without matter.

        Raises:
            RobotError: A number is wrong, or a mesh cannot be read.
        """
        given = self._find_given(compiler)
        if given is not None:
            place = self.frame @ compiler.read_pose(given)
            full = _read_full(given)
            return place if full is None else place @ _pose_axes(np.zeros(3), full)
        weighed = self._weigh_geoms(compiler)
        if len(weighed) != 1:
            whole = _join(weighed)
            return None if whole is None else _pose_axes(whole.center_of_mass, whole.inertia)
        ((surface, solid),) = weighed
        if isinstance(surface.geometry, Primitive):
            return surface.link_from_geometry
        return surface.link_from_geometry @ _pose_axes(solid.center_of_mass, solid.inertia)

    def _find_given(self, compiler: Compiler) -> Element | None:
        """Return the inertial that MuJoCo uses."""
        return None if compiler.inertia_from_geoms == "true" else self.inertial

    def _weigh_geoms(self, compiler: Compiler) -> list[tuple[Collision, MassProperties]]:
        """Return the geoms that MuJoCo uses, each with its matter in its own frame."""
        weighed = []
        for geom in self.geoms if compiler.inertia_from_geoms != "false" else ():
            solid = geom.weigh()
            if solid is not None and geom.surface is not None:
                weighed.append((geom.surface, solid))
        return weighed

    def _read(self, element: Element, compiler: Compiler) -> MassProperties:
        mass = element.number("mass")
        if mass is None:
            element.refuse("has an <inertial> without mass; add it")
        if mass < 0.0:
            element.refuse(f"has a mass of {mass:g} kg; it must not be below 0")
        place = self.frame @ compiler.read_pose(element)
        tensor = _read_full(element)
        if tensor is None:
            tensor = np.diag(element.numbers("diaginertia", (3,)) or [0.0, 0.0, 0.0])
        return MassProperties(mass, place[:3, 3], place[:3, :3] @ tensor @ place[:3, :3].T)


def _join(weighed: list[tuple[Collision, MassProperties]]) -> MassProperties | None:
    parts = [(solid, surface.link_from_geometry) for surface, solid in weighed]
    return add_up(parts) if parts else None


def _pose_axes(center: NDArray[np.float64], inertia: NDArray[np.float64]) -> NDArray[np.float64]:
    place = np.eye(4)
    place[:3, :3] = find_principal_axes(inertia)[1]
    place[:3, 3] = center
    return place


def _read_full(element: Element) -> NDArray[np.float64] | None:
    full = element.numbers("fullinertia", (6,))
    if full is None:
        return None
    xx, yy, zz, xy, xz, yz = full
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _bound(matter: MassProperties, compiler: Compiler) -> MassProperties:
    """Apply minimum mass and inertia, and use a ball's inertia if the moments are impossible."""
    moments, axes = np.linalg.eigh(matter.inertia)
    moments = np.maximum(moments, compiler.least_inertia)
    if compiler.balances_inertia and moments[0] + moments[1] < moments[2]:
        moments[:] = moments.mean()
    inertia = axes @ np.diag(moments) @ axes.T
    return MassProperties(max(matter.mass, compiler.least_mass), matter.center_of_mass, inertia)


def as_inertial(matter: MassProperties | None) -> Inertial | None:
    """Return a link's mass properties from those of its body; None without a mass."""
    if matter is None or not matter.mass > 0.0:
        return None
    inertia = matter.inertia if is_sound(matter.inertia) else None
    return Inertial(matter.mass, matter.center_of_mass, inertia)
