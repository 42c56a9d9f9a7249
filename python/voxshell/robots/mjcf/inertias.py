"""Masses and inertias of bodies by MuJoCo's rules."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from voxshell.model.mass_properties import MassProperties
from voxshell.robots.description import Inertial
from voxshell.robots.solids import add_up, is_sound

if TYPE_CHECKING:
    from numpy.typing import NDArray

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
        from_geoms = compiler.inertia_from_geoms
        if self.inertial is not None and from_geoms != "true":
            matter = self._read(self.inertial, compiler)
        elif from_geoms != "false":
            parts = []
            for geom in self.geoms:
                solid = geom.weigh()
                if solid is not None and geom.surface is not None:
                    parts.append((solid, geom.surface.link_from_geometry))
            matter = add_up(parts) if parts else None
        if matter is not None and not (np.isfinite(matter.inertia).all() and matter.mass < np.inf):
            self.element.refuse("has a mass or inertia that overflows; correct it")
        return None if matter is None else _bound(matter, compiler)

    def _read(self, element: Element, compiler: Compiler) -> MassProperties:
        mass = element.number("mass")
        if mass is None:
            element.refuse("has an <inertial> without mass; add it")
        if mass < 0.0:
            element.refuse(f"has a mass of {mass:g} kg; it must not be below 0")
        place = self.frame @ compiler.read_pose(element)
        full = element.numbers("fullinertia", (6,))
        if full is not None:
            xx, yy, zz, xy, xz, yz = full
            tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        else:
            tensor = np.diag(element.numbers("diaginertia", (3,)) or [0.0, 0.0, 0.0])
        return MassProperties(mass, place[:3, 3], place[:3, :3] @ tensor @ place[:3, :3].T)


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
