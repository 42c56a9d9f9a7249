"""Models: meshes prepared for collision."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from voxshell._core import Model as CoreModel
from voxshell.base.arguments import (
    as_choice,
    as_flag,
    as_path,
    as_positive,
    as_threads,
    check_callable,
)
from voxshell.base.calls import explain_calls
from voxshell.base.input_files import check_exists
from voxshell.base.lengths import in_millimeters
from voxshell.base.near_names import know_near_names
from voxshell.base.notebook import make_table
from voxshell.base.user_warnings import warn_user
from voxshell.errors import InputTypeError, ModelFileError
from voxshell.model.accuracy import read_accuracy
from voxshell.model.build_settings import as_settings
from voxshell.model.build_warnings import find_flaws, warn_of, warn_of_coarse_tolerance
from voxshell.model.building import build_core
from voxshell.model.field import SERIALS, DistanceField
from voxshell.model.mass_properties import MassProperties
from voxshell.model.meshes import (
    Mesh,
    MeshWarning,
    advise_on_mesh_file,
    as_model_path,
)
from voxshell.model.shell import PointShell

if TYPE_CHECKING:
    import os
    from collections.abc import Callable

    from numpy.typing import NDArray

    from voxshell.model.accuracy import Accuracy
    from voxshell.model.meshes import MeshLike


@explain_calls
@know_near_names
class Model:
    """A mesh prepared for collision: a distance field, a point shell and mass properties.

    Build one with :meth:`from_mesh`. Models are immutable, so threads, bodies and poses may share
    them. Arrays are in the mesh's frame, in meters, and read-only. They stay valid after the model
    is deleted.

    Example:
        >>> import trimesh
        >>> import voxshell as vx
        >>> model = vx.Model.from_mesh(trimesh.creation.box(), resolution=20)
        >>> model
        Model(12 triangles, 2402 points, field 57 x 57 x 57, voxel size 0.05 m, 0.1 MB)
        >>> model.bounds
        array([[-0.5, -0.5, -0.5],
               [ 0.5,  0.5,  0.5]])
    """

    __slots__ = ("_core", "_field", "_is_of_robot", "_is_sparse", "_judged", "_serial", "_shell")

    def __init__(self, core: CoreModel | None = None) -> None:
        if not isinstance(core, CoreModel):
            raise InputTypeError("build a model with Model.from_mesh(mesh)")
        self._core = core
        self._is_sparse: bool = core.tolerance > 0.0  # flat regions have few points
        self._is_of_robot = False  # a loader made it, which decides what helps against a warning
        self._serial = next(SERIALS)
        self._judged: set[int] = set()
        self._field = DistanceField(core.field, core.grid)
        self._shell = PointShell(core.shell)

    @classmethod
    def from_mesh(
        cls,
        mesh: MeshLike,
        *,
        tolerance: float | None = None,
        voxel_size: float | None = None,
        resolution: int | None = None,
        point_spacing: float | None = None,
        target_points: int | None = None,
        scale: float | None = None,
        padding: float | None = None,
        sign: Literal["auto", "closed", "winding"] = "auto",
        open: Literal["auto", "solid", "sheet"] = "auto",  # noqa: A002
        sheet_thickness: float | None = None,
        threads: int | None = None,
        cache: bool = True,
        progress: Callable[[str, float], object] | None = None,
    ) -> Model:
        """Build a model from a mesh.

        By default the model is built to a tolerance: its voxels, exact cells, points and edge
        segments follow from the shape, so that the errors of both field and shell stay below the
        tolerance. With any of ``voxel_size``, ``resolution``, ``point_spacing`` and
        ``target_points`` the model is uniform, as in the thesis. :attr:`accuracy` holds the
        measured errors of either kind.

        A build takes from milliseconds to minutes, depending on the number of voxels. Ctrl-C stops
        it. A model that was built before is loaded from the disk.

        Args:
            mesh: A ``trimesh.Trimesh``; a pair of vertices, (n, 3), and faces, (m, 3), which are
                indices of vertices, counterclockwise when seen from outside; or the path of a file
                that trimesh reads. The bodies of a file become one mesh.
            tolerance: Largest accepted error of the model, meters, after ``scale``. Exclusive with
                all sizes. The default is the smallest of three lengths: a 2,000th of the longest
                side, 0.2 mm, and a 20th of the thickness of the thinnest wall. For bodies longer
                than 4 m, a 20,000th of the side replaces 0.2 mm.
            voxel_size: Edge length of the field's grid cells, meters, after ``scale``.
            resolution: Alternative to ``voxel_size``: number of cells along the mesh's longest
                side. The default is 100 if only the spacing or number of points is given.
            point_spacing: Edge length of the voxels that get one point each, meters, after
                ``scale``. The default is the field's voxel size.
            target_points: Alternative to ``point_spacing``: number of points, reached within 1 %.
            scale: Factor on all vertices, to convert the mesh to meters (0.001 for millimeters). By
                default, 3MF and COLLADA files and trimesh objects have the unit that they state, and
                everything else is in meters. A warning asks for ``scale`` if a file without a unit is longer than 10 m.
            padding: Width of the grid beyond the mesh's bounds, meters. The default is 16 voxels;
                at least eight are used. The field continues beyond its grid, less accurately.
            sign: How to find the inside of the mesh. "closed": by the surface; a mesh that is not
                closed, is inside out or overlaps itself is refused. "winding": inside is where the
                generalized winding number is above one half. This works for open, nested,
                overlapping and non-manifold meshes if most of the surface exists. "auto": "closed"
                if the mesh is closed, otherwise "winding" with a warning.
            open: How to treat a mesh with open edges. "solid": close it; inside is where the
                winding number is above one half. "sheet": make its open parts sheets of
                ``sheet_thickness``, which collide from both sides; closed parts stay solid. "auto":
                with ``sign="auto"``, make a sheet if it is a tube, or if caps across its openings
                would have 15 % of the surface's area or more; otherwise make a solid. A warning
                says which.
            sheet_thickness: Meters, after ``scale``; half of it lies on each side of the surface.
                The default is a 200th of the longest side, and at least two voxels in a uniform
                model.
            threads: Number of threads, up to 1024; one per CPU core by default. It does not affect
                the result.
            cache: Keep the model on the disk, and load it from there if it was built before: see
                :mod:`voxshell.model.cache`. Models that are built in less than 50 ms are not kept.
            progress: Called from this thread about every 50 ms with the name of the stage and its
                completed fraction, 0 to 1. If it raises, the build stops and raises the same
                exception.

        Returns:
            The model. Its mesh is the input with equal vertices merged, and without unused vertices
            and degenerate triangles.

        Raises:
            MissingFileError: A file does not exist.
            MeshError: The mesh cannot be read, encloses no volume, has numbers that are not finite,
                is smaller than a voxel or the point spacing, or is not closed although ``sign``
                requires it.
            SettingsError: A setting is out of range or contradicts another, or
                ``VOXSHELL_CACHE_SIZE`` is not a size.
            MemoryLimitError: The field or shell would be too large. The message suggests a setting
                that fits.
            InputTypeError: ``mesh`` has an unsupported type.

        Warns:
            MeshWarning: With ``sign="auto"``, the mesh is not closed or is inside out. The message
                says how often and where, and how it was handled.
            AccuracyWarning: The error of the field or the shell exceeds the tolerance on more than
                1 % of the surface. The message says by how much, and what to do. Or ``tolerance``
                is above a fifth of the mesh's shortest side, as of millimeters.

        Example:
            >>> import trimesh
            >>> import voxshell as vx
            >>> mesh = trimesh.creation.torus(major_radius=50, minor_radius=20)  # millimeters
            >>> model = vx.Model.from_mesh(mesh, voxel_size=0.004, target_points=1000, scale=0.001)
            >>> 990 <= len(model.shell) <= 1010
            True

            To a tolerance, and by default:

            >>> model = vx.Model.from_mesh(mesh, tolerance=0.0002, scale=0.001)
            >>> model.accuracy.distance.p99 < 0.0002 and model.accuracy.coverage.p99 < 0.0002
            True
            >>> vx.Model.from_mesh(mesh, scale=0.001).tolerance.__round__(6)
            7e-05
        """
        check_callable(progress, "progress")
        is_cached = as_flag(cache, "cache")
        settings = as_settings(
            tolerance=tolerance,
            voxel_size=voxel_size,
            resolution=resolution,
            point_spacing=point_spacing,
            target_points=target_points,
            padding=padding,
            sign=sign,
            open_as=open,
            sheet_thickness=sheet_thickness,
        )
        core, doubt, extents, rim = build_core(
            mesh,
            settings,
            scale=scale,
            threads=as_threads(threads),
            is_cached=is_cached,
            progress=progress,
        )
        if doubt:
            warn_user(doubt, MeshWarning)
        if tolerance is not None:
            warn_of_coarse_tolerance(tolerance, extents)
        warn_of(find_flaws(core, rim, sign=sign, open_as=open))
        return cls(core)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write the model to a file, which :meth:`load` reads in milliseconds.

        The file is written completely or not at all; it replaces a file of the same name. Equal
        models give equal bytes.

        Args:
            path: The file's path, which ends in .vxs.

        Raises:
            SettingsError: The suffix is another one.
            MissingFileError: Its folder does not exist.
            FileAccessError: The file cannot be written: no permission, disk full.
            InputTypeError: ``path`` is not a path.

        Example:
            >>> import os, tempfile, trimesh
            >>> import voxshell as vx
            >>> model = vx.Model.from_mesh(trimesh.creation.box(), resolution=10)
            >>> with tempfile.TemporaryDirectory() as folder:
            ...     path = os.path.join(folder, "box.vxs")
            ...     model.save(path)
            ...     vx.Model.load(path).shell.points.tobytes() == model.shell.points.tobytes()
            True
        """
        self._core.save(as_model_path(path))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Model:
        """Read a model that :meth:`save` wrote.

        A file is loaded only if it is valid: its checksum is correct, all indices are in range and
        all numbers are finite.

        Args:
            path: The file's path.

        Returns:
            The model, equal to the saved one in every bit.

        Raises:
            MissingFileError: The file does not exist.
            FileAccessError: The file cannot be read.
            ModelFileError: It is not a model file, is damaged, or has another version.
            MemoryLimitError: It is larger than 4 GiB or than the available memory.
            InputTypeError: ``path`` is not a path.

        Example:
            >>> import voxshell as vx
            >>> vx.Model.load("pyproject.toml")
            Traceback (most recent call last):
            voxshell.errors.ModelFileError: pyproject.toml: not a model file: it does not begin with the signature of one
        """
        name = as_path(path, "path")
        check_exists(name)
        try:
            return cls(CoreModel.load(name))
        except ModelFileError as error:
            raise ModelFileError(f"{error}{advise_on_mesh_file(name)}") from None

    def __reduce__(self) -> tuple[Callable[[bytes], Model], tuple[bytes]]:
        """Pickle the model as the bytes of a model file."""
        return _unpickle, (self._core.to_bytes(),)

    @property
    def mesh(self) -> Mesh:
        """The triangles: ``vertices, faces = model.mesh``, (n, 3) float64 and (m, 3) uint32."""
        return Mesh(self._core.vertices, self._core.faces)

    @property
    def field(self) -> DistanceField:
        """The signed distance field; queries test other bodies' points against it."""
        return self._field

    @property
    def shell(self) -> PointShell:
        """The points on the surface; queries test them against other bodies' fields."""
        return self._shell

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Lower and upper corner of the mesh's bounding box, (2, 3) float64, meters."""
        return np.array(self._core.bounds)

    @property
    def accuracy(self) -> Accuracy:
        """Accuracy of the model, measured on its surface when it was built.

        Example:
            >>> import trimesh
            >>> import voxshell as vx
            >>> model = vx.Model.from_mesh(trimesh.creation.box(), resolution=50)
            >>> model.accuracy.distance.p99 < 1e-5
            True
        """
        return read_accuracy(self._core)

    @property
    def thickness(self) -> float:
        """Thickness of the body's thinnest walls, meters.

        A chord starts on the surface, runs straight in, and leaves through a face that is opposite
        to within 30 degrees. This is the first percentile of their lengths, weighted by area, and
        at most the shortest side of the bounds.

        Example:
            >>> import trimesh
            >>> import voxshell as vx
            >>> plate = trimesh.creation.box((1.0, 0.5, 0.02))
            >>> round(vx.Model.from_mesh(plate, resolution=50).thickness, 6)
            0.02
        """
        return self._core.thickness

    @property
    def tolerance(self) -> float | None:
        """Largest error that the build allowed for field and shell, meters; None if uniform."""
        return self._core.tolerance or None

    def mass_properties(
        self, mass: float = 1.0, kind: Literal["solid", "surface"] = "solid"
    ) -> MassProperties:
        """Return mass, center of mass and inertia of the model as a body of uniform density.

        Args:
            mass: Kilograms.
            kind: "solid" for the volume inside the mesh, "surface" for a thin skin on it.

        Returns:
            The properties in the mesh's frame, with the inertia about the center of mass.

        Raises:
            SettingsError: ``mass`` is not above 0, or ``kind`` is unknown.

        Example:
            >>> import trimesh
            >>> import voxshell as vx
            >>> model = vx.Model.from_mesh(trimesh.creation.box(), resolution=10)
            >>> model.mass_properties(mass=6.0).inertia.round(9) + 0.0
            array([[1., 0., 0.],
                   [0., 1., 0.],
                   [0., 0., 1.]])
        """
        kilograms = as_positive(mass, "mass")
        if as_choice(kind, "kind", ("solid", "surface")) == "solid":
            center, inertia = self._core.solid_mass_properties
        else:
            center, inertia = self._core.surface_mass_properties
        return MassProperties(kilograms, np.array(center), kilograms * np.array(inertia))

    def __repr__(self) -> str:
        x, y, z = self.field.shape
        tolerance = "" if self.tolerance is None else f"tolerance {self.tolerance:.3g} m, "
        return (
            f"Model({len(self._core.faces)} triangles, {len(self.shell)} points, {tolerance}"
            f"field {x} x {y} x {z}, voxel size {self.field.voxel_size:g} m, "
            f"{self.field.nbytes / 1e6:.1f} MB)"
        )

    def _repr_html_(self) -> str:
        """Return a table of facts for notebooks."""
        x, y, z = self.field.shape
        size = " x ".join(f"{1e3 * side:.4g}" for side in np.ptp(self.bounds, axis=0))
        facts = {
            "size": f"{size} mm",
            "tolerance": "none: uniform, with the voxel size of the field"
            if self.tolerance is None
            else f"{1e3 * self.tolerance:.3g} mm",
            "triangles": f"{len(self._core.faces):,}",
            "points of the shell": f"{len(self.shell):,}, {1e3 * self.shell.spacing:.3g} mm apart",
            "field": f"{x} x {y} x {z} nodes, {1e3 * self.field.voxel_size:.3g} mm apart, "
            f"{self.field.nbytes / 1e6:.1f} MB",
            "field error": f"{in_millimeters(self.accuracy.distance.median)} mm median, "
            f"{in_millimeters(self.accuracy.distance.max)} mm worst",
        }
        return make_table("Model", facts)


def _unpickle(content: bytes) -> Model:
    return Model(CoreModel.from_bytes(content))
