"""MuJoCo: meshes as convex hulls, as convex parts, or as signed distance fields."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell_studies.peers.protocol import load_library, seconds_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell_studies.peers.protocol import Case, Job, Other

_PLANE_GRID = 1.0
"""Spacing of the lines drawn on a plane, meters; MuJoCo requires a value."""


def set_up(job: Job, variant: str) -> MuJoCo:
    """Return a contender that calls ``mj_collision`` and steps with ``mj_step``.

    Args:
        job: The job.
        variant: "hull", "parts" or "sdf".
    """
    return MuJoCo(job, variant)


class MuJoCo:
    """A MuJoCo model for each case and drop."""

    timed = "mj_collision called from Python, broad phase included"

    def __init__(self, job: Job, variant: str) -> None:
        self._mujoco = load_library("mujoco", "mujoco")
        self._job = job
        self._variant = variant
        self.version: str = self._mujoco.__version__
        option = self._compile("plane", 0.005).opt
        self.settings: dict[str, object] = {"geom": variant}
        if variant == "parts":
            self.settings["parts"] = len(job.parts)
        if variant == "sdf":
            self.settings["sdf_initpoints"] = int(option.sdf_initpoints)
            self.settings["sdf_iterations"] = int(option.sdf_iterations)

    def meet(self, case: Case) -> _Query:
        """Return the pair of a case."""
        return _Query(self._mujoco, self._compile(case.other, 0.005), case)

    def drop(self, other: Other, rate: float) -> _Fall:
        """Return the body above the plane or the box."""
        return _Fall(self._mujoco, self._compile(other, 1.0 / rate), self._job.drop_pose)

    def _compile(self, other: Other, time_step: float) -> Any:
        mujoco = self._mujoco
        spec = mujoco.MjSpec()
        spec.option.timestep = time_step
        if self._variant == "parts":
            for index, points in enumerate(self._job.parts):
                spec.add_mesh(name=f"mesh {index}", uservert=points.ravel().tolist())
        else:
            mesh = spec.add_mesh(name="mesh 0")
            mesh.uservert = self._job.mesh.vertices.ravel().tolist()
            mesh.userface = self._job.mesh.faces.ravel().tolist()
            mesh.needsdf = self._variant == "sdf"
        self._add_body(spec, "body")
        match other:
            case "plane":
                spec.worldbody.add_geom(
                    type=mujoco.mjtGeom.mjGEOM_PLANE, size=(0.0, 0.0, _PLANE_GRID)
                )
            case "box":
                half = self._job.box_half_extents
                spec.worldbody.add_geom(
                    type=mujoco.mjtGeom.mjGEOM_BOX, size=half, pos=(0.0, 0.0, -half[2])
                )
            case "body":
                self._add_body(spec, "other")
        return spec.compile()

    def _add_body(self, spec: Any, name: str) -> None:
        mujoco = self._mujoco
        body = spec.worldbody.add_body(name=name)
        body.add_freejoint()
        matter = self._job.mass_properties
        inertia = matter.inertia
        body.explicitinertial = True
        body.mass = matter.mass
        body.ipos = matter.center_of_mass
        body.fullinertia = (*np.diag(inertia), inertia[0, 1], inertia[0, 2], inertia[1, 2])
        kind = mujoco.mjtGeom.mjGEOM_SDF if self._variant == "sdf" else mujoco.mjtGeom.mjGEOM_MESH
        for index in range(max(1, len(self._job.parts) if self._variant == "parts" else 1)):
            body.add_geom(type=kind, meshname=f"mesh {index}")


class _Query:
    def __init__(self, mujoco: Any, model: Any, case: Case) -> None:
        self._mujoco = mujoco
        self._model = model
        self._data = mujoco.MjData(model)
        if case.other == "body":
            self._data.qpos[7:] = _position(mujoco, case.other_pose)

    def ask(self, pose: NDArray[np.float64]) -> float:
        self._data.qpos[:7] = _position(self._mujoco, pose)
        self._mujoco.mj_kinematics(self._model, self._data)
        self._mujoco.mj_comPos(self._model, self._data)
        return seconds_of(lambda: self._mujoco.mj_collision(self._model, self._data))

    def answer(self) -> tuple[int, float | None]:
        distances = self._data.contact.dist
        return len(distances), max(0.0, -float(np.min(distances, initial=0.0)))


class _Fall:
    def __init__(self, mujoco: Any, model: Any, pose: NDArray[np.float64]) -> None:
        self._mujoco = mujoco
        self._model = model
        self._data = mujoco.MjData(model)
        self._data.qpos[:7] = _position(mujoco, pose)

    def step(self) -> NDArray[np.float64]:
        self._mujoco.mj_step(self._model, self._data)
        # MuJoCo warns, and restarts at the origin.
        unstable = self._mujoco.mjtWarning.mjWARN_BADQACC
        if self._data.warning[unstable].number > 0:
            return np.full((4, 4), np.nan)
        # After the step, the poses are still those of its beginning.
        self._mujoco.mj_kinematics(self._model, self._data)
        pose = np.eye(4)
        pose[:3, :3] = self._data.xmat[1].reshape(3, 3)
        pose[:3, 3] = self._data.xpos[1]
        return pose


def _position(mujoco: Any, pose: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return a pose in MuJoCo's form: position, then quaternion with the real part first."""
    position = np.empty(7)
    position[:3] = pose[:3, 3]
    mujoco.mju_mat2Quat(position[3:], np.ascontiguousarray(pose[:3, :3]).ravel())
    return position
