"""Recordings as Universal Scene Description: a mesh with a pose for each frame, for each body."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell._outputs import replacing
from voxshell.errors import MissingExtraError, SettingsError
from voxshell.viewer.palette import choose_colors
from voxshell.viewer.quaternions import as_steady, rotations_as_wxyz

if TYPE_CHECKING:
    from pathlib import Path

    from voxshell.recording import BodyTrack, Recording


def save_usd(path: Path, recording: Recording, *, up: str = "+z") -> Path:
    """Writes a recording as USD; see :meth:`voxshell.recording.Recording.save_usd`."""
    if up not in ("+z", "+y"):
        raise SettingsError(f"in USD up is '+z' or '+y', not {up!r}")
    try:
        from pxr import Usd, UsdGeom  # pyright: ignore[reportMissingImports]
    except ImportError as error:
        raise MissingExtraError(
            f"USD files need usd-core, which cannot be imported ({error}); run: pip install 'voxshell[usd]'"
        ) from error
    with replacing(path) as temporary:
        stage: Any = Usd.Stage.CreateInMemory()
        UsdGeom.SetStageUpAxis(stage, up[1].upper())
        UsdGeom.SetStageMetersPerUnit(stage, 1.0)
        stage.SetTimeCodesPerSecond(1.0 / recording.time_step)
        stage.SetFramesPerSecond(1.0 / recording.time_step)
        stage.SetStartTimeCode(0.0)
        stage.SetEndTimeCode(float(recording.frame_count - 1))
        root = UsdGeom.Xform.Define(stage, "/recording")
        stage.SetDefaultPrim(root.GetPrim())
        for number, body in enumerate(recording.bodies):
            _add_body(stage, body, number, choose_colors(recording)[number])
        stage.Export(str(temporary))
    return path


def _add_body(stage: Any, body: BodyTrack, number: int, color: tuple[int, int, int]) -> None:
    from pxr import Gf, Tf, UsdGeom, Vt  # pyright: ignore[reportMissingImports]

    # Names are made of letters, digits and underscores; the number keeps them apart.
    name = f"{Tf.MakeValidIdentifier(body.name)}_{number}"
    mesh = UsdGeom.Mesh.Define(stage, f"/recording/{name}")
    mesh.GetPrim().SetMetadata("displayName", body.name)
    mesh.CreatePointsAttr(Vt.Vec3fArray.FromNumpy(body.vertices.astype(np.float32)))
    mesh.CreateFaceVertexCountsAttr(
        Vt.IntArray.FromNumpy(np.full(len(body.faces), 3, dtype=np.int32))
    )
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(body.faces.reshape(-1).astype(np.int32)))
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    mesh.CreateDoubleSidedAttr(True)
    extent = np.stack([body.vertices.min(axis=0), body.vertices.max(axis=0)])
    mesh.CreateExtentAttr(Vt.Vec3fArray.FromNumpy(extent.astype(np.float32)))
    share = np.array(color) / 255.0
    light = np.where(share <= 0.04045, share / 12.92, ((share + 0.055) / 1.055) ** 2.4)
    mesh.CreateDisplayColorAttr([Gf.Vec3f(*light.tolist())])
    move = mesh.AddTranslateOp(UsdGeom.XformOp.PrecisionDouble)
    turn = mesh.AddOrientOp(UsdGeom.XformOp.PrecisionDouble)
    turns = as_steady(rotations_as_wxyz(body.poses[:, :3, :3]))
    frames = [None] if body.fixed else range(body.frame_count)
    for frame in frames:
        place = body.poses[frame or 0, :3, 3].tolist()
        quaternion = Gf.Quatd(*turns[frame or 0].tolist())
        if frame is None:
            move.Set(Gf.Vec3d(*place))
            turn.Set(quaternion)
        else:
            move.Set(Gf.Vec3d(*place), float(frame))
            turn.Set(quaternion, float(frame))
