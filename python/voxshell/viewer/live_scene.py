"""The scene of a live view: bodies, grounds, contacts, forces and springs on a viser server."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell.model.shapes import Plane
from voxshell.recording import ContactTrack
from voxshell.simulation.body_shapes import mesh_of
from voxshell.viewer.arrows import add_arrows, find_arrows, place_arrows
from voxshell.viewer.grid import DROP, add_grid
from voxshell.viewer.palette import (
    BODY_COLORS,
    FIXED_COLOR,
    FLOOR_COLOR,
    FORCE_COLOR,
    PULL_COLOR,
)
from voxshell.viewer.pins import LEAST_DEPTH, as_light, build_pins
from voxshell.viewer.quaternions import normals_as_wxyz, rotations_as_wxyz
from voxshell.viewer.shading import split_creases
from voxshell.viewer.stage import nice_length

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    import viser
    from numpy.typing import NDArray

    from voxshell.model.meshes import Mesh
    from voxshell.simulation.body import Body
    from voxshell.simulation.live_frame import LiveFrame

    Grab = Callable[[Body, "viser.SceneNodeDragEvent[Any]"], None]

_DIAGONAL = 6.0
"""Diagonal of the first view in display units; it suits viser's clipping planes and shadows."""
_MOST_CONTACTS = 400
_GRAIN = 2.0**-13
_BALL = 0.012
"""Radius of a contact's ball, in diameters of a typical body."""
_LONGEST_ARROW = 1.0
"""Length of the longest arrow, in diameters of a typical body; its weight has a quarter of that."""
_ARROWS_A_WEIGHT = 0.25
_OPACITY = 0.55
"""Opacity of transparent bodies, which do not hide contacts."""
_GROUND_SIDE = 8.0
"""Side of a drawn plane, in diagonals of the first view; it fades out halfway from its center."""


@dataclass(frozen=True, eq=False)
class Extent:
    """The extent of the visible scene, in meters.

    Args:
        low: (3,) lower corner of a box around it, world frame.
        high: (3,) upper corner.
        body: Diameter of a typical moving body.
    """

    low: NDArray[np.float64]
    high: NDArray[np.float64]
    body: float


@dataclass(eq=False)
class _Group:
    """Bodies of one shape and motion, which are instances of one node.

    Args:
        node: The node in the scene.
        bodies: The bodies in the order of the instances.
        places: Their indices in a frame.
    """

    node: Any
    bodies: tuple[Body, ...]
    places: list[int]


class LiveScene:
    """Nodes that follow a world.

    Args:
        scene: The scene that contains them.
        colors: Colors of bodies, 0 to 255; the other bodies get default colors.
        on_drag: Called in viser's event loop, in order, while somebody drags a dynamic body.
    """

    def __init__(
        self,
        scene: viser.SceneApi,
        colors: Mapping[Body, tuple[int, int, int]],
        on_drag: Grab,
    ) -> None:
        self._scene, self._colors, self._on_drag = scene, colors, on_drag
        self._meshes: dict[int, tuple[object, Mesh]] = {}
        self._groups: dict[tuple[int, str], _Group] = {}
        self._grounds: dict[Body, Any] = {}
        self._movers: dict[Body, int] = {}  # in the order of their colors, as in a replay
        self._extras: dict[str, Any] = {}
        self._deepest = 0.0
        self._opacity: float | None = _OPACITY
        self.scale: float = 1.0
        """Display units per meter."""
        self.weight: float = 0.0
        """Weight of a typical dynamic body in standard gravity, newtons."""
        self.extent: Extent | None = None
        """Extent of the first frame with a body other than a plane; None before."""

    @property
    def deepest(self) -> float:
        """Depth of the darkest color, meters: the largest so far, rounded up, or a minimum."""
        if self._deepest == 0.0 or self.extent is None:
            return 0.0
        return nice_length(max(self._deepest, LEAST_DEPTH * self.extent.body))

    @property
    def longest_force(self) -> float:
        """Force above which arrows do not grow, newtons."""
        return self.weight * _LONGEST_ARROW / _ARROWS_A_WEIGHT

    def show(self, frame: LiveFrame, lines: NDArray[np.float64]) -> None:
        """Update all nodes to a frame.

        Args:
            frame: State of the world.
            lines: (k, 2, 3) meters, world frame: springs that pull.
        """
        if self.extent is None:
            self._begin(frame)
        if self.extent is None:
            return
        self._show_bodies(frame)
        self._show_contacts(frame)
        self._show_arrows("forces", self._find_arrows(frame), FORCE_COLOR)
        self._show_arrows("pulls", lines * self.scale, PULL_COLOR)

    def set_see_through(self, on: bool) -> None:
        """Draw bodies transparent, so that contacts in and under them are visible, or solid."""
        self._opacity = _OPACITY if on else None
        for group in list(self._groups.values()):
            group.node.opacity = self._opacity

    def find_extent(self, frame: LiveFrame) -> Extent | None:
        """Return the box around all bodies except planes, and planes below it; None if empty."""
        boxes, diameters = [], []
        for body, pose in zip(frame.bodies, frame.poses, strict=True):
            if isinstance(body.shape, Plane):
                continue
            vertices = self.mesh(body).vertices
            low, high = vertices.min(axis=0), vertices.max(axis=0)
            corners = np.where(np.indices((2, 2, 2)).reshape(3, 8).T, high, low)
            placed = corners @ pose[:3, :3].T + pose[:3, 3]
            boxes.append((placed.min(axis=0), placed.max(axis=0), body.motion == "static"))
            diameters.append((float(np.linalg.norm(high - low)), body.motion == "static"))
        if not boxes:
            return None
        moving = [box for box in boxes if not box[2]] or boxes
        low = np.min([box[0] for box in moving], axis=0)
        high = np.max([box[1] for box in moving], axis=0)
        size = float(np.linalg.norm(high - low))
        sizes = [size for size, is_static in diameters if not is_static]
        typical = float(np.median(sizes or [size for size, _ in diameters]))
        for box_low, box_high, _ in boxes:
            if np.linalg.norm(np.maximum(high, box_high) - np.minimum(low, box_low)) < 4.0 * size:
                low, high = np.minimum(low, box_low), np.maximum(high, box_high)
        for body, pose in zip(frame.bodies, frame.poses, strict=True):
            if isinstance(body.shape, Plane):
                foot = _foot(body.shape, pose, 0.5 * (low + high))
                if np.linalg.norm(foot - 0.5 * (low + high)) < 4.0 * size:
                    low, high = np.minimum(low, foot), np.maximum(high, foot)
        return Extent(low, high, typical)

    def mesh(self, body: Body) -> Mesh:
        """Return the surface of a body in its own frame, meters; it is computed once per shape."""
        key = id(body.shape)
        if key not in self._meshes:
            self._meshes[key] = (body.shape, mesh_of(body.shape))  # storing the shape keeps its id
        return self._meshes[key][1]

    def _begin(self, frame: LiveFrame) -> None:
        self.extent = self.find_extent(frame)
        if self.extent is None:
            return
        self.scale = _DIAGONAL / float(np.linalg.norm(self.extent.high - self.extent.low))
        masses = [body.mass for body in frame.bodies if body.motion == "dynamic"]
        self.weight = 9.81 * float(np.median(masses or [1.0]))

    def _show_bodies(self, frame: LiveFrame) -> None:
        members: dict[tuple[int, str], list[int]] = {}
        for index, body in enumerate(frame.bodies):
            if body.motion != "static":
                self._movers.setdefault(body, len(self._movers))
            if not isinstance(body.shape, Plane):
                members.setdefault((id(body.shape), body.motion), []).append(index)
            elif body not in self._grounds:
                self._grounds[body] = self._add_ground(body, frame.poses[index])
        for key in self._groups.keys() - members.keys():
            self._groups.pop(key).node.remove()
        for body in self._grounds.keys() - set(frame.bodies):
            self._grounds.pop(body).remove()
        turns = rotations_as_wxyz(frame.poses[:, :3, :3]).astype(np.float32)
        positions = (frame.poses[:, :3, 3] * self.scale).astype(np.float32)
        for key, places in members.items():
            bodies = tuple(frame.bodies[place] for place in places)
            if key not in self._groups:
                node = self._add_group(bodies, turns[places], positions[places])
                self._groups[key] = _Group(node, bodies, places)
                continue
            group = self._groups[key]
            # Bodies at rest are not sent again: viser does not send what has not changed.
            group.node.batched_positions = positions[places]
            group.node.batched_wxyzs = turns[places]
            if group.bodies != bodies:
                group.node.batched_colors = self._choose_colors(bodies)
            group.bodies, group.places = bodies, places

    def _add_group(
        self, bodies: tuple[Body, ...], turns: NDArray[np.float32], positions: NDArray[np.float32]
    ) -> Any:
        first = bodies[0]
        mesh = self.mesh(first)
        vertices, faces = split_creases(mesh.vertices, mesh.faces.astype(np.int64))
        node = self._scene.add_batched_meshes_simple(
            f"/bodies/{first.motion} {first.number}",
            (vertices * self.scale).astype(np.float32),
            faces.astype(np.uint32),
            turns,
            positions,
            batched_colors=self._choose_colors(bodies),
            opacity=self._opacity,
            lod="off",
            side="double",
        )
        if first.motion == "dynamic":
            key = (id(first.shape), first.motion)

            # viser keeps the order of the mouse's events only for coroutines.
            @node.on_drag
            async def _(event: viser.SceneNodeDragEvent[Any]) -> None:
                group = self._groups.get(key)
                index = event.instance_index or 0
                if group is not None and index < len(group.bodies):
                    self._on_drag(group.bodies[index], event)

        return node

    def _choose_colors(self, bodies: tuple[Body, ...]) -> NDArray[np.uint8]:
        chosen = [
            self._colors.get(body)
            or (
                FIXED_COLOR
                if body.motion == "static"
                else BODY_COLORS[self._movers[body] % len(BODY_COLORS)]
            )
            for body in bodies
        ]
        return as_light(np.array(chosen, np.float64))

    def _add_ground(self, body: Body, pose: NDArray[np.float64]) -> Any:
        """Add a plane as a floor with a grid, below the center of the scene."""
        assert self.extent is not None
        assert isinstance(body.shape, Plane)
        middle = 0.5 * (self.extent.low + self.extent.high)
        normal = pose[:3, :3] @ body.shape.normal
        side = _GROUND_SIDE * _DIAGONAL
        cell = self.cell * self.scale
        place = np.round(_foot(body.shape, pose, middle) * self.scale / cell) * cell
        place += normal * (normal @ (_foot(body.shape, pose, middle) * self.scale - place) - DROP)
        frame = self._scene.add_frame(
            f"/bodies/plane {body.number}",
            show_axes=False,
            position=place,
            wxyz=normals_as_wxyz(normal[None])[0],
        )
        color = self._colors.get(body, FLOOR_COLOR)
        size, fade = (side, side), 0.5 * side
        add_grid(
            self._scene, f"{frame.name}/grid", size=size, cell=cell, fade=fade, floor_color=color
        )
        return frame

    @property
    def cell(self) -> float:
        """Distance of grid lines on a ground, meters."""
        assert self.extent is not None
        return nice_length(0.1 * float(np.linalg.norm(self.extent.high - self.extent.low)))

    def _show_contacts(self, frame: LiveFrame) -> None:
        assert self.extent is not None
        self._deepest = max(self._deepest, float(frame.depths.max(initial=0.0)))
        track = ContactTrack.from_frames([(frame.points, frame.normals, frame.depths)])
        pins = build_pins(
            track,
            scale=self.scale,
            deepest=self.deepest,
            limit=_MOST_CONTACTS,
            grain=_GRAIN,
        )
        node = self._extras.get("contacts")
        if node is None:
            if len(pins) == 0:
                return
            from trimesh.creation import icosphere

            radius = _BALL * self.extent.body * self.scale
            ball = icosphere(subdivisions=1, radius=radius)  # a few pixels wide
            self._extras["contacts"] = self._scene.add_batched_meshes_simple(
                "/contacts",
                np.asarray(ball.vertices, np.float32),
                np.asarray(ball.faces, np.uint32),
                pins.rotations,
                pins.positions,
                batched_colors=pins.colors,
                lod="off",
                cast_shadow=False,
                receive_shadow=False,
            )
            return
        if len(pins):
            node.batched_positions = pins.positions
            node.batched_wxyzs = pins.rotations
            node.batched_colors = pins.colors
        if node.visible != bool(len(pins)):
            node.visible = bool(len(pins))

    def _find_arrows(self, frame: LiveFrame) -> NDArray[np.float64]:
        """Return arrows from points in the direction of forces, (k, 2, 3) display units."""
        assert self.extent is not None
        return find_arrows(
            frame.points * self.scale,
            frame.forces,
            strongest=self.longest_force,
            longest=_LONGEST_ARROW * self.extent.body * self.scale,
            limit=_MOST_CONTACTS,
        )

    def _show_arrows(
        self, name: str, arrows: NDArray[np.float64], color: tuple[int, int, int]
    ) -> None:
        assert self.extent is not None
        placed = place_arrows(arrows, body_size=self.extent.body * self.scale)
        positions, turns, scales = (each.astype(np.float32) for each in placed)
        node = self._extras.get(name)
        if node is None and len(positions):
            placed = (positions, turns, scales)
            self._extras[name] = add_arrows(self._scene, f"/{name}", placed, color)
        elif node is not None:
            if len(positions):
                node.batched_positions = positions
                node.batched_wxyzs = turns
                node.batched_scales = scales
            if node.visible != bool(len(positions)):
                node.visible = bool(len(positions))


def _foot(
    plane: Plane, pose: NDArray[np.float64], point: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return the point of a plane nearest to a point, (3,) meters, world frame."""
    normal = pose[:3, :3] @ plane.normal
    height = normal @ (point - pose[:3, 3]) - plane.offset
    return point - height * normal
