"""Scene files in TOML: bodies, joints and outputs as typed settings."""

from __future__ import annotations

import json
import re
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib.metadata import entry_points
from typing import TYPE_CHECKING, Any, TypeVar

from voxshell.base.settings import list_names, make, parse_toml, read_text
from voxshell.errors import MeshError, MissingFileError, PoseError, SettingsError, SimulationError
from voxshell.scenes.body_settings import BodySettings
from voxshell.scenes.joint_settings import JointSettings
from voxshell.scenes.scene_settings import MeshSettings, OutputSettings, WorldSettings
from voxshell.scenes.toml_lines import find_line

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

_NAME = re.compile(r"[A-Za-z0-9_-]+")
_TABLES = ("scene", "outputs", "meshes", "bodies", "joints")

Settings = TypeVar("Settings")


@dataclass(frozen=True)
class Scene:
    """A scene file after checks.

    Attributes:
        path: The file's path.
        text: The file's content.
        world, outputs: Its tables.
        meshes, bodies, joints: Its tables by name, in the order of the file.
    """

    path: Path
    text: str
    world: WorldSettings = field(default_factory=WorldSettings)
    outputs: OutputSettings = field(default_factory=OutputSettings)
    meshes: dict[str, MeshSettings] = field(default_factory=dict)
    bodies: dict[str, BodySettings] = field(default_factory=dict)
    joints: dict[str, JointSettings] = field(default_factory=dict)

    @property
    def title(self) -> str:
        """For people."""
        return self.world.title or self.path.stem

    def describe_error(self, keys: tuple[str, ...], message: str) -> SettingsError:
        """Return an error that names file, line and key."""
        return _locate(self.path, self.text, keys, f"{'.'.join(keys)}: {message}")

    @contextmanager
    def naming(self, *keys: str) -> Iterator[None]:
        """Prefix errors of the block with the file, line and key of a table.

        Raises:
            SettingsError: The block raised an error of a mesh, a missing file, a pose, settings or a
                simulation.
        """
        try:
            yield
        except (MeshError, MissingFileError, PoseError, SettingsError, SimulationError) as error:
            raise self.describe_error(keys, str(error)) from error


def read_scene(path: Path) -> Scene:
    """Read and check a scene file.

    Raises:
        MissingFileError: The file does not exist.
        SettingsError: The file is not TOML, or has an invalid setting. The message names file, line
            and key.
    """
    try:
        text = read_text(path, "scene file")
    except UnicodeDecodeError:
        raise SettingsError(
            f"{path} is not a scene file, which is TOML text; {_for_meshes(path)}"
        ) from None
    except SettingsError as error:  # it is too large
        if path.suffix.lower() == ".toml":
            raise
        raise SettingsError(f"{error}; {_for_meshes(path)}") from None
    try:
        tables = parse_toml(text)
    except SettingsError as error:
        line = re.search(r"at line (\d+)", str(error))
        hint = "" if path.suffix.lower() == ".toml" else f"; {_for_meshes(path)}"
        raise SettingsError(f"{path}{f':{line[1]}' if line else ''}: {error}{hint}") from None
    try:
        return _make_scene(path, text, tables)
    except SettingsError as error:
        # Errors about a key begin with its name.
        keys = str(error).partition(" ")[0].partition("[")[0].rstrip(":").split(".")
        raise _locate(path, text, tuple(keys), str(error)) from None


def _for_meshes(path: Path) -> str:
    """Return what to do with a mesh, which people take for a scene: a scene that it falls in."""
    # The studies, a package of their own, add this command.
    drop = (
        f"use voxshell simulate drop {path}, or " if entry_points(group="voxshell.commands") else ""
    )
    lines = (
        "[meshes.part]",
        f"file = {json.dumps(str(path), ensure_ascii=False)}",  # as TOML writes texts
        "[bodies]",
        'part = { mesh = "part", mass = 1.0, position = [0.0, 0.0, 0.3] }',
        'ground = { shape = "plane" }',
    )
    return (
        f"if it is a mesh, {drop}write a file scene.toml and run voxshell simulate scene.toml --out result; it "
        "needs these five lines, separated by |, and scale = 0.001 after the second for a mesh in millimeters: "
        f"{' | '.join(lines)}"
    )


def _make_scene(path: Path, text: str, tables: dict[str, Any]) -> Scene:
    for name, table in tables.items():
        if name not in _TABLES:
            raise SettingsError(f"{name[:80]}: unknown table; valid tables: {', '.join(_TABLES)}")
        if not isinstance(table, dict):
            raise SettingsError(f"{name} must be a table, [{name}]")
    scene = Scene(
        path,
        text,
        world=make(WorldSettings, tables.get("scene", {}), "scene"),
        outputs=make(OutputSettings, tables.get("outputs", {}), "outputs"),
        meshes=_read_named(MeshSettings, tables, "meshes"),
        bodies=_read_named(BodySettings, tables, "bodies"),
        joints=_read_named(JointSettings, tables, "joints"),
    )
    if not scene.bodies:
        raise SettingsError("bodies must contain at least one body: [bodies.NAME]")
    for name, body in scene.bodies.items():
        parts = {f"parts[{index}].": part for index, part in enumerate(body.parts)}
        for place, part in {"": body, **parts}.items():
            if part.mesh is not None and part.mesh not in scene.meshes:
                known = list_names(scene.meshes)
                raise SettingsError(
                    f"bodies.{name}.{place}mesh is {part.mesh!r}, but the scene has "
                    + (f"only the meshes {known}" if known else "no [meshes.NAME]")
                )
    for name, joint in scene.joints.items():
        _check_joint(scene, name, joint)
    return scene


def _check_joint(scene: Scene, name: str, joint: JointSettings) -> None:
    """Check that a joint's bodies exist, and that one of them can move."""
    for key in ("parent", "child"):
        body = getattr(joint, key)
        if body is not None and body not in scene.bodies:
            raise SettingsError(
                f"joints.{name}.{key} is {body!r}, but the scene has only the bodies {list_names(scene.bodies)}"
            )
    if joint.parent == joint.child:
        raise SettingsError(f"joints.{name}.parent must not be the child itself")
    bodies = [scene.bodies[each] for each in (joint.parent, joint.child) if each is not None]
    if all(body.kilograms == 0.0 for body in bodies):
        raise SettingsError(f"joints.{name}.child must be a body that moves, or its parent")


def _read_named(kind: type[Settings], tables: dict[str, Any], name: str) -> dict[str, Settings]:
    """Return the settings of all tables [name.KEY], by key."""
    found = {}
    for key, table in tables.get(name, {}).items():
        if not _NAME.fullmatch(key):
            raise SettingsError(f"{name} must have names of letters, digits, _ and -, not {key!r}")
        if not isinstance(table, dict):
            raise SettingsError(f"{name}.{key} must be a table, [{name}.{key}]")
        found[key] = make(kind, table, f"{name}.{key}")
    return found


def _locate(path: Path, text: str, keys: tuple[str, ...], message: str) -> SettingsError:
    return SettingsError(f"{path}:{find_line(text, keys)}: {message}")
