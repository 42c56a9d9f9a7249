"""Recordings as Universal Scene Description: meshes with a pose for each frame, and contacts as points and lines."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell.base.arguments import as_unicode, show_value
from voxshell.base.extras import explain_import
from voxshell.base.outputs import replacing
from voxshell.errors import FileAccessError, SettingsError
from voxshell.viewer.arrows import ARROW_SHAFT
from voxshell.viewer.marks import MarkedContacts
from voxshell.viewer.palette import FORCE_COLOR, choose_colors
from voxshell.viewer.quaternions import as_steady, rotations_as_wxyz

if TYPE_CHECKING:
    from pathlib import Path

    from numpy.typing import NDArray

    from voxshell.recording import BodyTrack, Recording

_MOST_CONTACTS = 400


def save_usd(path: Path, recording: Recording, *, up: str = "+z", contacts: bool = True) -> Path:
    """Write a recording as USD; see :meth:`voxshell.recording.Recording.save_usd`."""
    if not (isinstance(up, str) and up in ("+z", "+y")):
        raise SettingsError(f"up must be '+z' or '+y' in USD, not {show_value(up)}")
    usd = _import_usd()
    with replacing(path) as temporary:
        stage = usd.Usd.Stage.CreateInMemory()
        usd.UsdGeom.SetStageUpAxis(stage, up[1].upper())
        usd.UsdGeom.SetStageMetersPerUnit(stage, 1.0)
        stage.SetTimeCodesPerSecond(1.0 / recording.time_step)
        stage.SetFramesPerSecond(1.0 / recording.time_step)
        stage.SetStartTimeCode(0.0)
        stage.SetEndTimeCode(float(recording.frame_count - 1))
        root = usd.UsdGeom.Xform.Define(stage, "/recording")
        stage.SetDefaultPrim(root.GetPrim())
        for number, body in enumerate(recording.bodies):
            _add_body(usd, stage, body, number, choose_colors(recording)[number])
        if contacts and recording.contacts.counts.any():
            _add_contacts(
                usd, stage, recording, MarkedContacts(recording, up=up, limit=_MOST_CONTACTS)
            )
        _export(usd, stage, temporary, path)
    return path


def _export(usd: Any, stage: Any, temporary: Path, path: Path) -> None:
    """Write a stage; raise one error for the many that USD collects, one for each block of a file."""
    try:
        written, reason = stage.Export(str(temporary)), "USD gives no reason; is the disk full?"
    except usd.Tf.ErrorException as error:
        first = str(error.args[0] if error.args else error)
        written, reason = False, first.rpartition(" : ")[2].strip("'")
    if not written:
        raise FileAccessError(f"cannot write {path}: {reason}")


def _import_usd() -> Any:
    """Return the library with the modules in use; type checkers do not know its types."""
    try:
        for name in ("Gf", "Tf", "Usd", "UsdGeom", "Vt"):
            import_module(f"pxr.{name}")
    except ImportError as error:
        raise explain_import(
            error,
            f"USD files need usd-core, which cannot be imported ({error}); run: pip install 'voxshell[usd]'",
        ) from error
    return import_module("pxr")


def _add_body(
    usd: Any, stage: Any, body: BodyTrack, number: int, color: tuple[int, int, int]
) -> None:
    # USD's names consist of letters, digits and underscores; the number makes them unique.
    label = as_unicode(body.name)
    name = f"{usd.Tf.MakeValidIdentifier(label)}_{number}"
    mesh = usd.UsdGeom.Mesh.Define(stage, f"/recording/{name}")
    mesh.GetPrim().SetMetadata("displayName", label)
    mesh.CreatePointsAttr(usd.Vt.Vec3fArray.FromNumpy(body.vertices.astype(np.float32)))
    mesh.CreateFaceVertexCountsAttr(
        usd.Vt.IntArray.FromNumpy(np.full(len(body.faces), 3, dtype=np.int32))
    )
    mesh.CreateFaceVertexIndicesAttr(
        usd.Vt.IntArray.FromNumpy(body.faces.reshape(-1).astype(np.int32))
    )
    mesh.CreateSubdivisionSchemeAttr(usd.UsdGeom.Tokens.none)
    mesh.CreateDoubleSidedAttr(True)
    extent = np.stack([body.vertices.min(axis=0), body.vertices.max(axis=0)])
    mesh.CreateExtentAttr(usd.Vt.Vec3fArray.FromNumpy(extent.astype(np.float32)))
    mesh.CreateDisplayColorAttr(_as_light(usd, np.array([color])))
    move = mesh.AddTranslateOp(usd.UsdGeom.XformOp.PrecisionDouble)
    turn = mesh.AddOrientOp(usd.UsdGeom.XformOp.PrecisionDouble)
    turns = as_steady(rotations_as_wxyz(body.poses[:, :3, :3]))
    if body.start:
        visibility = mesh.CreateVisibilityAttr()
        visibility.Set(usd.UsdGeom.Tokens.invisible, 0.0)
        visibility.Set(usd.UsdGeom.Tokens.inherited, float(body.start))
    frames = [None] if body.fixed else range(body.frame_count)
    for frame in frames:
        place = body.poses[frame or 0, :3, 3].tolist()
        quaternion = usd.Gf.Quatd(*turns[frame or 0].tolist())
        if frame is None:
            move.Set(usd.Gf.Vec3d(*place))
            turn.Set(quaternion)
        else:
            move.Set(usd.Gf.Vec3d(*place), float(frame))
            turn.Set(quaternion, float(frame))


def _add_contacts(usd: Any, stage: Any, recording: Recording, marked: MarkedContacts) -> None:
    """Add balls at contacts, colored by depth, and lines along their normal forces."""
    balls = usd.UsdGeom.Points.Define(stage, "/recording/contacts")
    lines = usd.UsdGeom.BasisCurves.Define(stage, "/recording/forces")
    lines.CreateTypeAttr(usd.UsdGeom.Tokens.linear)
    lines.CreateDisplayColorAttr(_as_light(usd, np.array([FORCE_COLOR])))
    lines.CreateWidthsAttr([2.0 * ARROW_SHAFT * marked.body_size])
    lines.SetWidthsInterpolation(usd.UsdGeom.Tokens.constant)
    colors = balls.CreateDisplayColorPrimvar(usd.UsdGeom.Tokens.vertex)
    for frame in range(recording.frame_count):
        marks, time = marked.frame(frame), float(frame)
        balls.CreatePointsAttr().Set(_as_vectors(usd, marks.points), time)
        widths = np.full(len(marks.points), 2.0 * marked.ball, dtype=np.float32)
        balls.CreateWidthsAttr().Set(usd.Vt.FloatArray.FromNumpy(widths), time)
        colors.Set(_as_light(usd, marks.colors), time)
        lines.CreatePointsAttr().Set(_as_vectors(usd, marks.arrows.reshape(-1, 3)), time)
        ends = np.full(len(marks.arrows), 2, dtype=np.int32)
        lines.CreateCurveVertexCountsAttr().Set(usd.Vt.IntArray.FromNumpy(ends), time)


def _as_vectors(usd: Any, values: NDArray[np.float64]) -> Any:
    return usd.Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(values, dtype=np.float32))


def _as_light(usd: Any, colors: NDArray[Any]) -> Any:
    """Return linear intensities of colors (sRGB, 0 to 255), (k, 3)."""
    fraction = colors / 255.0
    light = np.where(fraction <= 0.04045, fraction / 12.92, ((fraction + 0.055) / 1.055) ** 2.4)
    return _as_vectors(usd, light)
