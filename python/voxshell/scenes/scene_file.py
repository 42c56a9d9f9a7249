"""Scene files: bodies and what to write down of them, as typed settings from TOML."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, TypeVar

import numpy as np

from voxshell._arguments import as_integer, as_positive, as_real
from voxshell._settings import make, parse_toml
from voxshell.errors import SettingsError
from voxshell.scenes.toml_lines import find_line

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

_NAME = re.compile(r"[A-Za-z0-9_-]+")
_UNIT_TOLERANCE = 1e-3
_MOST_FRAMES = 1_000_000
_TABLES = ("scene", "outputs", "meshes", "bodies")

Settings = TypeVar("Settings")


@dataclass(frozen=True)
class WorldSettings:
    """The table ``[scene]``: the world and how long it runs. As for :class:`voxshell.World`.

    Attributes:
        title: Of the replay; the file's name by default.
        duration: Simulated seconds.
        rate: Steps a second.
        gravity: Three numbers, m/s2.
        contact, level, solver, iterations, sleeping, sweep_beyond: As for the world.
    """

    title: str = ""
    duration: float = 2.0
    rate: float = 200.0
    gravity: tuple[float, ...] = (0.0, 0.0, -9.81)
    contact: Literal["auto", "regular", "segmented"] = "auto"
    level: int | None = None
    solver: Literal["sequential_impulse", "nncg", "dantzig", "projected_gauss_seidel"] = (
        "sequential_impulse"
    )
    iterations: int = 50
    sleeping: bool = True
    sweep_beyond: float | None = None

    def __post_init__(self) -> None:
        as_positive(self.duration, "duration")
        as_positive(self.rate, "rate")
        if self.duration * self.rate > _MOST_FRAMES:
            raise SettingsError(
                f"duration must be at most {_MOST_FRAMES / self.rate:g} s at {self.rate:g} steps a "
                f"second, not {self.duration:g}"
            )
        _check_vector(self.gravity, "gravity")
        as_integer(self.iterations, "iterations", 1, 1_000_000)
        if self.level is not None:
            as_integer(self.level, "level", 1, 12)
            if self.contact == "regular":
                raise SettingsError(
                    "level is for segmented contacts; leave it out or change contact"
                )
        if self.sweep_beyond is not None and not self.sweep_beyond >= 0.0:
            raise SettingsError(f"sweep_beyond must be at least 0, not {self.sweep_beyond:g}")

    @property
    def steps(self) -> int:
        """How many, at least one."""
        return max(round(self.duration * self.rate), 1)


@dataclass(frozen=True)
class OutputSettings:
    """The table ``[outputs]``: what to write.

    Attributes:
        replay: Whether to write index.html, an offline page.
        plot: Whether to write plot.png: heights, speeds and contacts over time.
        poses, contacts: In which form the tables of that name are written.
        every: Steps between two frames that are taken down.
    """

    replay: bool = True
    plot: bool = True
    poses: Literal["parquet", "csv", "none"] = "parquet"
    contacts: Literal["parquet", "csv", "none"] = "parquet"
    every: int = 1

    def __post_init__(self) -> None:
        as_integer(self.every, "every", 1, _MOST_FRAMES)


@dataclass(frozen=True)
class MeshSettings:
    """A table ``[meshes.NAME]``: a mesh, and what Bullet makes of it.

    Attributes:
        file: Path, from the folder of the scene file.
        collide_as: "model", voxshell's; or Bullet's GImpact, or the convex hull.
        scale: Factor that brings the mesh to metres.
        voxel_size, resolution, point_spacing, target_points, sign: As for
            :meth:`voxshell.Model.from_mesh`; for models alone.
    """

    file: str
    collide_as: Literal["model", "gimpact", "hull"] = "model"
    scale: float = 1.0
    voxel_size: float | None = None
    resolution: int | None = None
    point_spacing: float | None = None
    target_points: int | None = None
    sign: Literal["auto", "closed", "winding"] = "auto"

    def __post_init__(self) -> None:
        if not self.file:
            raise SettingsError("file must name a mesh")
        as_positive(self.scale, "scale")
        for one, other in (("voxel_size", "resolution"), ("point_spacing", "target_points")):
            if getattr(self, one) is not None and getattr(self, other) is not None:
                raise SettingsError(f"{other} and {one} cannot both be given")
        for name in ("voxel_size", "point_spacing"):
            if getattr(self, name) is not None:
                as_positive(getattr(self, name), name)
        for name, least in (("resolution", 2), ("target_points", 1)):
            if getattr(self, name) is not None:
                as_integer(getattr(self, name), name, least, 2**31 - 1)


@dataclass(frozen=True)
class BodySettings:
    """A table ``[bodies.NAME]``: a body, made of a mesh or a shape.

    Attributes:
        mesh: Name of a table of ``[meshes]``; or
        shape: one of these, with its numbers:
        normal, offset: Of a plane; offset in metres.
        half_extents: Of a box, three numbers, metres.
        radius: Of a sphere, capsule, cylinder or cone, metres.
        length: Of a capsule, without its caps, or a cylinder, metres.
        height: Of a cone, metres.
        mass: Kilograms; 0: static. A plane has none.
        inertia: Of the solid, or of a skin on the surface.
        friction, restitution: As for :meth:`voxshell.World.add`.
        position: Of the body's origin, three numbers, metres.
        quaternion_xyzw: Its orientation, of unit length; or
        rotation_vector: axis times angle, radians.
        linear_velocity, angular_velocity: At the start, m/s and rad/s.
        color: Red, green and blue, 0 to 255, in the replay.
    """

    mesh: str | None = None
    shape: Literal["plane", "box", "sphere"] | None = None
    normal: tuple[float, ...] | None = None
    offset: float | None = None
    half_extents: tuple[float, ...] | None = None
    radius: float | None = None
    mass: float | None = None
    inertia: Literal["solid", "surface"] = "solid"
    friction: float = 0.5
    restitution: float = 0.0
    position: tuple[float, ...] = (0.0, 0.0, 0.0)
    quaternion_xyzw: tuple[float, ...] | None = None
    rotation_vector: tuple[float, ...] | None = None
    linear_velocity: tuple[float, ...] = (0.0, 0.0, 0.0)
    angular_velocity: tuple[float, ...] = (0.0, 0.0, 0.0)
    color: tuple[int, ...] | None = None

    def __post_init__(self) -> None:
        if (self.mesh is None) == (self.shape is None):
            raise SettingsError("shape or mesh must be given, one of the two")
        self._check_shape()
        if self.mass is not None and not as_real(self.mass, "mass") >= 0.0:
            raise SettingsError(f"mass must be at least 0 kg (0: static), not {self.mass:g}")
        if self.shape == "plane" and self.mass:
            raise SettingsError("mass of a plane must be 0: it has no end and cannot move")
        if not as_real(self.friction, "friction") >= 0.0:
            raise SettingsError(f"friction must be at least 0, not {self.friction:g}")
        if not 0.0 <= as_real(self.restitution, "restitution") <= 1.0:
            raise SettingsError(f"restitution must be from 0 to 1, not {self.restitution:g}")
        for name in ("position", "linear_velocity", "angular_velocity"):
            _check_vector(getattr(self, name), name)
        if self.rotation_vector is not None:
            if self.quaternion_xyzw is not None:
                raise SettingsError("rotation_vector and quaternion_xyzw cannot both be given")
            _check_vector(self.rotation_vector, "rotation_vector")
        if self.quaternion_xyzw is not None:
            _check_vector(self.quaternion_xyzw, "quaternion_xyzw", 4)
            length = math.hypot(*self.quaternion_xyzw)
            if abs(length - 1.0) > _UNIT_TOLERANCE:
                raise SettingsError(f"quaternion_xyzw must have length 1, not {length:.6g}")
        if self.color is not None and not (
            len(self.color) == 3 and all(0 <= channel <= 255 for channel in self.color)
        ):
            raise SettingsError(f"color must be three integers from 0 to 255, not {self.color}")

    @property
    def kilograms(self) -> float:
        """The mass: 1 kg by default, none of a plane."""
        if self.mass is not None:
            return self.mass
        return 0.0 if self.shape == "plane" else 1.0

    @property
    def pose(self) -> NDArray[np.float64]:
        """``world_from_body`` at the start, (4, 4)."""
        from trimesh.transformations import quaternion_matrix, rotation_matrix

        pose: NDArray[np.float64] = np.eye(4)
        if self.quaternion_xyzw is not None:
            x, y, z, w = self.quaternion_xyzw
            pose = quaternion_matrix([w, x, y, z])
        elif self.rotation_vector is not None and any(self.rotation_vector):
            pose = rotation_matrix(math.hypot(*self.rotation_vector), self.rotation_vector)
        pose[:3, 3] = self.position
        return pose

    def _check_shape(self) -> None:
        """Whether the numbers given are those of the shape, and in range."""
        takes = {
            None: (),
            "plane": ("normal", "offset"),
            "box": ("half_extents",),
            "sphere": ("radius",),
        }[self.shape]
        what = "a mesh" if self.shape is None else f"a {self.shape}"
        for name in ("normal", "offset", "half_extents", "radius"):
            value = getattr(self, name)
            if value is not None and name not in takes:
                raise SettingsError(f"{name} is nothing that {what} has")
            if value is None and name in takes and self.shape != "plane":
                raise SettingsError(f"{name} must be given for {what}")
        if self.normal is not None:
            _check_vector(self.normal, "normal")
            if not any(self.normal):
                raise SettingsError("normal must have a length above 0")
        if self.half_extents is not None:
            _check_vector(self.half_extents, "half_extents")
            if min(self.half_extents) <= 0.0:
                raise SettingsError(f"half_extents must be above 0, not {list(self.half_extents)}")
        if self.offset is not None:
            as_real(self.offset, "offset")
        if self.radius is not None:
            as_positive(self.radius, "radius")


@dataclass(frozen=True)
class Scene:
    """A scene file, read and checked.

    Attributes:
        path: Of the file.
        text: What it holds.
        world, outputs: Its tables.
        meshes, bodies: Its tables by name, in the file's order.
    """

    path: Path
    text: str
    world: WorldSettings = field(default_factory=WorldSettings)
    outputs: OutputSettings = field(default_factory=OutputSettings)
    meshes: dict[str, MeshSettings] = field(default_factory=dict)
    bodies: dict[str, BodySettings] = field(default_factory=dict)

    @property
    def title(self) -> str:
        """For people."""
        return self.world.title or self.path.stem

    def describe_error(self, keys: tuple[str, ...], message: str) -> SettingsError:
        """An error that names file, line and key."""
        return _locate(self.path, self.text, keys, f"{'.'.join(keys)}: {message}")


def read_scene(path: Path) -> Scene:
    """Reads and checks a scene file.

    Raises:
        SettingsError: It is not there or no TOML, or something in it is wrong: the message names file,
            line and key.
    """
    try:
        text = path.read_text(encoding="utf-8")
        tables = parse_toml(text)
    except (FileNotFoundError, IsADirectoryError):
        raise SettingsError(f"there is no scene file {path}") from None
    except (SettingsError, UnicodeDecodeError) as error:
        line = re.search(r"at line (\d+)", str(error))
        raise SettingsError(f"{path}{f':{line[1]}' if line else ''}: {error}") from None
    try:
        return _make_scene(path, text, tables)
    except SettingsError as error:
        # What is wrong with a key begins with its name.
        keys = str(error).partition(" ")[0].partition("[")[0].split(".")
        raise _locate(path, text, tuple(keys), str(error)) from None


def _make_scene(path: Path, text: str, tables: dict[str, Any]) -> Scene:
    for name, table in tables.items():
        if name not in _TABLES:
            raise SettingsError(f"{name} is no table of a scene; there are: {', '.join(_TABLES)}")
        if not isinstance(table, dict):
            raise SettingsError(f"{name} must be a table, [{name}]")
    scene = Scene(
        path,
        text,
        world=make(WorldSettings, tables.get("scene", {}), "scene"),
        outputs=make(OutputSettings, tables.get("outputs", {}), "outputs"),
        meshes=_read_named(MeshSettings, tables, "meshes"),
        bodies=_read_named(BodySettings, tables, "bodies"),
    )
    if not scene.bodies:
        raise SettingsError("bodies must hold a body at least: [bodies.NAME]")
    for name, body in scene.bodies.items():
        if body.mesh is not None and body.mesh not in scene.meshes:
            known = ", ".join(scene.meshes) or "none"
            raise SettingsError(
                f"bodies.{name}.mesh is {body.mesh!r}, which is not in [meshes]; there are: {known}"
            )
    return scene


def _read_named(kind: type[Settings], tables: dict[str, Any], name: str) -> dict[str, Settings]:
    """The settings of tables [name.KEY], by key."""
    found = {}
    for key, table in tables.get(name, {}).items():
        if not _NAME.fullmatch(key):
            raise SettingsError(f"{name} must have names of letters, digits, _ and -, not {key!r}")
        if not isinstance(table, dict):
            raise SettingsError(f"{name}.{key} must be a table, [{name}.{key}]")
        found[key] = make(kind, table, f"{name}.{key}")
    return found


def _check_vector(value: tuple[float, ...], name: str, count: int = 3) -> None:
    if len(value) != count or not all(map(math.isfinite, value)):
        raise SettingsError(f"{name} must be {count} finite numbers, not {list(value)}")


def _locate(path: Path, text: str, keys: tuple[str, ...], message: str) -> SettingsError:
    return SettingsError(f"{path}:{find_line(text, keys)}: {message}")
