"""The nodes of a replay's scene: those that change while it plays, and the fixed ones."""

from __future__ import annotations

import textwrap
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from voxshell.base.arguments import as_unicode
from voxshell.recording import BodyTrack
from voxshell.viewer.arrows import LONGEST_ARROW, add_arrows, find_arrows, place_arrows
from voxshell.viewer.grid import DROP, add_grid
from voxshell.viewer.lanes import Lane, activity_bounds, view_axes
from voxshell.viewer.palette import BODY_COLORS, FIXED_COLOR, FLOOR_COLOR, FORCE_COLOR
from voxshell.viewer.pins import Pins, build_pin_mesh, build_pins
from voxshell.viewer.quaternions import rotations_as_wxyz
from voxshell.viewer.shading import split_creases
from voxshell.viewer.stage import Camera, Slab, Stage, find_slabs
from voxshell.viewer.timeline import Timeline

if TYPE_CHECKING:
    import viser

_SLAB_COLOR = (226, 230, 235)
_GRID_LIFT = 0.002  # display units; enough to lie on the slab without flicker, and below bodies
# Numbers are rounded to multiples of a power of two that are too small to see: they compress well.
_POSE_GRAIN = 2.0**-16  # display units, and components of a quaternion; a tenth of a pixel
_PIN_GRAIN = 2.0**-13
_LABEL_WIDTH = 130  # characters that fit side by side below all lanes of a row
_SHORT_ROW = 3
_LETTER_FRACTION = 0.0205  # fraction of the picture's height; 14 of 680 pixels
_BALL_FRACTION = 0.012  # fraction of a body's diagonal
_FLOOR = 4.5  # distance at which a floor has faded out, in sides of the stage


@dataclass(frozen=True, eq=False)
class Script:
    """Settings that all lanes of a page share.

    Args:
        stage: The space of every lane.
        camera: The first view.
        timeline: The instants shown.
        up: The world axis that points up.
        lane_count: Number of lanes.
        deepest: Depth with the darkest color, meters.
        strongest: Force of the longest arrow, newtons; 0 draws normals instead of forces.
        counted: Write the number of contacts below a lane.
        max_contacts: Largest number of pins in a lane at a time.
    """

    stage: Stage
    camera: Camera
    timeline: Timeline
    up: str
    lane_count: int
    deepest: float
    strongest: float
    counted: bool
    max_contacts: int


class Actor(Protocol):
    """A node that changes."""

    def show(self, instant: int) -> None:
        """Set the node's state for an instant of the timeline."""
        ...


def add_lane(scene: viser.SceneApi, lane: Lane, number: int, script: Script) -> list[Actor]:
    """Add a lane to the scene.

    Args:
        scene: The scene.
        lane: The lane.
        number: Its number, from 0.
        script: Settings that all lanes share.

    Returns:
        The nodes that change.
    """
    # Slashes would add levels to the scene's tree.
    root = f"/lane {number + 1} {' '.join(lane.label.replace('/', ' ').split())}".rstrip()
    scale = script.stage.scale
    scene.add_frame(root, show_axes=False, position=_triple(scale * np.array(lane.offset)))
    slabs = find_slabs(lane.recording, script.stage, up=script.up)
    moving = [body for body in lane.recording.bodies if not body.fixed]
    frames = script.timeline.frames(lane.recording)
    actors: list[Actor] = []
    for body in lane.recording.bodies:
        name = f"{root}/{as_unicode(body.name).replace('/', ' ')}"
        if body.name in slabs and _is_endless(slabs[body.name], script):
            top = slabs[body.name].low if script.up[0] == "-" else slabs[body.name].high
            _add_floor(scene, name, top, script, color=body.color or FLOOR_COLOR)
            continue
        if body.name in slabs:
            _add_slab(scene, name, slabs[body.name], body.color or _SLAB_COLOR, script)
            continue
        color = body.color or FIXED_COLOR
        if body.color is None and not body.fixed:
            # If each of several lanes has one body, colors distinguish lanes, otherwise bodies.
            alone = len(moving) == 1 and script.lane_count > 1
            color = BODY_COLORS[(number if alone else moving.index(body)) % len(BODY_COLORS)]
        vertices, faces = split_creases(body.vertices, body.faces)
        node = scene.add_mesh_simple(
            name,
            (vertices * scale).astype(np.float32),
            faces.astype(np.uint32),
            color=color,
            side="double",
        )
        actors.append(_BodyActor(node, body, frames, scale))
    if lane.label or script.counted:
        actors.append(_CaptionActor(_add_caption(scene, root, script), lane, script))
    if not slabs:  # for shadows and for scale
        low, high = activity_bounds(lane.recording)
        _add_floor(scene, f"{root}/floor", high if script.up[0] == "-" else low, script)
    for found in (
        _ContactActor.build(scene, f"{root}/contacts", lane, script),
        _ForceActor.build(scene, f"{root}/forces", lane, script),
    ):
        if found is not None:
            actors.append(found)
    return actors


class _BodyActor:
    """Moves one body's node, and hides it until the body is there."""

    def __init__(self, node: Any, body: BodyTrack, frames: NDArray[np.int64], scale: float) -> None:
        poses = body.poses[frames]
        self._node = node
        self._turns = np.round(rotations_as_wxyz(poses[:, :3, :3]) / _POSE_GRAIN) * _POSE_GRAIN
        self._places = np.round(poses[:, :3, 3] * (scale / _POSE_GRAIN)) * _POSE_GRAIN
        self._is_there = frames >= body.start

    def show(self, instant: int) -> None:
        is_there = bool(self._is_there[instant])
        if self._node.visible != is_there:
            self._node.visible = is_there
        # viser does not send what has not changed.
        self._node.wxyz = self._turns[instant]
        self._node.position = self._places[instant]


class _CaptionActor:
    """Writes a lane's label and its number of contacts."""

    def __init__(self, node: Any, lane: Lane, script: Script) -> None:
        self._node = node
        width = max(12, _LABEL_WIDTH // script.stage.columns)
        self._lines = [part for line in lane.label.splitlines() for part in _wrap(line, width)]
        shown = script.timeline.frames(lane.recording)
        self._counts = lane.recording.contacts.counts[shown] if script.counted else None

    def show(self, instant: int) -> None:
        lines = list(self._lines)
        if self._counts is not None:
            count = int(self._counts[instant])
            lines.append(f"{count} contact" if count == 1 else f"{count} contacts")
        self._node.text = "\n".join(lines)


class _MarkActor:
    """Marks at a lane's contacts: a node that is hidden while there are none."""

    def __init__(self, node: Any, lane: Lane, frames: NDArray[np.int64], script: Script) -> None:
        self._node = node
        self._lane = lane
        self._frames = frames
        self._script = script

    def _show_if(self, any_marks: bool) -> None:
        if self._node.visible != any_marks:
            self._node.visible = any_marks


class _ContactActor(_MarkActor):
    """Shows a lane's contacts as pins."""

    @classmethod
    def build(
        cls, scene: viser.SceneApi, name: str, lane: Lane, script: Script
    ) -> _ContactActor | None:
        """Add the node; return None if the lane has no contact to show."""
        frames = script.timeline.contact_frames(lane.recording)
        counts = lane.recording.contacts.counts[frames]
        if not counts.any() or script.max_contacts == 0:
            return None
        # Start with the fullest of all instants, so that the player never has to grow its buffers.
        pins = _pins(lane, int(frames[np.argmax(counts)]), script)
        ball = _BALL_FRACTION * script.stage.body_size * script.stage.scale
        vertices, faces = build_pin_mesh(ball, stem=script.strongest == 0.0)
        node = scene.add_batched_meshes_simple(
            name,
            vertices,
            faces,
            pins.rotations,
            pins.positions,
            batched_colors=pins.colors,
            lod="off",
            cast_shadow=False,
            receive_shadow=False,
            visible=False,
        )
        return cls(node, lane, frames, script)

    def show(self, instant: int) -> None:
        pins = _pins(self._lane, int(self._frames[instant]), self._script)
        if len(pins):
            self._node.batched_positions = pins.positions
            self._node.batched_wxyzs = pins.rotations
            self._node.batched_colors = pins.colors
        self._show_if(bool(len(pins)))


class _ForceActor(_MarkActor):
    """Shows a lane's normal forces as arrows."""

    @classmethod
    def build(
        cls, scene: viser.SceneApi, name: str, lane: Lane, script: Script
    ) -> _ForceActor | None:
        """Add the node; return None if the lane has no force to show."""
        if script.strongest == 0.0 or not lane.recording.contacts.forces.any():
            return None
        frames = script.timeline.contact_frames(lane.recording)
        fullest = int(frames[np.argmax(lane.recording.contacts.counts[frames])])
        placed = _arrows(lane, fullest, script)
        node = add_arrows(scene, name, placed, FORCE_COLOR, visible=False)
        return cls(node, lane, frames, script)

    def show(self, instant: int) -> None:
        positions, turns, scales = _arrows(self._lane, int(self._frames[instant]), self._script)
        if len(positions):
            self._node.batched_positions = positions
            self._node.batched_wxyzs = turns
            self._node.batched_scales = scales
        self._show_if(bool(len(positions)))


def _arrows(
    lane: Lane, frame: int, script: Script
) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    """Return positions (k, 3), quaternions (k, 4) and scales (k, 3) of the arrows of a frame."""
    contacts, scale = lane.recording.contacts.frame(frame), script.stage.scale
    arrows = find_arrows(
        contacts.points * scale,
        contacts.forces,
        strongest=script.strongest,
        longest=LONGEST_ARROW * script.stage.body_size * scale,
        limit=script.max_contacts,
    )
    placed = place_arrows(arrows, body_size=script.stage.body_size * scale)
    positions, turns, scales = (np.round(each / _PIN_GRAIN) * _PIN_GRAIN for each in placed)
    return positions.astype(np.float32), turns.astype(np.float32), scales.astype(np.float32)


def _pins(lane: Lane, frame: int, script: Script) -> Pins:
    return build_pins(
        lane.recording.contacts.frame(frame),
        scale=script.stage.scale,
        deepest=script.deepest,
        limit=script.max_contacts,
        grain=_PIN_GRAIN,
    )


def _add_slab(
    scene: viser.SceneApi, name: str, slab: Slab, color: tuple[int, int, int], script: Script
) -> None:
    """Add a plate with a grid on top, whose lines pass through the recording's origin."""
    _, _, upward = view_axes(script.up)
    low, high = slab.low * script.stage.scale, slab.high * script.stage.scale
    center, size = 0.5 * (low + high) - DROP * upward, high - low
    scene.add_box(name, color=color, dimensions=_triple(size), position=_triple(center))
    cell = script.stage.cell * script.stage.scale
    # The grid's lines start at its center. So a line must pass through the center, and the grid's
    # half
    # lengths must reach the nearer edge of the plate.
    level = upward == 0.0
    middle = np.where(level, np.round(center / cell) * cell, center)
    lengths = 2.0 * np.minimum(middle - low, high - middle)
    first, second = np.flatnonzero(level)
    lift = upward * (0.5 * np.abs(upward @ size) + _GRID_LIFT)
    add_grid(
        scene,
        f"{name}/grid",
        size=(float(lengths[first]), float(lengths[second])),
        cell=cell,
        plane=f"{'xyz'[first]}{'xyz'[second]}",  # pyright: ignore[reportArgumentType]
        position=_triple(middle - center + lift),
    )


def _is_endless(slab: Slab, script: Script) -> bool:
    """Whether a ground reaches beyond a stage that has no neighbors, on all sides."""
    level = view_axes(script.up)[2] == 0.0
    low, high = script.stage.low[level], script.stage.high[level]
    cut = (slab.low[level] <= low).all() and (slab.high[level] >= high).all()
    return bool(cut) and script.lane_count == 1


def _add_floor(
    scene: viser.SceneApi,
    name: str,
    surface: NDArray[np.float64],
    script: Script,
    *,
    color: tuple[int, int, int] = FLOOR_COLOR,
) -> None:
    """Adds a floor with a grid, which fades away around the stage.

    Args:
        scene: Where.
        name: Of the node.
        surface: (3,) meters; its height is that of the floor.
        script: What is shown.
        color: Of the floor.
    """
    _, _, upward = view_axes(script.up)
    low, high = script.stage.low * script.stage.scale, script.stage.high * script.stage.scale
    level = upward == 0.0
    cell = script.stage.cell * script.stage.scale
    middle = np.round(0.5 * (low + high) / cell) * cell
    place = np.where(level, middle, surface * script.stage.scale) - DROP * upward
    reach = _FLOOR * float((high - low)[level].max()) / (1.0 if script.lane_count == 1 else 3.0)
    first, second = np.flatnonzero(level)
    add_grid(
        scene,
        name,
        size=(2.0 * reach, 2.0 * reach),
        cell=cell,
        plane=f"{'xyz'[first]}{'xyz'[second]}",  # pyright: ignore[reportArgumentType]
        position=_triple(place),
        fade=reach,
        floor_color=color,
    )


def _add_caption(scene: viser.SceneApi, root: str, script: Script) -> viser.LabelHandle:
    """Add an empty caption at the front bottom edge of the stage.

    In a long row on a narrow window, letters shrink together with the lanes, and grow when the
    camera comes close. Letters of fixed size would overlap.
    """
    _, forward, upward = view_axes(script.up)
    low, high = script.stage.low * script.stage.scale, script.stage.high * script.stage.scale
    half = 0.5 * (high - low)
    place = 0.5 * (low + high) - np.abs(forward) @ half * forward - np.abs(upward) @ half * upward
    return scene.add_label(
        f"{root}/caption",
        "",
        position=_triple(place),
        anchor="top-center",
        font_size_mode="scene" if script.stage.columns > _SHORT_ROW else "screen",
        font_screen_scale=1.15,
        font_scene_height=_LETTER_FRACTION * script.camera.view_height,
        depth_test=False,
    )


def _wrap(text: str, width: int) -> list[str]:
    """Break a text into as few lines of a width as possible, of about equal length."""
    count = len(textwrap.wrap(text, width))
    while width > 1 and len(textwrap.wrap(text, width - 1)) == count:
        width -= 1
    return textwrap.wrap(text, width)


def _triple(vector: NDArray[np.float64]) -> tuple[float, float, float]:
    x, y, z = vector.tolist()
    return x, y, z
