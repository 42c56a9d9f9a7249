"""Models: meshes made ready to collide."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

import numpy as np

from voxshell._core import Model as CoreModel
from voxshell.base.arguments import (
    as_integer,
    as_length,
    as_path,
    as_positive,
    as_threads,
)
from voxshell.base.notebook import make_table
from voxshell.errors import InputTypeError, SettingsError
from voxshell.model.accuracy import read_accuracy
from voxshell.model.build_settings import as_open, as_padding, as_sheet_thickness, as_sign
from voxshell.model.build_warnings import warn_of_accuracy, warn_of_faults
from voxshell.model.cache import compute_key, open_cache
from voxshell.model.field import SERIALS, DistanceField
from voxshell.model.mass_properties import MassProperties
from voxshell.model.meshes import Mesh, naming_file, read_mesh
from voxshell.model.shell import PointShell

if TYPE_CHECKING:
    import os
    from collections.abc import Callable

    from numpy.typing import NDArray

    from voxshell.model.accuracy import Accuracy
    from voxshell.model.meshes import MeshLike

_LARGEST_INT = 2**31 - 1


class Model:
    """A mesh made ready to collide: distance field, point shell and mass properties.

    Build one with :meth:`from_mesh`. Models are immutable; any number of threads, bodies and poses
    may share one. Arrays are in the mesh's frame and metres; they are read-only and stay valid
    after the model is gone.

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

    __slots__ = ("_core", "_field", "_is_sparse", "_judged", "_serial", "_shell")

    def __init__(self, core: CoreModel) -> None:
        if not isinstance(core, CoreModel):
            raise InputTypeError("build a model with Model.from_mesh(mesh)")
        self._core = core
        self._is_sparse: bool = core.tolerance > 0.0  # few points where it is flat
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
        scale: float = 1.0,
        padding: float | None = None,
        sign: Literal["auto", "closed", "winding"] = "auto",
        open: Literal["auto", "solid", "sheet"] = "auto",  # noqa: A002
        sheet_thickness: float | None = None,
        threads: int | None = None,
        cache: bool = True,
        progress: Callable[[str, float], object] | None = None,
    ) -> Model:
        """Builds a model of a mesh.

        Without sizes the model is built to a tolerance: its voxels, exact cells, points and edge
        segments follow from the shape, so that neither the field nor the shell misses more than the
        tolerance. With any of ``voxel_size``, ``resolution``, ``point_spacing`` and
        ``target_points`` it is uniform, as in the thesis. :attr:`accuracy` is what was measured
        either way.

        Takes from milliseconds to minutes: the time grows with the number of voxels. Ctrl-C stops
        it. The same model again comes from the disk.

        Args:
            mesh: A ``trimesh.Trimesh``; a pair of vertices, (n, 3), and faces, (m, 3), rows of
                vertices, counter-clockwise seen from outside; or the path of a file that trimesh
                reads, whose bodies become one mesh.
            tolerance: How far the model may be off the mesh, metres, after ``scale``; not together
                with any size. The default follows from the longest side and from the wall that is
                thinnest: a 2,000th of the side, but no more than 0.2 mm or, above 4 m, a
                20,000th of the side; and a 20th of the thickness.
            voxel_size: Edge of the field's grid cells, metres, after ``scale``.
            resolution: Or how many of them along the mesh's longest side; 100 where only the
                points' spacing or number is given.
            point_spacing: Edge of the voxels that get one point each, metres, after ``scale``; the
                field's voxel size if neither this nor ``target_points`` is given.
            target_points: Or how many points are wanted, which is reached within 1 %.
            scale: Factor on all vertices, to bring the mesh to metres (0.001 for millimetres).
            padding: Metres of grid beyond the mesh's bounds, by default 16 voxels; at least eight
                are kept. The field continues beyond its grid, less precisely.
            sign: How to tell what the mesh has inside. "closed": by its surface, and a mesh that is
                not closed, is inside out or overlaps itself is refused. "winding": inside is where
                the generalised winding number is above a half, which works for open, nested,
                overlapping and non-manifold meshes as long as most of a surface is there. "auto":
                as closed if the mesh is, else by winding numbers and with a warning.
            open: What a mesh with open edges becomes. "solid": it is closed, and inside is where the
                winding number is above a half. "sheet": its open parts are kept as sheets of
                ``sheet_thickness``, which collide from both sides; parts that are closed stay solid.
                "auto": with ``sign="auto"``, a sheet where caps across its openings would have 15 %
                of the surface's area or more, or where it is a tube, with a warning that says which;
                else a solid.
            sheet_thickness: Metres, after ``scale``, half of it on either side of the surface; by
                default a 200th of the longest side, and of uniform models at least two voxels.
            threads: How many to use, up to 1024; one a core by default. The result is the same.
            cache: Keep the model on the disk, and take it from there where it was built before: see
                :mod:`voxshell.model.cache`. Models that are built in less than 50 ms are not kept.
            progress: Called from this thread about every 50 ms with the name of the stage and the
                share of it that is done, 0 to 1. If it raises, the build stops and raises that.

        Returns:
            The model, with the mesh as it is after equal vertices are merged, and vertices without
            triangles and triangles without three corners are dropped.

        Raises:
            MeshError: The mesh cannot be read, encloses no volume, has numbers that are not finite,
                is smaller than a voxel or the point spacing, or is not closed where ``sign`` says so.
            SettingsError: A setting is out of range, or contradicts another.
            SettingsError: ``VOXSHELL_CACHE_SIZE`` is no size.
            MemoryLimitError: The field or shell would be too large; the message says which setting
                would do.
            InputTypeError: ``mesh`` is of none of the types above.

        Warns:
            MeshWarning: With ``sign="auto"``, the mesh is not closed or is inside out; says how often
                and where, and what was made of it.
            AccuracyWarning: The field or the shell is off by more than the tolerance on more than
                1 % of the surface; says by how much, and what it would take.

        Example:
            >>> import trimesh
            >>> import voxshell as vx
            >>> mesh = trimesh.creation.torus(major_radius=50, minor_radius=20)  # millimetres
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
        if progress is not None and not callable(progress):
            raise InputTypeError(f"progress must be callable, not {type(progress).__name__}")
        for one, other, names in (
            (voxel_size, resolution, "voxel_size or resolution"),
            (point_spacing, target_points, "point_spacing or target_points"),
        ):
            if one is not None and other is not None:
                raise SettingsError(f"give either {names}, not both")
        sizes = (voxel_size, resolution, point_spacing, target_points)
        if tolerance is not None and any(size is not None for size in sizes):
            raise SettingsError(
                "give either a tolerance or the sizes of a uniform model (voxel_size, resolution, "
                "point_spacing, target_points), not both"
            )
        # The core takes 0 for "not given".
        settings = {
            "tolerance": 0.0 if tolerance is None else as_length(tolerance, "tolerance"),
            "voxel_size": 0.0 if voxel_size is None else as_length(voxel_size, "voxel_size"),
            "resolution": 0
            if resolution is None
            else as_integer(resolution, "resolution", 2, _LARGEST_INT),
            "point_spacing": 0.0
            if point_spacing is None
            else as_length(point_spacing, "point_spacing"),
            "target_points": 0
            if target_points is None
            else as_integer(target_points, "target_points", 1, _LARGEST_INT),
            "padding": -1.0 if padding is None else as_padding(padding),
            "sign": as_sign(sign),
            "open": as_open(open),
            "sheet_thickness": as_sheet_thickness(sheet_thickness, open),
        }
        count = as_threads(threads)
        factor = as_positive(scale, "scale")
        with naming_file(mesh):
            vertices, faces = read_mesh(mesh)
            mesh = Mesh(vertices * factor, faces)

            def build() -> CoreModel:
                return CoreModel.build(*mesh, **settings, threads=count, progress=progress)

            def waiting() -> None:
                if progress is not None:
                    progress("waiting for another process", 0.0)

            if cache:
                core = open_cache().fetch(compute_key(mesh, settings), build, waiting)
            else:
                core = build()
        if sign == "auto":
            warn_of_faults(core, open)
        model = cls(core)
        if model.tolerance is not None:
            warn_of_accuracy(model.tolerance, model.field, model.accuracy)
        return model

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the model to a file, which :meth:`load` reads in milliseconds.

        The file appears whole or not at all, in place of one that had its name. The same model
        gives the same bytes.

        Args:
            path: Of the file; any name will do.

        Raises:
            FileAccessError: The file cannot be written: no such folder, no permission, disk full.
            InputTypeError: ``path`` is no path.

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
        self._core.save(as_path(path, "path"))

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Model:
        """Reads a model that :meth:`save` wrote.

        Whatever the file holds, a model that comes out is sound: its checksum is right, every index
        is in range and every number finite.

        Args:
            path: Of the file.

        Returns:
            The model, equal to the one that was saved in every bit.

        Raises:
            FileAccessError: The file cannot be read.
            ModelFileError: It is no model file, is damaged, or is of another version.
            MemoryLimitError: It is larger than 4 GiB or than the memory that can be had.
            InputTypeError: ``path`` is no path.

        Example:
            >>> import voxshell as vx
            >>> vx.Model.load("pyproject.toml")
            Traceback (most recent call last):
            voxshell.errors.ModelFileError: pyproject.toml: not a model file: it does not begin with the signature of one
        """
        return cls(CoreModel.load(as_path(path, "path")))

    def __reduce__(self) -> tuple[Callable[[bytes], Model], tuple[bytes]]:
        """Pickles as the bytes of a model file."""
        return _unpickle, (self._core.to_bytes(),)

    @property
    def mesh(self) -> Mesh:
        """The triangles: ``vertices, faces = model.mesh``, (n, 3) float64 and (m, 3) uint32."""
        return Mesh(self._core.vertices, self._core.faces)

    @property
    def field(self) -> DistanceField:
        """The signed distance field, which other bodies' points are tested against."""
        return self._field

    @property
    def shell(self) -> PointShell:
        """The points on the surface, which are tested against other bodies' fields."""
        return self._shell

    @property
    def bounds(self) -> NDArray[np.float64]:
        """Lower and upper corner of the mesh, (2, 3) float64, metres."""
        return np.array(self._core.bounds)

    @property
    def accuracy(self) -> Accuracy:
        """How exact the model is, measured on its surface when it was built.

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
        """Thickness of the body's thinnest walls, metres.

        The first percentile, by area, of the lengths of chords that begin on the surface, go
        straight in and leave through a face that is opposite to within 30 degrees; at most the
        shortest side of the bounds.

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
        """How far field and shell were allowed to be off the mesh, metres; None if uniform."""
        return self._core.tolerance or None

    def mass_properties(
        self, mass: float = 1.0, kind: Literal["solid", "surface"] = "solid"
    ) -> MassProperties:
        """Mass, centre of mass and inertia of the model as a uniform body.

        Args:
            mass: Kilograms.
            kind: "solid" for the volume that the mesh encloses, "surface" for a thin skin on it.

        Returns:
            In the mesh's frame and axes, the inertia about the centre of mass.

        Raises:
            SettingsError: ``mass`` is not above 0, or ``kind`` is another word.

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
        if kind == "solid":
            center, inertia = self._core.solid_mass_properties
        elif kind == "surface":
            center, inertia = self._core.surface_mass_properties
        else:
            raise SettingsError(f"kind must be 'solid' or 'surface', not {kind!r}")
        return MassProperties(kilograms, np.array(center), kilograms * np.array(inertia))

    def __repr__(self) -> str:
        x, y, z = self.field.shape
        return (
            f"Model({len(self._core.faces)} triangles, {len(self.shell)} points, "
            f"field {x} x {y} x {z}, voxel size {self.field.voxel_size:g} m, "
            f"{self.field.nbytes / 1e6:.1f} MB)"
        )

    def _repr_html_(self) -> str:
        """A table of facts, for notebooks."""
        x, y, z = self.field.shape
        size = " x ".join(f"{1e3 * side:.4g}" for side in np.ptp(self.bounds, axis=0))
        facts = {
            "size": f"{size} mm",
            "triangles": f"{len(self._core.faces):,}",
            "points of the shell": f"{len(self.shell):,}, {1e3 * self.shell.spacing:.3g} mm apart",
            "field": f"{x} x {y} x {z} nodes, {1e3 * self.field.voxel_size:.3g} mm apart, "
            f"{self.field.nbytes / 1e6:.1f} MB",
            "field off by": f"{1e3 * self.accuracy.distance.median:.3g} mm median, "
            f"{1e3 * self.accuracy.distance.max:.3g} mm worst",
        }
        return make_table("Model", facts)


def _unpickle(content: bytes) -> Model:
    return Model(CoreModel.from_bytes(content))
