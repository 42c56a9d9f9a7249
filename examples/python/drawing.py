"""Pictures of recordings and of bodies, in the style of the replays, and plots."""

import manifold3d as m3
import matplotlib.pyplot as plt
import numpy as np
import trimesh
import voxshell as vx
from matplotlib import font_manager
from PIL import Image, ImageDraw, ImageFont
from rendering import make_surface, place_camera, render
from voxshell.base.lengths import metric
from voxshell.recording import BodyTrack, ContactTrack, Recording
from voxshell.viewer.lanes import Lane
from voxshell.viewer.marks import MarkedContacts
from voxshell.viewer.palette import BODY_COLORS, FIXED_COLOR, FORCE_COLOR, choose_colors
from voxshell.viewer.pins import color_depths
from voxshell.viewer.stage import find_slabs, nice_length, plan_stage

SIZE = 960, 600  # pixels
INK, FAINT, PLATE = (30, 39, 51), (91, 104, 120), (250, 251, 253, 205)
MOST_CONTACTS = 400


class Studio:
    """A recording in front of a camera.

    Args:
        recording: The recording to draw; its grounds become one endless ground.
        size: Width and height, pixels.
        azimuth: Direction of the view, degrees about z; 0 looks along y.
        elevation: Height of the view, degrees above the horizon.
        frames: Frames in which the picture contains all bodies in focus, and all arrows.
        focus: Names of these bodies; all by default.
        floor: Depth of the ground below all bodies if the recording has none, as a multiple of their height.
        fill: The fraction of the picture that the bodies fill.
        forces: Whether to draw the arrows of forces.
        hidden: Names of bodies that are not drawn.
        cut: Names of bodies that are drawn without their front quarter.
        quality: Fraction of the directions of light that are used; a smaller one is faster.
        legend: Whether to explain colors, arrows and lines.
        labels: Texts and the places (3,) that they name.
    """

    def __init__(
        self,
        recording,
        *,
        size=SIZE,
        azimuth=25.0,
        elevation=20.0,
        frames=(0, -1),
        focus=None,
        floor=0.0,
        fill=0.84,
        forces=True,
        hidden=(),
        cut=(),
        quality=1.0,
        legend=True,
        labels=None,
    ):
        stage = plan_stage([Lane("", recording)], up="+z")
        slabs = find_slabs(recording, stage, up="+z")
        colors = choose_colors(recording)
        self._recording, self._size, self._quality = recording, size, quality
        self._cut, self._legend, self._labels = cut, legend, labels or {}
        self._bodies = [
            (make_surface(body.vertices, body.faces, color), body)
            for body, color in zip(recording.bodies, colors, strict=True)
            if body.name not in slabs and body.name not in hidden
        ]
        places = {
            body.name: np.concatenate(
                [
                    surface.dots[:3000] @ body.poses[frame, :3, :3].T + body.poses[frame, :3, 3]
                    for frame in frames
                ]
            )
            for surface, body in self._bodies
        }
        self._marked = MarkedContacts(recording, up="+z", limit=MOST_CONTACTS)
        self._deepest = self._marked.deepest
        self._strongest = self._marked.strongest if forces else 0.0
        seen = np.concatenate([places[name] for name in focus or places])
        low, high = np.min(seen, axis=0), np.max(seen, axis=0)
        tips = [end for frame in frames for _, end in self._find_arrows(frame)]
        seen = np.concatenate([seen, np.reshape(tips, (-1, 3))])
        self.camera = place_camera(seen, size, azimuth=azimuth, elevation=elevation, fill=fill)
        if focus:
            low[2] = min(points[:, 2].min() for points in places.values())
        self.ground = low[2] - floor * (high[2] - low[2])
        if slabs:
            self.ground = max(slab.high[2] for slab in slabs.values())
        self.cell = nice_length(0.06 * float(np.linalg.norm(high - low)))

    def picture(self, frame=-1):
        """Return a PIL image of the bodies and contacts of a frame, with the legend."""
        frame = frame % self._recording.frame_count
        pixels = render(
            [
                (self._open(surface, body, frame), body.poses[frame])
                for surface, body in self._bodies
            ],
            self.camera,
            self._size,
            ground=self.ground,
            cell=self.cell,
            marks=self._find_marks(frame),
            suns=max(6, round(16 * self._quality)),
            skies=max(16, round(48 * self._quality)),
        )
        image = Image.fromarray(pixels)
        self._write_labels(image)
        if self._legend:
            self._write_legend(image)
        return image

    def _open(self, surface, body, frame):
        """Return the surface of a body, without its front quarter if it is cut."""
        if body.name not in self._cut:
            return surface
        turn = body.poses[frame, :3, :3]
        mesh = m3.Mesh64(body.vertices.copy(), body.faces.astype(np.uint64))
        whole = m3.Manifold(mesh)
        middle = 0.5 * (body.vertices.min(axis=0) + body.vertices.max(axis=0))
        right, back = self.camera.axes[0], np.cross(self.camera.axes[0], (0.0, 0.0, 1.0))
        first, second = (back + right) @ turn, (back - right) @ turn
        kept = whole.trim_by_plane((-first).tolist(), float(-first @ middle))
        rest = whole.trim_by_plane(first.tolist(), float(first @ middle))
        kept += rest.trim_by_plane((-second).tolist(), float(-second @ middle))
        left = kept.to_mesh64()
        return make_surface(left.vert_properties[:, :3], left.tri_verts, surface.color)

    def _find_marks(self, frame):
        """Return a ball for each contact, colored by its depth, and an arrow for each force."""
        found = self._marked.frame(frame)
        radius = 0.01 * self._marked.body_size
        marks = [make_arrow(a, b, radius, FORCE_COLOR) for a, b in self._find_arrows(frame)]
        ball = trimesh.creation.icosphere(2, self._marked.ball)
        for point, color in zip(found.points, found.colors, strict=True):
            pose = np.eye(4)
            pose[:3, 3] = point
            marks.append((make_surface(ball.vertices, ball.faces, tuple(color), dots=1), pose))
        return marks

    def _find_arrows(self, frame):
        """Return the ends of the arrow of each force."""
        frame = frame % self._recording.frame_count
        return self._marked.frame(frame).arrows if self._strongest > 0.0 else ()

    def _write_labels(self, image):
        """Name places of the scene: a dot at the place, a line down from it, and the text on a pale plate."""
        width, height = self._size
        pen, letter = ImageDraw.Draw(image, "RGBA"), max(11, height // 42)
        font = ImageFont.truetype(font_manager.findfont("DejaVu Sans"), letter)
        scale = 0.5 * height / self.camera.tangent
        for text, place in self._labels.items():
            right, up, back = self.camera.axes @ (np.asarray(place) - self.camera.position)
            x, y = 0.5 * width - scale * right / back, 0.5 * height + scale * up / back
            below, half = y + 3.0 * letter, 0.5 * pen.textlength(text, font) + 0.6 * letter
            pen.line((x, y, x, below), INK, max(1, letter // 9))
            pen.ellipse((x - 3, y - 3, x + 3, y + 3), INK)
            box = (x - half, below - 0.9 * letter, x + half, below + 0.9 * letter)
            pen.rectangle(box, PLATE)
            pen.text((x, below), text, INK, font, anchor="mm")

    def _write_legend(self, image):
        """Explain colors, arrows and lines along the lower edge of the picture."""
        width, height = self._size
        pen, letter = ImageDraw.Draw(image, "RGBA"), max(11, height // 42)
        font = ImageFont.truetype(font_manager.findfont("DejaVu Sans"), letter)
        middle, left = height - 1.2 * letter, 1.0 * letter
        for row in range(round(2.4 * letter)):  # a plate that fades out at its upper edge
            strength = round(PLATE[3] * min(1.0, row / (0.6 * letter)))
            place = height - round(2.4 * letter) + row
            pen.line((0, place, width, place), (*PLATE[:3], strength))
        if self._deepest > 0.0:
            pen.text((left, middle), "contact depth 0", INK, font, anchor="lm")
            left += pen.textlength("contact depth 0", font) + 0.6 * letter
            long, thick = 6 * letter, 0.3 * letter
            colors = color_depths(np.linspace(0.0, 1.0, long)).round().astype(int)
            for place, color in enumerate(colors.tolist()):
                box = (left + place, middle - thick, left + place, middle + thick)
                pen.rectangle(box, tuple(color))
            left += long + 0.6 * letter
            pen.text((left, middle), metric(self._deepest), INK, font, anchor="lm")
            left += pen.textlength(metric(self._deepest), font) + 2.0 * letter
        if self._strongest > 0.0:
            tip = left + 2.2 * letter
            pen.line((left, middle, tip - 5, middle), FORCE_COLOR, max(2, letter // 6))
            head = [(tip, middle), (tip - 0.7 * letter, middle - 0.35 * letter)]
            pen.polygon([*head, (tip - 0.7 * letter, middle + 0.35 * letter)], FORCE_COLOR)
            text = f"normal force on the moving body, longest {self._strongest:g} N"
            pen.text((tip + 0.5 * letter, middle), text, INK, font, anchor="lm")
        text = f"grid {metric(self.cell)}"
        pen.text((width - letter, middle), text, FAINT, font, anchor="rm")


def draw(path, shown, *, frame=-1, **options):
    """Write a picture of a frame of a recording, or of models or meshes at poses.

    Args:
        path: The path of the PNG file.
        shown: A recording, or tuples (model or mesh, pose) or (model or mesh, pose, color from 0 to 255). Without
            colors, the first body is gray.
        frame: Number of the frame.
        options: As for :class:`Studio`.
    """
    if not isinstance(shown, Recording):
        shown = as_recording(shown)
    Studio(shown, **options).picture(frame).save(path)


def as_recording(pairs, contacts=None):
    """Return a recording of one frame, from tuples as for :func:`draw` and optionally contacts."""
    tracks = []
    for number, (shape, pose, *color) in enumerate(pairs):
        mesh = shape if isinstance(shape, vx.Mesh) else shape.mesh
        chosen = color[0] if color else (FIXED_COLOR, *BODY_COLORS)[number % 7]
        poses = np.asarray(pose)[None]
        faces = np.asarray(mesh.faces, np.int64)
        tracks.append(BodyTrack(f"{number}", mesh.vertices, faces, chosen, poses))
    track = ContactTrack.empty(1)
    if contacts is not None:
        track = ContactTrack.from_frames([(contacts.points_b, contacts.normals, contacts.depths)])
    return Recording(1.0, tuple(tracks), track)


def make_arrow(start, end, thickness, color):
    """Return the surface and the pose of an arrow between two points."""
    length = float(np.linalg.norm(end - start))
    head = min(6.0 * thickness, 0.6 * length)
    profile = [(0, 0), (thickness, 0), (thickness, length - head), (2.8 * thickness, length - head)]
    mesh = trimesh.creation.revolve([*profile, (0, length)], sections=16)
    pose = trimesh.geometry.align_vectors((0.0, 0.0, 1.0), end - start)
    pose[:3, 3] = start
    return make_surface(mesh.vertices, mesh.faces, color, dots=1), pose


def plot(path, x, lines, *, x_label, y_label):
    """Write a plot of named lines over x."""
    figure, axes = plt.subplots(figsize=(7.0, 3.5), layout="constrained")
    for label, y in lines.items():
        axes.plot(x, y, label=label)
    axes.set(xlabel=x_label, ylabel=y_label)
    axes.grid(alpha=0.3)
    if len(lines) > 1:
        axes.legend(frameon=False)
    figure.savefig(path, dpi=110)
    plt.close(figure)
