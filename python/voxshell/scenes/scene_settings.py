"""Settings of a scene file's world, outputs and meshes."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from voxshell.base.arguments import as_integer, as_length, as_positive
from voxshell.errors import SettingsError
from voxshell.model.build_settings import as_sheet_thickness

MOST_FRAMES = 1_000_000
"""Largest number of steps in a scene."""


@dataclass(frozen=True)
class WorldSettings:
    """The table ``[scene]``: settings of :class:`voxshell.World` and the duration of the run.

    Attributes:
        title: Title of the replay; the file's name by default.
        duration: Simulated seconds.
        rate: Steps per second.
        gravity: Three numbers, m/s2.
        contact, shell, level, solver, iterations, sleeping, ccd_motion_threshold: As for the world.
    """

    title: str = ""
    duration: float = 2.0
    rate: float = 200.0
    gravity: tuple[float, ...] = (0.0, 0.0, -9.81)
    contact: Literal["auto", "regular", "segmented"] = "auto"
    shell: Literal["auto", "fewest"] = "auto"
    level: int | None = None
    solver: Literal[
        "coulomb", "sequential_impulse", "nncg", "dantzig", "projected_gauss_seidel"
    ] = "coulomb"
    iterations: int | None = None
    sleeping: bool = True
    ccd_motion_threshold: float | None = None

    def __post_init__(self) -> None:
        as_positive(self.duration, "duration")
        as_positive(self.rate, "rate")
        if self.duration * self.rate > MOST_FRAMES:
            raise SettingsError(
                f"duration must be at most {MOST_FRAMES / self.rate:g} s at {self.rate:g} steps a "
                f"second, not {self.duration:g}"
            )
        check_vector(self.gravity, "gravity")
        if self.iterations is not None:
            as_integer(self.iterations, "iterations", 1, 1_000_000)
        if self.level is not None:
            as_integer(self.level, "level", 1, 12)
            if self.contact == "regular":
                raise SettingsError(
                    'level has no effect with contact = "regular"; leave it out, or write "segmented"'
                )
        if self.ccd_motion_threshold is not None and not self.ccd_motion_threshold >= 0.0:
            raise SettingsError(
                f"ccd_motion_threshold must be at least 0, not {self.ccd_motion_threshold:g}"
            )

    @property
    def steps(self) -> int:
        """Number of steps, at least one."""
        return max(round(self.duration * self.rate), 1)


@dataclass(frozen=True)
class OutputSettings:
    """The table ``[outputs]``: the files to write.

    Attributes:
        replay: Write index.html, an offline page.
        plot: Write plot.png: heights, speeds and contacts over time.
        poses, contacts: File formats of the tables of these names.
        exports: Files for other programs: recording.mp4 and recording.gif are videos, recording.glb
            is glTF, recording.usda and recording.usdc are Universal Scene Description.
        every: Number of steps between recorded frames.
    """

    replay: bool = True
    plot: bool = True
    poses: Literal["parquet", "csv", "none"] = "parquet"
    contacts: Literal["parquet", "csv", "none"] = "parquet"
    exports: tuple[Literal["mp4", "gif", "glb", "usda", "usdc"], ...] = ()
    every: int = 1

    def __post_init__(self) -> None:
        as_integer(self.every, "every", 1, MOST_FRAMES)


@dataclass(frozen=True)
class MeshSettings:
    """A table ``[meshes.NAME]``: a mesh, and how it collides.

    Attributes:
        file: Path, relative to the folder of the scene file.
        collide_as: "model" for voxshell's model, or Bullet's GImpact, or the convex hull.
        scale: Factor that converts the mesh to meters; as for :meth:`voxshell.Model.from_mesh`.
        tolerance, voxel_size, resolution, point_spacing, target_points, sign, open,
            sheet_thickness: As for :meth:`voxshell.Model.from_mesh`; only for models.
    """

    file: str
    collide_as: Literal["model", "gimpact", "hull"] = "model"
    scale: float | None = None
    tolerance: float | None = None
    voxel_size: float | None = None
    resolution: int | None = None
    point_spacing: float | None = None
    target_points: int | None = None
    sign: Literal["auto", "closed", "winding"] = "auto"
    open: Literal["auto", "solid", "sheet"] = "auto"
    sheet_thickness: float | None = None

    def __post_init__(self) -> None:
        if not self.file:
            raise SettingsError("file must name a mesh")
        if self.scale is not None:
            as_positive(self.scale, "scale")
        sizes = ("voxel_size", "resolution", "point_spacing", "target_points")
        pairs = (
            *zip(sizes[::2], sizes[1::2], strict=True),
            *((size, "tolerance") for size in sizes),
        )
        for one, other in pairs:
            if getattr(self, one) is not None and getattr(self, other) is not None:
                raise SettingsError(f"{other} and {one} cannot both be given")
        for name in ("tolerance", "voxel_size", "point_spacing"):
            if getattr(self, name) is not None:
                as_length(getattr(self, name), name)
        as_sheet_thickness(self.sheet_thickness, self.open)
        for name, least in (("resolution", 2), ("target_points", 1)):
            if getattr(self, name) is not None:
                as_integer(getattr(self, name), name, least, 2**31 - 1)


def check_vector(value: tuple[float, ...], name: str, count: int = 3) -> None:
    """Refuse a vector that does not have the right number of finite numbers.

    Raises:
        SettingsError: It does not; the message begins with the name.
    """
    if len(value) != count or not all(map(math.isfinite, value)):
        raise SettingsError(f"{name} must be {count} finite numbers, not {list(value)}")
