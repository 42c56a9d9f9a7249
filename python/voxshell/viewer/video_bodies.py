"""The part of a video's picture that has bodies, with the darkness where they are near other things."""

from __future__ import annotations

import math
from dataclasses import dataclass
from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from voxshell.recording import BodyTrack

_REACH = 0.3  # of ambient occlusion, in diagonals of a typical body
_BIAS = 0.01  # likewise: parts whose depths differ by less do not occlude each other
_SAMPLES = 16
_GRAIN = 12
"""Pixels in whose multiples the part begins and ends. The noise of ambient occlusion repeats every 4
pixels, and would flicker if it moved with the part."""


@dataclass(frozen=True, eq=False)
class DrawnBody:
    """A body on a plotter.

    Args:
        actor: Its actor.
        body: The body.
        points: (k, 3) points that lie evenly on its surface, meters, body frame.
        bounds: (2, 3) its corners, meters, body frame.
    """

    actor: Any
    body: BodyTrack
    points: NDArray[np.float64]
    bounds: NDArray[np.float64]


class BodyView:
    """A renderer that draws bodies, and what is around them, in the smallest part of the picture that has them.

    Ambient occlusion takes as long for a pixel of empty ground as for one of a body, and more than
    everything else. So the plotter's own renderer draws the picture without bodies and occlusion, and
    this one draws the part again, with both.

    Args:
        plotter: The plotter, with its camera and lights, and all that it shows.
        bodies: Those of its actors that are bodies. They move to this renderer; the others are in both.
        size: Width and height of the plotter's picture, pixels.
        body_size: Diagonal of a typical body, meters.
    """

    def __init__(
        self, plotter: Any, bodies: Sequence[Any], *, size: tuple[int, int], body_size: float
    ) -> None:
        rendering = import_module("vtkmodules.vtkRenderingCore")
        opengl = import_module("vtkmodules.vtkRenderingOpenGL2")
        self._size, self._reach = np.array(size), _REACH * body_size
        self._whole = plotter.camera
        self._renderer, self._camera = rendering.vtkRenderer(), rendering.vtkCamera()
        self._renderer.SetActiveCamera(self._camera)
        self._renderer.SetBackground(plotter.renderer.GetBackground())
        self._renderer.AutomaticLightCreationOff()
        for light in plotter.renderer.GetLights():
            self._renderer.AddLight(light)
        for actor in list(plotter.renderer.GetViewProps()):
            self._renderer.AddViewProp(actor)
        for actor in bodies:
            plotter.renderer.RemoveViewProp(actor)
        occlusion, camera_pass = opengl.vtkSSAOPass(), opengl.vtkCameraPass()
        camera_pass.SetDelegatePass(opengl.vtkRenderStepsPass())
        occlusion.SetDelegatePass(camera_pass)
        occlusion.SetRadius(self._reach)
        occlusion.SetBias(_BIAS * body_size)
        occlusion.SetKernelSize(_SAMPLES)
        occlusion.BlurOn()
        self._renderer.SetPass(occlusion)
        plotter.render_window.AddRenderer(self._renderer)

    def look_at(self, bodies: Sequence[tuple[NDArray[np.float64], NDArray[np.float64]]]) -> None:
        """Draw the part of the picture that has bodies: bounds (2, 3) of each, and its pose."""
        part = self._find_part(bodies)
        self._renderer.SetDraw(part is not None)
        if part is None:
            return
        low, high = part
        self._renderer.SetViewport(*(low / self._size), *(high / self._size))
        # From -1 to 1 across the picture.
        first, last = 2.0 * low / self._size - 1.0, 2.0 * high / self._size - 1.0
        self._camera.DeepCopy(self._whole)
        self._camera.SetWindowCenter(*((first + last) / (last - first)))
        half = math.tan(0.5 * math.radians(self._whole.GetViewAngle()))
        angle = 2.0 * math.atan(half * 0.5 * float(last[1] - first[1]))
        self._camera.SetViewAngle(math.degrees(angle))

    def _find_part(
        self, bodies: Sequence[tuple[NDArray[np.float64], NDArray[np.float64]]]
    ) -> tuple[NDArray[np.int64], NDArray[np.int64]] | None:
        """Return the corners of the part in pixels, (2,) each; None if no body is in the picture."""
        if not bodies:
            return None
        places = []
        for (low, high), pose in bodies:
            corners = np.array([np.where(bits, high, low) for bits in np.ndindex(2, 2, 2)])
            places.append(corners @ pose[:3, :3].T + pose[:3, 3])
        aspect = self._size[0] / self._size[1]
        matrix = self._whole.GetCompositeProjectionTransformMatrix(aspect, -1.0, 1.0)
        entries = [[matrix.GetElement(row, column) for column in range(4)] for row in range(4)]
        seen = np.insert(np.concatenate(places), 3, 1.0, axis=1) @ np.array(entries).T
        depths = seen[:, 3:]
        if depths.min() <= self._reach:  # as near as the camera, or behind it
            return np.zeros(2, np.int64), self._size
        pixels = (0.5 + 0.5 * seen[:, :2] / depths) * self._size
        half = math.tan(0.5 * math.radians(self._whole.GetViewAngle()))
        around = self._reach * 0.5 * self._size[1] / (half * (depths - self._reach))
        low = (np.floor((pixels - around).min(axis=0) / _GRAIN) * _GRAIN).clip(0, self._size)
        high = (np.ceil((pixels + around).max(axis=0) / _GRAIN) * _GRAIN).clip(0, self._size)
        if (low >= high).any():
            return None
        return low.astype(np.int64), high.astype(np.int64)
