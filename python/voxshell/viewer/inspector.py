"""A page that shows a model, and lets the user drag it and another body against each other."""

from __future__ import annotations

import html
import threading
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from voxshell.base.lengths import metric
from voxshell.query.distances import distance
from voxshell.query.queries import contacts
from voxshell.query.scratch import QueryScratch
from voxshell.recording import ContactTrack
from voxshell.viewer.handle import Handle
from voxshell.viewer.inspector_stage import find_view, place_partner
from voxshell.viewer.layers import (
    Axis,
    color_segments,
    describe_slice,
    find_box,
    find_level_surface,
    paint_slice,
)
from voxshell.viewer.lighting import add_lights
from voxshell.viewer.page import add_heading, write_whole
from voxshell.viewer.pins import build_pin_mesh, build_pins
from voxshell.viewer.quaternions import rotations_as_wxyz
from voxshell.viewer.shading import is_faceted

if TYPE_CHECKING:
    from collections.abc import Collection
    from pathlib import Path

    import viser
    from numpy.typing import NDArray

    from voxshell.model.model import Model
    from voxshell.query.pairs import Collidable

Layer = Literal["surface", "slice", "level", "points", "normals", "spheres"]

# Diagonal of the model in display units, which suits viser's clipping planes and camera speed.
_DIAGONAL = 3.0
_BODY_COLOR, _OTHER_COLOR, _LEVEL_COLOR = (92, 141, 208), (176, 138, 190), (230, 170, 60)
_MOST_PINS = 400
_MOST_POINTS = 60_000
_GRAIN = 2.0**-13
_HANDLE = 0.5
"""Size of a handle's arrows as a fraction of its body's diagonal."""
_NOTE = '<div style="padding: 0 1em 0.6em; font-size: 0.85em; line-height: 1.6">{}</div>'
"""A legend among the controls."""

# Rotations of a picture, with columns along x and rows along -y, to the planes normal to each axis.
_ACROSS: dict[Axis, NDArray[np.float64]] = {
    "x": np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]),
    "y": np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]]),
    "z": np.eye(3),
}


class Inspector:
    """The scene of a model, with controls, on a viser server; with a second body on request.

    Args:
        server: The server.
        model: The model to inspect.
        other: A second body; then both can be dragged, and the contacts are updated.
        pose: Initial ``model_from_other``, (4, 4); beside the model by default.
        name: The model's name for people.
        show: Initially visible layers; controls change them.

    Raises:
        SettingsError: ``other`` cannot collide with a model.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        model: Model,
        other: Collidable | None = None,
        *,
        pose: NDArray[np.float64] | None = None,
        name: str = "model",
        show: Collection[Layer] = ("surface",),
    ) -> None:
        self._server, self._model, self._other = server, model, other
        self._name, self._show = name, show
        low, high = model.bounds
        self._scale = _DIAGONAL / float(np.linalg.norm(high - low))
        self._scratch = QueryScratch()
        # viser calls back from several threads, but a scratch serves only one.
        self._lock = threading.RLock()
        self._nodes: dict[str, Any] = {}
        self._level = 1
        self._deepest = 0.0
        self._root = "/model"
        self._handles: list[Handle] = []
        server.scene.set_up_direction("+z")
        server.scene.world_axes.visible = False
        add_lights(server.scene, up="+z")
        self._seen = low, high
        server.gui.configure_theme(show_logo=False, show_share_button=False)
        server.gui.add_markdown(f"**{html.escape(name)}**  \n{self._facts()}")
        if other is not None:
            self._add_pair(other, pose)
        self._add_body()
        self._add_field()
        self._add_shell()
        if other is not None:
            self._add_contacts()
        self._look_at(has_controls=True)

    def _look_at(self, *, has_controls: bool) -> None:
        """Place the camera so that all bodies, and the slice, are visible; if there are controls, beside them."""
        low, high = self._seen
        if "slice" in self._nodes:
            box = find_box(self._model)
            low, high = np.minimum(low, box[0]), np.maximum(high, box[1])
        view = find_view(low * self._scale, high * self._scale, has_controls=has_controls)
        camera = self._server.initial_camera
        camera.position, camera.look_at, camera.fov = view.position, view.target, view.field_of_view

    def _facts(self) -> str:
        model = self._model
        sides = " x ".join(metric(side) for side in np.ptp(model.bounds, axis=0).tolist())
        return (
            f"{sides}, {len(model.mesh.faces):,} triangles, {len(model.shell):,} points, "
            f"voxels of {metric(model.field.voxel_size)}"
        )

    def _add_body(self) -> None:
        body = self._add_mesh(f"{self._root}/body", self._model.mesh, _BODY_COLOR)
        shown = self._server.gui.add_checkbox("surface", "surface" in self._show)
        body.visible = shown.value
        opacity = self._server.gui.add_slider("opacity", 0.1, 1.0, 0.1, 1.0)

        @shown.on_update
        def _(_: Any) -> None:
            body.visible = shown.value

        @opacity.on_update
        def _(_: Any) -> None:
            body.opacity = None if opacity.value == 1.0 else opacity.value

    def _add_field(self) -> None:
        gui = self._server.gui
        with gui.add_folder("distance field"):
            shown = gui.add_checkbox("slice", "slice" in self._show)
            axis = gui.add_dropdown("across", ("x", "y", "z"), initial_value="y")
            place = gui.add_slider("at", 0.0, 1.0, 0.01, 0.5)
            gui.add_html(_NOTE.format(describe_slice(self._model)))
            level_shown = gui.add_checkbox("level surface", "level" in self._show)
            thickness = 1e3 * float(np.ptp(self._model.bounds, axis=0).max())
            level = gui.add_slider(
                "distance, mm", -0.2 * thickness, 0.2 * thickness, 0.01 * thickness, 0.0
            )

        def show_slice(_: Any = None) -> None:
            with self._lock, self._server.atomic():
                self._drop("slice")
                if shown.value:
                    self._nodes["slice"] = self._draw_slice(axis.value, place.value)

        def show_level(_: Any = None) -> None:
            with self._lock, self._server.atomic():
                self._drop("level")
                if not level_shown.value:
                    return
                surface = find_level_surface(self._model, 1e-3 * level.value)
                if len(surface.faces) > 0:
                    node = self._add_mesh(f"{self._root}/level", surface, _LEVEL_COLOR)
                    node.opacity = 0.6
                    self._nodes["level"] = node

        for control in (shown, axis, place):
            control.on_update(show_slice)
        for control in (level_shown, level):
            control.on_update(show_level)
        show_slice()
        show_level()

    def _draw_slice(self, axis: Axis, fraction: float) -> Any:
        low, high = find_box(self._model)
        across = "xyz".index(axis)
        width, height = (float((high - low)[i]) for i in range(3) if i != across)
        middle = 0.5 * (low + high)
        middle[across] = low[across] + fraction * (high - low)[across]
        return self._server.scene.add_image(
            f"{self._root}/slice",
            paint_slice(self._model, axis, fraction),
            render_width=width * self._scale,
            render_height=height * self._scale,
            format="png",
            wxyz=rotations_as_wxyz(_ACROSS[axis][None])[0],
            position=middle * self._scale,
            cast_shadow=False,
            receive_shadow=False,
        )

    def _add_shell(self) -> None:
        gui, tree = self._server.gui, self._model.shell.tree
        with gui.add_folder("point shell"):
            points = gui.add_checkbox("points", "points" in self._show)
            normals = gui.add_checkbox("normals", "normals" in self._show)
            spheres = gui.add_checkbox("spheres", "spheres" in self._show)
            level = gui.add_slider("tree level", 1, tree.levels, 1, min(3, tree.levels))
            gui.add_html(
                _NOTE.format(
                    "A color is a segment: the points of one sphere of that level. It has no other meaning."
                )
            )

        def show(_: Any = None) -> None:
            with self._lock, self._server.atomic():
                for name in ("points", "normals", "spheres"):
                    self._drop(name)
                number = self._level = int(level.value)
                if points.value or normals.value:
                    self._draw_points(number, points=points.value, normals=normals.value)
                if spheres.value:
                    self._draw_spheres(tree.spheres(number))

        for control in (points, normals, spheres, level):
            control.on_update(show)
        show()

    def _draw_points(self, level: int, *, points: bool, normals: bool) -> None:
        shell = self._model.shell
        # Large shells are drawn by a sample: browsers would be too slow otherwise.
        chosen = slice(None, None, -(-len(shell) // _MOST_POINTS))
        places = shell.points[chosen] * np.float32(self._scale)
        colors = color_segments(shell.tree.segments(level)[chosen])
        spacing = shell.spacing * self._scale
        if points:
            self._nodes["points"] = self._server.scene.add_point_cloud(
                f"{self._root}/points",
                places,
                colors,
                point_size=0.5 * spacing,
                point_shape="circle",
            )
        if normals:
            ends = places + np.float32(1.5 * spacing) * shell.normals[chosen]
            self._nodes["normals"] = self._server.scene.add_line_segments(
                f"{self._root}/normals",
                np.stack([places, ends], axis=1),
                np.repeat(colors[:, None], 2, axis=1),
            )

    def _draw_spheres(self, spheres: NDArray[np.float32]) -> None:
        from trimesh.creation import icosphere

        ball = icosphere(subdivisions=3)
        drawn = spheres[spheres[:, 3] > 0.0] * np.float32(self._scale)
        self._nodes["spheres"] = self._server.scene.add_batched_meshes_simple(
            f"{self._root}/spheres",
            np.asarray(ball.vertices, np.float32),
            np.asarray(ball.faces, np.uint32),
            np.tile(np.array([1.0, 0.0, 0.0, 0.0], np.float32), (len(drawn), 1)),
            drawn[:, :3],
            batched_scales=drawn[:, 3],
            batched_colors=color_segments(np.arange(len(drawn))),
            opacity=0.25,
            cast_shadow=False,
            receive_shadow=False,
        )

    def _add_pair(self, other: Collidable, pose: NDArray[np.float64] | None) -> None:
        """Add handles for both bodies, and show the second one."""
        partner = place_partner(other, self._model.bounds, pose)
        mesh, start = partner.mesh, partner.pose
        middle = 0.5 * (self._seen[0] + self._seen[1])
        self._seen = partner.low, partner.high
        extent = float(np.linalg.norm(np.ptp(mesh.vertices, axis=0))) * self._scale
        of_model = ("/model", middle, np.eye(4), _DIAGONAL)
        of_other = ("/other", partner.grip, start, extent)
        for name, place, world_from_body, size in (of_model, of_other):
            self._handles.append(
                Handle(
                    self._server,
                    name,
                    grip=place,
                    pose=world_from_body,
                    scale=self._scale,
                    size=_HANDLE * min(size, _DIAGONAL),
                )
            )
        self._root = self._handles[0].path
        self._add_mesh(f"{self._handles[1].path}/body", mesh, _OTHER_COLOR).opacity = 0.7

    def _add_contacts(self) -> None:
        gui = self._server.gui
        with gui.add_folder("contacts"):
            self._readout = gui.add_markdown("")
            places = [
                gui.add_vector3(f"{which} at, mm", (0.0, 0.0, 0.0), step=0.1)
                for which in ("first", "second")
            ]
        ball, faces = build_pin_mesh(0.012 * _DIAGONAL)
        self._pins = self._server.scene.add_batched_meshes_simple(
            *("/contacts", ball, faces),
            np.array([[1.0, 0.0, 0.0, 0.0]], np.float32),
            np.zeros((1, 3), np.float32),
            lod="off",
            cast_shadow=False,
            receive_shadow=False,
            visible=False,
        )

        def connect(handle: Handle, place: viser.GuiVector3Handle) -> None:
            def tell() -> None:
                place.value = tuple((1e3 * handle.pose[:3, 3]).round(3).tolist())

            def follow() -> None:
                with self._lock:
                    tell()
                    self.show_contacts()

            @place.on_update
            def _(event: Any) -> None:
                # Ignore changes that a drag has just made.
                if event.client_id is not None:
                    with self._lock:
                        pose = handle.pose
                        pose[:3, 3] = 1e-3 * np.array(place.value)
                        handle.pose = pose
                        self.show_contacts()

            handle.on_drag(follow)
            tell()

        for handle, place in zip(self._handles, places, strict=True):
            connect(handle, place)
        self.show_contacts()

    def save_html(self, path: Path) -> Path:
        """Write the current scene as one offline page, with a movable camera.

        Raises:
            SettingsError: No file can be written there, for example because it is a folder or a
                pipe.
            FileAccessError: The system refuses to write it.
        """
        # Without a server, dragging would have no effect.
        self._show_handles(shown=False)
        self._look_at(has_controls=False)
        scene = self._server.get_scene_serializer().as_html()
        self._look_at(has_controls=True)
        self._show_handles(shown=True)
        page = add_heading(
            scene,
            title=self._name,
            caption=self._facts(),
            rate="",
            deepest=self._deepest if self._other is not None and self._pins.visible else None,
            grid=None,
            notes=self._explain_layers(),
        )
        return write_whole(path, page)

    def _explain_layers(self) -> list[str]:
        """Return what the colors of the visible layers mean, HTML."""
        notes = []
        if "slice" in self._nodes:
            notes.append("slice: " + describe_slice(self._model))
        if self._nodes.keys() & {"points", "normals", "spheres"}:
            notes.append(f"a color: the points of one sphere of the tree's level {self._level}")
        return notes

    def _show_handles(self, *, shown: bool) -> None:
        for handle in self._handles:
            handle.show(shown=shown)

    @property
    def poses(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Return the current ``world_from_model`` and ``world_from_other``, (4, 4) each."""
        first, second = self._handles
        return first.pose, second.pose

    def show_contacts(self) -> None:
        """Compute and show the contacts in the current poses."""
        assert self._other is not None
        poses = self.poses
        found = contacts(self._model, self._other, *poses, scratch=self._scratch)
        apart = distance(self._model, self._other, *poses).distance
        self._deepest = float(found.depths.max(initial=0.0))
        track = ContactTrack.from_frames([(found.points_b, found.normals, found.depths)])
        pins = build_pins(
            track.frame(0),
            scale=self._scale,
            deepest=self._deepest,
            limit=_MOST_PINS,
            grain=_GRAIN,
        )
        with self._server.atomic():
            if len(pins):
                self._pins.batched_positions = pins.positions
                self._pins.batched_wxyzs = pins.rotations
                self._pins.batched_colors = pins.colors
            self._pins.visible = bool(len(pins))
            gap = f"{1e3 * abs(apart):.3f} mm {'deep' if apart < 0.0 else 'apart'}"
            self._readout.content = f"{len(found):,} contacts, {gap}"

    def _add_mesh(self, name: str, mesh: Any, color: tuple[int, int, int]) -> Any:
        vertices, faces = np.asarray(mesh.vertices), np.asarray(mesh.faces)
        return self._server.scene.add_mesh_simple(
            name,
            (vertices * self._scale).astype(np.float32),
            faces.astype(np.uint32),
            color=color,
            flat_shading=is_faceted(vertices, faces.astype(np.int64)),
            side="double",
        )

    def _drop(self, name: str) -> None:
        node = self._nodes.pop(name, None)
        if node is not None:
            node.remove()
