"""The bunny's convex hull falling on a plane in MuJoCo, with MuJoCo's contacts."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np
from voxshell.errors import MissingExtraError

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from voxshell.model.mass_properties import MassProperties

FRICTION = 0.25
"""Coulomb's coefficient of the pair; two bodies of World's default 0.5 have the same in Bullet."""

_STEPS_OF_SPRING = 4.0
"""Time constant of MuJoCo's contacts, critically damped, in steps; its documentation (Modeling,
Solver parameters) requires at least 2."""

_PLANE_GRID = 1.0
"""Spacing of the lines drawn on a plane, meters; MuJoCo requires a value."""


class MuJoCoFall:
    """A convex body over the plane z = 0. No rolling friction.

    Args:
        hull: (n, 3) its vertices, meters, body frame.
        matter: Its mass properties, in the same frame.
        rate: Steps per second.
        pose: (4, 4) world_from_body at the start.

    Raises:
        MissingExtraError: MuJoCo is not installed.
    """

    def __init__(
        self,
        hull: NDArray[np.float64],
        matter: MassProperties,
        rate: float,
        pose: NDArray[np.float64],
    ) -> None:
        try:
            mujoco: Any = import_module("mujoco")
        except ImportError as error:
            raise MissingExtraError("pip install voxshell-studies[peers] for MuJoCo") from error
        spec: Any = mujoco.MjSpec()
        spec.option.timestep = 1.0 / rate
        # Isotropic friction, as Coulomb's.
        spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        spec.add_mesh(name="hull").uservert = hull.ravel().tolist()
        body = spec.worldbody.add_body(name="body")
        body.add_freejoint()
        inertia = matter.inertia
        body.explicitinertial = True
        body.mass = matter.mass
        body.ipos = matter.center_of_mass
        body.fullinertia = (*np.diag(inertia), inertia[0, 1], inertia[0, 2], inertia[1, 2])
        contact = {
            "condim": 3,  # along the normal, and sliding
            "friction": (FRICTION, 0.0, 0.0),
            "solref": (_STEPS_OF_SPRING / rate, 1.0),
        }
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="hull", **contact)
        spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_PLANE, size=(0.0, 0.0, _PLANE_GRID), **contact
        )
        self._mujoco = mujoco
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)
        self._data.qpos[:3] = pose[:3, 3]
        mujoco.mju_mat2Quat(self._data.qpos[3:7], np.ascontiguousarray(pose[:3, :3]).ravel())

    def step(self) -> float:
        """Make a step; return the angular speed after it, rad/s."""
        self._mujoco.mj_step(self._model, self._data)
        return float(np.linalg.norm(self._data.qvel[3:6]))
