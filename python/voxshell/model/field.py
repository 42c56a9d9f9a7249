"""Signed distance fields."""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING, NoReturn

import numpy as np

from voxshell.base.arguments import as_points
from voxshell.base.calls import explain_calls
from voxshell.errors import InputTypeError

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

    from voxshell._core import Field as CoreField
    from voxshell._core import GridField as CoreGridField
    from voxshell._core import Model as CoreModel


SERIALS = itertools.count()
"""Numbers that identify bodies while the program runs; Python may reuse an id()."""


@explain_calls
class Field:
    """A signed distance field: the distance of a point from a surface, negative inside.

    A model has a :class:`DistanceField`. The analytic shapes, such as :class:`Plane`, :class:`Box`
    and :class:`Sphere`, are fields that evaluate a formula. Fields are immutable.
    """

    __slots__ = ("_core", "_judged", "_serial", "_shell_model")

    def __init__(self, core: CoreField) -> None:
        self._core = core
        self._shell_model: CoreModel | None = None
        self._serial = next(SERIALS)
        self._judged: set[int] = set()

    def sample(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return signed distances at points, in single precision like every query.

        Args:
            points: (n, 3) float64, meters, body frame.

        Returns:
            (n,) float64, meters, negative inside.

        Raises:
            SettingsError: ``points`` has another shape, or numbers that are not finite.

        Example:
            >>> import voxshell as vx
            >>> vx.Sphere(radius=0.5).sample([[0, 0, 2], [0, 0, 0]])
            array([ 1.5, -0.5])
        """
        return self._core.sample(as_points(points, "points"))

    def gradient(self, points: ArrayLike) -> NDArray[np.float64]:
        """Return gradients of the distance at points; they point out of the surface.

        Args:
            points: (n, 3) float64, meters, body frame.

        Returns:
            (n, 3) float64. Analytic shapes return unit length. The field of a model returns the
            exact gradient of :meth:`sample`, whose length is near 1 except close to the medial
            axis.

        Raises:
            SettingsError: ``points`` has another shape, or numbers that are not finite.

        Example:
            >>> import voxshell as vx
            >>> vx.Box(half_extents=(1, 1, 1)).gradient([[0.9, 0, 0], [0, 0, 3]])
            array([[1., 0., 0.],
                   [0., 0., 1.]])
        """
        return self._core.gradient(as_points(points, "points"))


class DistanceField(Field):
    """The distance field of a model: distances at the nodes of a sparse grid, trilinear in between.

    The grid is fine near the surface and coarser far from it. Outside the grid, the distance is
    estimated from the nearest point of the grid. The error of the estimate is less than the
    distance of that point from the surface, and does not grow with the distance from the grid;
    :func:`voxshell.distance` states the bound.

    Example:
        >>> import trimesh
        >>> import voxshell as vx
        >>> box = trimesh.creation.box(extents=(0.2, 0.2, 0.1))
        >>> field = vx.Model.from_mesh(box, voxel_size=0.01).field
        >>> field
        DistanceField(57 x 57 x 49 nodes, voxel size 0.01 m, 0.1 MB)
        >>> field.sample([[0, 0, 0.07]]).round(6)
        array([0.02])
    """

    __slots__ = ("_grid",)

    def __init__(self, core: CoreField, grid: CoreGridField) -> None:
        super().__init__(core)
        self._grid = grid

    @property
    def shape(self) -> tuple[int, int, int]:
        """Number of nodes along x, y and z."""
        x, y, z = self._grid.shape
        return x, y, z

    @property
    def voxel_size(self) -> float:
        """Edge length of a grid cell, meters."""
        return self._grid.voxel_size

    @property
    def origin(self) -> NDArray[np.float64]:
        """Position of the first node, (3,) float64, meters, body frame."""
        return np.array(self._grid.origin)

    @property
    def nbytes(self) -> int:
        """Memory that the field takes, bytes."""
        return self._grid.nbytes

    @property
    def interpolation_error(self) -> float:
        """Largest error of :meth:`sample` near the surface, meters."""
        return self._grid.interpolation_error

    @property
    def surface_error(self) -> float:
        """Largest distance from the surface at which field and mesh disagree on the inside, meters.

        This bound is proven. The build of a model by tolerance proves it cell by cell. For uniform
        models it follows from :attr:`interpolation_error`.
        """
        return self._grid.surface_error

    @property
    def sign_method(self) -> str:
        """How the inside was found: "closed" by the surface, "winding" by winding numbers."""
        return self._grid.sign_method

    @property
    def sign_confidence(self) -> float:
        """1 for a closed mesh; otherwise the fraction of its area that clearly bounds an inside.

        The surface clearly bounds an inside where the winding number is not near one half on either
        side. At any voxel size, the value is near 1 for a mesh with a few holes, and 0 for a sheet.
        A mesh with a value below one half is refused.
        """
        return self._grid.sign_confidence

    def __reduce__(self) -> NoReturn:
        raise InputTypeError("a DistanceField cannot be pickled or copied: pass its model")

    def __repr__(self) -> str:
        x, y, z = self.shape
        return (
            f"DistanceField({x} x {y} x {z} nodes, voxel size {self.voxel_size:g} m, "
            f"{self.nbytes / 1e6:.1f} MB)"
        )
