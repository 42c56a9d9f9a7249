"""Bullet's own shapes for meshes, as baselines for models; they collide only in a World."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from voxshell import _bullet
from voxshell.base.arguments import as_floats, as_not_negative, is_iterable
from voxshell.base.calls import explain_calls
from voxshell.errors import InputTypeError, MeshError, SettingsError
from voxshell.model.meshes import Mesh, read_mesh

if TYPE_CHECKING:
    from collections.abc import Iterable
    from typing import TypeAlias

    import trimesh
    from numpy.typing import ArrayLike, NDArray

    from voxshell.model.meshes import MeshLike

    HullPoints: TypeAlias = ArrayLike | Mesh | trimesh.Trimesh

MARGIN = 0.001
"""Bullet's collision margin of these shapes, meters; small enough for bodies of 0.1 m."""


@explain_calls
class GImpact:
    """A mesh that collides triangle by triangle in Bullet's GImpact.

    Args:
        mesh: Any mesh that :meth:`voxshell.Model.from_mesh` accepts; it may be open.
        margin: Bullet's collision margin, meters.

    Raises:
        MissingFileError: A file does not exist.
        MeshError: The mesh cannot be read.
        SettingsError: ``margin`` is below 0.

    Example:
        >>> import trimesh
        >>> import voxshell as vx
        >>> vx.GImpact(trimesh.creation.box())
        GImpact(12 triangles)
    """

    __slots__ = ("margin", "mesh")

    def __init__(self, mesh: MeshLike, *, margin: float = MARGIN) -> None:
        self.mesh: Mesh = read_mesh(mesh)
        if len(self.mesh.faces) == 0:
            raise MeshError("mesh has no triangles")
        self.margin: float = as_not_negative(margin, "margin")

    def __repr__(self) -> str:
        return f"GImpact({len(self.mesh.faces)} triangles)"


@explain_calls
class ConvexDecomposition:
    """Convex hulls that together represent a body, as a compound shape of Bullet.

    Args:
        hulls: Points of each hull, (n, 3), meters, body frame, or a mesh, whose vertices are taken;
            at least one hull.
        margin: Bullet's collision margin, meters; hulls keep this distance from other bodies.

    Raises:
        MeshError: The points of a hull do not enclose a volume.
        InputTypeError: ``hulls`` is no sequence.
        SettingsError: There is no hull, or ``margin`` is below 0.

    Example:
        >>> import trimesh
        >>> import voxshell as vx
        >>> left = trimesh.creation.box(bounds=[(0, 0, 0), (1, 1, 1)])
        >>> right = trimesh.creation.box(bounds=[(1, 0, 0), (2, 1, 3)])
        >>> vx.ConvexDecomposition([left, right])
        ConvexDecomposition(2 hulls, 16 points)
    """

    __slots__ = ("hulls", "margin", "mesh")

    def __init__(self, hulls: Iterable[HullPoints], *, margin: float = MARGIN) -> None:
        if not is_iterable(hulls):
            raise InputTypeError(
                f"hulls must be arrays of points, one for each hull, not {type(hulls).__name__}"
            )
        self.hulls: list[NDArray[np.float64]] = [
            _as_hull(points, f"hulls[{index}]") for index, points in enumerate(hulls)
        ]
        if not self.hulls:
            raise SettingsError("give at least one hull")
        self.margin: float = as_not_negative(margin, "margin")
        self.mesh: Mesh = _triangulate(self.hulls)

    def __repr__(self) -> str:
        points = sum(len(hull) for hull in self.hulls)
        return f"ConvexDecomposition({len(self.hulls)} hulls, {points} points)"


@explain_calls
class ConvexHull(ConvexDecomposition):
    """The convex hull of a set of points.

    Args:
        points: (n, 3), meters, body frame, or a mesh, whose vertices are taken; points inside the
            hull only cost time.
        margin: Bullet's collision margin, meters.

    Raises:
        MeshError: The points do not enclose a volume.
        SettingsError: ``margin`` is below 0.

    Example:
        >>> import trimesh
        >>> import voxshell as vx
        >>> vx.ConvexHull(trimesh.creation.box())
        ConvexHull(8 points)
    """

    __slots__ = ()

    def __init__(self, points: HullPoints, *, margin: float = MARGIN) -> None:
        super().__init__([points], margin=margin)

    @classmethod
    def sampled(cls, points: HullPoints, *, margin: float = MARGIN) -> ConvexHull:
        """Return the hull of the farthest points in the 42 directions of Bullet's btShapeHull.

        Games use such hulls. The thesis (section 5.3) calls this its convex hull of 42 vertices.

        Example:
            >>> import trimesh
            >>> import voxshell as vx
            >>> len(vx.ConvexHull.sampled(trimesh.creation.icosphere(4)).hulls[0])
            42
        """
        return cls(_bullet.sample_hull(_as_hull(points, "points")), margin=margin)

    def __repr__(self) -> str:
        return f"ConvexHull({len(self.hulls[0])} points)"


def _as_hull(points: HullPoints, name: str) -> NDArray[np.float64]:
    corners = cast("ArrayLike", getattr(points, "vertices", points))
    hull = as_floats(corners, name, (None, 3), MeshError)
    if len(hull) < 4:
        raise MeshError(f"{name} has {len(hull)} points; a hull needs at least 4")
    if not np.isfinite(hull).all():
        raise MeshError(f"{name} has {int((~np.isfinite(hull)).sum())} numbers that are not finite")
    return hull


def _triangulate(hulls: list[NDArray[np.float64]]) -> Mesh:
    for index, points in enumerate(hulls):
        spread = np.linalg.svd(points - points.mean(axis=0), compute_uv=False)
        if spread[2] <= 1e-9 * spread[0]:
            raise MeshError(f"the points of hull {index} lie in a plane and enclose no volume")
    return Mesh(*_bullet.triangulate_hulls(hulls))
