"""Recordings as binary glTF 2.0: a node with a mesh and an animation for each body, and nodes for contacts."""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell.base.outputs import write_bytes
from voxshell.viewer.arrows import make_arrow
from voxshell.viewer.lanes import view_axes
from voxshell.viewer.marks import MarkedContacts
from voxshell.viewer.palette import FORCE_COLOR, choose_colors
from voxshell.viewer.pins import build_pin_mesh, color_depths
from voxshell.viewer.quaternions import as_steady, normals_as_wxyz, rotations_as_wxyz
from voxshell.viewer.shading import find_vertex_normals, is_faceted

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from numpy.typing import NDArray

    from voxshell.recording import BodyTrack, Recording

# Constants of the format.
_FLOAT, _UNSIGNED = 5126, 5125
_VERTICES, _INDICES = 34962, 34963
_TYPES = {1: "SCALAR", 3: "VEC3", 4: "VEC4"}
_MAGIC, _VERSION, _JSON_CHUNK, _BINARY_CHUNK = 0x46546C67, 2, 0x4E4F534A, 0x004E4942

_MOST_CONTACTS = 100
"""Of a frame: each is a node."""
_DEPTH_STEPS = 4
"""Colors of balls: animations move nodes, but do not change their colors."""


def save_gltf(path: Path, recording: Recording, *, up: str = "+z", contacts: bool = True) -> Path:
    """Write a recording as binary glTF; see :meth:`voxshell.recording.Recording.save_gltf`."""
    write_bytes(path, make_gltf(recording, up=up, contacts=contacts))
    return path


def make_gltf(recording: Recording, *, up: str = "+z", contacts: bool = True) -> bytes:
    """Return a recording as the bytes of a .glb file.

    Args:
        recording: The recording.
        up: The world axis that points up.
        contacts: Add balls at contacts, and arrows of their normal forces.

    Raises:
        SettingsError: ``up`` is not an axis.
    """
    right, forward, upward = view_axes(up)
    # In glTF, the view is along -z and +y points up.
    turn = np.stack([right, upward, -forward])
    data = _Data()
    nodes: list[dict[str, Any]] = [
        {
            "name": "recording",
            "rotation": _as_xyzw(turn[None])[0].tolist(),
            "children": list(range(1, len(recording.bodies) + 1)),
        }
    ]
    document: dict[str, Any] = {
        "asset": {"version": "2.0", "generator": "voxshell"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": nodes,
        "materials": [],
        "meshes": [],
    }
    channels: list[dict[str, Any]] = []
    samplers: list[dict[str, Any]] = []
    times = None
    meshes: dict[tuple[bytes, tuple[int, int, int]], int] = {}
    arrays: dict[bytes, dict[str, Any]] = {}
    for body, color in zip(recording.bodies, choose_colors(recording), strict=True):
        shape = body.vertices.tobytes() + body.faces.tobytes()
        if shape not in arrays:
            arrays[shape] = _add_surface(data, body)
        if (shape, color) not in meshes:
            meshes[shape, color] = len(document["meshes"])
            primitive = arrays[shape] | {"material": len(document["materials"])}
            document["meshes"].append({"name": body.name, "primitives": [primitive]})
            document["materials"].append(_describe_material(color))
        turns = as_steady(_as_xyzw(body.poses[:, :3, :3]))
        node = {
            "name": body.name,
            "mesh": meshes[shape, color],
            "translation": body.poses[0, :3, 3].tolist(),
            "rotation": turns[0].tolist(),
        }
        nodes.append(node)
        if body.start:
            node["scale"] = [0.0] * 3
            samplers.append(_appear(data, body.start * recording.time_step))
            target = {"node": len(nodes) - 1, "path": "scale"}
            channels.append({"sampler": len(samplers) - 1, "target": target})
        if body.fixed:
            continue
        if times is None:
            instants = np.arange(recording.frame_count) * recording.time_step
            times = data.add(instants.astype(np.float32), limits=True)
        for path, values in (("translation", body.poses[:, :3, 3]), ("rotation", turns)):
            samplers.append({"input": times, "output": data.add(values.astype(np.float32))})
            target = {"node": len(nodes) - 1, "path": path}
            channels.append({"sampler": len(samplers) - 1, "target": target})
    if contacts and recording.contacts.counts.any():
        animation = _Animation(document, data, channels, samplers, recording.time_step)
        _add_contacts(animation, MarkedContacts(recording, up=up, limit=_MOST_CONTACTS), recording)
        nodes[0]["children"] = list(range(1, len(nodes)))
    if channels:
        document["animations"] = [{"name": "recording", "channels": channels, "samplers": samplers}]
    return data.pack(document)


class _Data:
    """The arrays of a file, with their descriptions."""

    def __init__(self) -> None:
        self._parts: list[bytes] = []
        self._length = 0
        self._views: list[dict[str, Any]] = []
        self._accessors: list[dict[str, Any]] = []

    def add(self, array: NDArray[Any], *, target: int | None = None, limits: bool = False) -> int:
        """Append (n,) or (n, k) numbers of four bytes each; return the number of their accessor."""
        content = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<")).tobytes()
        view = {"buffer": 0, "byteOffset": self._length, "byteLength": len(content)}
        if target is not None:
            view["target"] = target
        self._views.append(view)
        self._parts.append(content)
        self._length += len(content)
        accessor: dict[str, Any] = {
            "bufferView": len(self._views) - 1,
            "componentType": _FLOAT if array.dtype.kind == "f" else _UNSIGNED,
            "count": len(array),
            "type": _TYPES[1 if array.ndim == 1 else array.shape[1]],
        }
        if limits:
            accessor["min"] = np.atleast_1d(array.min(axis=0)).tolist()
            accessor["max"] = np.atleast_1d(array.max(axis=0)).tolist()
        self._accessors.append(accessor)
        return len(self._accessors) - 1

    def pack(self, document: dict[str, Any]) -> bytes:
        """Return the whole file; the format requires arrays of multiples of four bytes."""
        binary = b"".join(self._parts)
        whole = document | {
            "buffers": [{"byteLength": len(binary)}],
            "bufferViews": self._views,
            "accessors": self._accessors,
        }
        text = json.dumps(whole, separators=(",", ":"), ensure_ascii=False).encode(errors="replace")
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<II", len(text), _JSON_CHUNK) + text
        chunks += struct.pack("<II", len(binary), _BINARY_CHUNK) + binary
        return struct.pack("<III", _MAGIC, _VERSION, 12 + len(chunks)) + chunks


def _add_surface(data: _Data, body: BodyTrack) -> dict[str, Any]:
    """Return the arrays of a body's surface, as a primitive without a material."""
    attributes = {
        "POSITION": data.add(body.vertices.astype(np.float32), target=_VERTICES, limits=True)
    }
    if not is_faceted(body.vertices, body.faces):
        # Without normals, viewers draw flat faces.
        normals = find_vertex_normals(body.vertices, body.faces)
        attributes["NORMAL"] = data.add(normals.astype(np.float32), target=_VERTICES)
    indices = data.add(body.faces.reshape(-1).astype(np.uint32), target=_INDICES)
    return {"attributes": attributes, "indices": indices}


def _appear(data: _Data, seconds: float) -> dict[str, Any]:
    """Return a sampler of a node's scale: 0 before a time, 1 from then on."""
    sizes = np.repeat([[0.0], [1.0]], 3, axis=1)
    return {
        "input": data.add(np.array([0.0, seconds], dtype=np.float32), limits=True),
        "output": data.add(sizes.astype(np.float32)),
        "interpolation": "STEP",
    }


@dataclass(frozen=True)
class _Animation:
    """What nodes that come and go are added to."""

    document: dict[str, Any]
    data: _Data
    channels: list[dict[str, Any]]
    samplers: list[dict[str, Any]]
    time_step: float

    def add_mesh(
        self,
        name: str,
        vertices: NDArray[np.float32],
        faces: NDArray[np.uint32],
        color: tuple[int, int, int],
    ) -> int:
        """Add a mesh and its material; return its number."""
        primitive = {
            "attributes": {"POSITION": self.data.add(vertices, target=_VERTICES, limits=True)},
            "indices": self.data.add(faces.reshape(-1), target=_INDICES),
            "material": len(self.document["materials"]),
        }
        self.document["materials"].append(_describe_material(color))
        self.document["meshes"].append({"name": name, "primitives": [primitive]})
        return len(self.document["meshes"]) - 1

    def add_slots(self, mesh: int, name: str, frames: Sequence[NDArray[np.float64]]) -> None:
        """Add nodes that show a mesh in as many places as a frame has, and are of size 0 in others.

        Args:
            mesh: The number of the mesh.
            name: Of the nodes.
            frames: For each, (k, 8): position, rotation (x, y, z, w) and size.
        """
        most = max(len(places) for places in frames)
        states = np.zeros((most, len(frames), 8))
        states[:, :, 6] = 1.0
        for number, places in enumerate(frames):
            states[: len(places), number] = places
        for slot, state in enumerate(states):
            node = {
                "name": f"{name} {slot + 1}",
                "mesh": mesh,
                "translation": state[0, :3].tolist(),
                "rotation": state[0, 3:7].tolist(),
                "scale": [state[0, 7]] * 3,
            }
            self.document["nodes"].append(node)
            changed = np.concatenate([[True], (state[1:] != state[:-1]).any(axis=1)])
            if changed.sum() > 1:
                self._move(np.flatnonzero(changed), state[changed])

    def _move(self, frames: NDArray[np.int64], state: NDArray[np.float64]) -> None:
        """Animate the last node: it jumps to each state in its frame."""
        times = self.data.add((frames * self.time_step).astype(np.float32), limits=True)
        values = {
            "translation": state[:, :3],
            "rotation": state[:, 3:7],
            "scale": np.repeat(state[:, 7:], 3, axis=1),
        }
        for path, value in values.items():
            if (value == value[0]).all():
                continue
            output = self.data.add(value.astype(np.float32))
            self.samplers.append({"input": times, "output": output, "interpolation": "STEP"})
            target = {"node": len(self.document["nodes"]) - 1, "path": path}
            self.channels.append({"sampler": len(self.samplers) - 1, "target": target})


def _add_contacts(animation: _Animation, marked: MarkedContacts, recording: Recording) -> None:
    """Add a node for each contact that a frame has at most: balls, and arrows."""
    frames = [marked.frame(number) for number in range(recording.frame_count)]
    steps = [
        np.clip((marks.fractions * _DEPTH_STEPS).astype(np.int64), 0, _DEPTH_STEPS - 1)
        for marks in frames
    ]
    vertices, faces = build_pin_mesh(marked.ball, stem=False)
    for step in range(_DEPTH_STEPS):
        places = [
            _as_places(marks.points[each == step])
            for marks, each in zip(frames, steps, strict=True)
        ]
        if not any(len(each) for each in places):
            continue
        red, green, blue = color_depths(np.array([(step + 0.5) / _DEPTH_STEPS]))[0].round()
        color = (int(red), int(green), int(blue))
        mesh = animation.add_mesh("contact", vertices, faces, color)
        animation.add_slots(mesh, "contact", places)
    arrows = [_as_arrows(marks.arrows) for marks in frames]
    if any(len(each) for each in arrows):
        vertices, faces = make_arrow()
        mesh = animation.add_mesh(
            "force", vertices.astype(np.float32), faces.astype(np.uint32), FORCE_COLOR
        )
        animation.add_slots(mesh, "force", arrows)


def _as_places(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (k, 8): places without a rotation, of size 1."""
    rest = np.tile((0.0, 0.0, 0.0, 1.0, 1.0), (len(points), 1))
    return np.concatenate([points, rest], axis=1)


def _as_arrows(arrows: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (m, 8): places that make of an arrow of length 1 along z those from start to tip."""
    ways = arrows[:, 1] - arrows[:, 0]
    lengths = np.linalg.norm(ways, axis=1, keepdims=True)
    turns = np.roll(normals_as_wxyz(ways / np.maximum(lengths, 1e-300)), -1, axis=1)
    return np.concatenate([arrows[:, 0], turns, lengths], axis=1)


def _describe_material(color: tuple[int, int, int]) -> dict[str, Any]:
    fraction = np.array(color) / 255.0
    light = np.where(fraction <= 0.04045, fraction / 12.92, ((fraction + 0.055) / 1.055) ** 2.4)
    return {
        "doubleSided": True,
        "pbrMetallicRoughness": {
            "baseColorFactor": [*light.tolist(), 1.0],
            "metallicFactor": 0.0,
            "roughnessFactor": 0.7,
        },
    }


def _as_xyzw(rotations: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.roll(rotations_as_wxyz(rotations), -1, axis=1)
