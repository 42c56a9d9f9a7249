"""Point shells and their point-sphere trees."""

from __future__ import annotations

from typing import TYPE_CHECKING

from voxshell.base.arguments import as_integer

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from voxshell._core import PointShell as CorePointShell
    from voxshell._core import PointSphereTree as CorePointSphereTree


class PointShell:
    """Points on a model's surface and, in models with a tolerance, its sharp edges.

    A uniform model has one point in each voxel that the surface crosses. A model with a tolerance has
    more points where the surface curves, a point at each sharp corner, and edge segments.

    A point's id is its row in these arrays. The ids of edge segments follow: segment i has the id
    ``len(shell) + i``. All arrays are read-only, in single precision, and the very numbers that
    queries use.

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
        """Positions, (n, 3) float32, metres, body frame; a new array each time.

        Queries hold them coordinate by coordinate, and nothing holds them twice: keep the array while you use it.
        """
        return self._core.points

    @property
    def normals(self) -> NDArray[np.float32]:
        """Outward unit normals of the surface, (n, 3) float32, body frame."""
        return self._core.normals

    @property
    def areas(self) -> NDArray[np.float32]:
        """The surface that each point stands for, (n,) float32, m2; they sum to the mesh's area."""
        return self._core.areas

    @property
    def edges(self) -> NDArray[np.float32]:
        """The ends of the edge segments, (m, 2, 3) float32, metres, body frame; a new array each time.

        Sharp edges are cut into short pieces. A piece touches at the place of its least distance, which
        queries find for each pose. There are none in uniform models.

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
        """Edge of the voxels that hold one point each, metres; the largest where there are several."""
        return self._core.spacing

    @property
    def tree(self) -> PointSphereTree:
        """The clusters of the points."""
        return PointSphereTree(self._core.tree)

    def __repr__(self) -> str:
        edges = len(self.edges)
        segments = f"{edges} edge segments, " if edges > 0 else ""
        return (
            f"PointShell({len(self)} points, {segments}spacing {self.spacing:g} m, "
            f"{self.tree.levels} levels)"
        )


class PointSphereTree:
    """Nested clusters of a shell's points, each with the smallest sphere that encloses it.

    Levels count from the root, which is level 1; level L has ``branching ** (L - 1)`` clusters. A
    cluster of a level is a *segment* of the shell at that level. Clusters are made of whole buckets
    of eight points.

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
        """Children of a cluster."""
        return self._core.branching

    @property
    def levels(self) -> int:
        """Levels with spheres: as many as have a bucket of points for each cluster."""
        return self._core.levels

    def spheres(self, level: int) -> NDArray[np.float32]:
        """The enclosing spheres of a level's clusters.

        Args:
            level: From 1, the root, to :attr:`levels`.

        Returns:
            (m, 4) float32, read-only: centre x, y, z and radius; metres, body frame.

        Raises:
            SettingsError: There is no such level.
        """
        return self._core.spheres(as_integer(level, "level", 1, self.levels))

    def segments(self, level: int) -> NDArray[np.int64]:
        """The cluster that each point belongs to.

        Args:
            level: From 1 to 12. Below :attr:`levels` there are no spheres, but segments still, some empty.

        Returns:
            (n,) int64, from 0 to ``branching ** (level - 1) - 1``, ascending.

        Raises:
            SettingsError: ``level`` is out of range.
        """
        return self._core.segments(as_integer(level, "level", 1, self._core.deepest_level))
