"""A handle to drag and turn a body on a page."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell.viewer.quaternions import rotations_as_wxyz

if TYPE_CHECKING:
    from collections.abc import Callable

    import viser
    from numpy.typing import NDArray


class Handle:
    """Arrows and rings that move a body, and everything below :attr:`path` in the scene.

    Args:
        server: The server of the page.
        name: Name of its node in the scene, such as ``"/part"``.
        grip: (3,) meters, body frame: position of the handle, about which the body turns.
        pose: Initial ``world_from_body``, (4, 4).
        scale: Display units per meter.
        size: Size of the arrows, display units.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        name: str,
        *,
        grip: NDArray[np.float64],
        pose: NDArray[np.float64],
        scale: float,
        size: float,
    ) -> None:
        self.path: str = f"{name}/origin"
        """Path of the body's frame in the scene."""
        self._grip, self._scale = grip, scale
        self._controls = server.scene.add_transform_controls(name, scale=size)
        server.scene.add_frame(self.path, show_axes=False, position=-scale * grip)
        self.pose = pose

    @property
    def pose(self) -> NDArray[np.float64]:
        """Current ``world_from_body``, (4, 4); settable."""
        from trimesh.transformations import quaternion_matrix

        pose = np.array(quaternion_matrix(self._controls.wxyz))
        pose[:3, 3] = np.asarray(self._controls.position) / self._scale - pose[:3, :3] @ self._grip
        return pose

    @pose.setter
    def pose(self, pose: NDArray[np.float64]) -> None:
        self._controls.wxyz = rotations_as_wxyz(pose[None, :3, :3])[0]
        self._controls.position = self._scale * (pose[:3, 3] + pose[:3, :3] @ self._grip)

    def on_drag(self, function: Callable[[], None]) -> None:
        """Call a function, in a thread of viser, whenever somebody drags or turns the handle."""

        @self._controls.on_update
        def _(_: Any) -> None:
            function()

    def show(self, *, shown: bool) -> None:
        """Show or hide the arrows and rings; the body stays visible."""
        controls = self._controls
        controls.disable_axes = controls.disable_sliders = controls.disable_rotations = not shown
