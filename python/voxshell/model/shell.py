"""Point shells and their point-sphere trees."""

from __future__ import annotations

from typing import TYPE_CHECKING, NoReturn

from voxshell.base.arguments import as_integer
from voxshell.errors import InputTypeError

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from voxshell._core import PointShell as CorePointShell
    from voxshell._core import PointSphereTree as CorePointSphereTree


class PointShell:
    """Points on the surface of a model and, in models by tolerance, segments of its sharp edges.

    A uniform model has one point in each voxel that the surface crosses. A model by tolerance has
    more points where the surface curves, a point at each sharp corner, and edge segments.

    The id of a point is its row in these arrays. The ids of edge segments follow: segment i has the
    id ``len(shell) + i``. All arrays are read-only, in single precision, and exactly what queries
    use.

    Example:
        >>> import trimesh
        >>> import voxshell as vx
        >>> model = vx.Model.from_mesh(trimesh.creation.icosphere(), resolution=20, target_points=500)
        >>> model.shell
        PointShell(... points, spacing 0.19... m, ... levels)
        >>> model.shell.points.shape == (len(model.shell), 3)
        True
    """

    __slots__ = ("_core",)

    def __init__(self, core: CorePointShell) -> None:
        self._core = core

    def __len__(self) -> int:
        return len(self._core)

    @property
    def points(self) -> NDArray[np.float32]:
        """Positions, (n, 3) float32, meters, body frame; a new array each time.

        Queries store the coordinates separately, so each access makes a copy: keep the array while
        you use it.
        """
        return self._core.points

    @property
    def normals(self) -> NDArray[np.float32]:
        """Outward unit normals of the surface, (n, 3) float32, body frame."""
        return self._core.normals

    @property
    def areas(self) -> NDArray[np.float32]:
        """Surface area that each point represents, (n,) float32, m2; the sum is the mesh's area."""
        return self._core.areas

    @property
    def edges(self) -> NDArray[np.float32]:
        """End points of the edge segments, (m, 2, 3) float32, meters, body frame; a new array.

        Sharp edges are cut into short segments. The contact of a segment is at its point of least
        distance, which queries find for each pose. Uniform models have no edge segments.

        Example:
            >>> import numpy as np
            >>> import trimesh
            >>> import voxshell as vx
            >>> box = vx.Model.from_mesh(trimesh.creation.box(), tolerance=0.001)
            >>> lengths = np.linalg.norm(box.shell.edges[:, 1] - box.shell.edges[:, 0], axis=1)
            >>> round(float(lengths.sum()), 3)
            12.0
        """
        return self._core.edges

    @property
    def spacing(self) -> float:
        """Edge length of the voxels with one point each, meters; the largest if they differ."""
        return self._core.spacing

    @property
    def tree(self) -> PointSphereTree:
        """The tree of clusters over the points."""
        return PointSphereTree(self._core.tree)

    def __reduce__(self) -> NoReturn:
        raise InputTypeError(
            "a PointShell cannot be pickled or copied: pass its model, or its arrays"
        )

    def __repr__(self) -> str:
        edges = len(self.edges)
        segments = f"{edges} edge segments, " if edges > 0 else ""
        return (
            f"PointShell({len(self)} points, {segments}spacing {self.spacing:g} m, "
            f"{self.tree.levels} levels)"
        )


class PointSphereTree:
    """Nested clusters of a shell's points, each with its smallest enclosing sphere.

    Levels count from the root, which is level 1; level L has ``branching ** (L - 1)`` clusters. A
    cluster is called a *segment* of the shell at its level. Clusters consist of whole buckets of
    eight points.

    Example:
        >>> import trimesh
        >>> import voxshell as vx
        >>> model = vx.Model.from_mesh(trimesh.creation.icosphere(), resolution=20, target_points=500)
        >>> tree = model.shell.tree
        >>> tree.levels
        3
        >>> tree.spheres(2).shape
        (4, 4)
        >>> sorted(set(tree.segments(2).tolist()))
        [0, 1, 2, 3]
    """

    __slots__ = ("_core",)

    def __init__(self, core: CorePointSphereTree) -> None:
        self._core = core

    @property
    def branching(self) -> int:
        """Number of children of a cluster."""
        return self._core.branching

    @property
    def levels(self) -> int:
        """Number of levels with spheres; on these levels, each cluster has at least one bucket."""
        return self._core.levels

    def spheres(self, level: int) -> NDArray[np.float32]:
        """Return the enclosing spheres of the clusters on a level.

        Args:
            level: From 1, the root, to :attr:`levels`.

        Returns:
            (m, 4) float32, read-only: center x, y, z and radius; meters, body frame.

        Raises:
            SettingsError: ``level`` is out of range.
        """
        return self._core.spheres(as_integer(level, "level", 1, self.levels))

    def segments(self, level: int) -> NDArray[np.int64]:
        """Return the cluster of each point on a level.

        Args:
            level: From 1 to 12. Levels deeper than :attr:`levels` have segments but no spheres;
                some of their segments are empty.

        Returns:
            (n,) int64, from 0 to ``branching ** (level - 1) - 1``, ascending.

        Raises:
            SettingsError: ``level`` is out of range.
        """
        return self._core.segments(as_integer(level, "level", 1, self._core.deepest_level))

    def __reduce__(self) -> NoReturn:
        raise InputTypeError("a PointSphereTree cannot be pickled or copied: pass its model")
