"""Everyday scenes in MuJoCo, which needs ``pip install voxshell-studies[peers]``.

The settings are: elliptic friction cones that resist sliding ten times as stiffly as penetration,
which the documentation recommends against slip; contacts with a time constant of four steps,
critically damped; and fourth-order Runge-Kutta integration where nothing touches. MuJoCo has no
coefficient of restitution.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

import numpy as np
from voxshell.errors import MissingExtraError, SettingsError

from voxshell_studies.scenes.everyday.forms import matter

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from voxshell_studies.scenes.everyday.scene import Form, Item, Stage

_STEPS_OF_SPRING = 4.0
"""Time constant of contacts in steps; the documentation requires at least 2."""

_STIFFNESS_RATIO = 10.0
"""Stiffness of friction relative to the normal direction (``impratio``)."""


def import_mujoco() -> Any:
    """Return the module mujoco.

    Raises:
        MissingExtraError: It is not installed.
    """
    try:
        return import_module("mujoco")
    except ImportError as error:
        raise MissingExtraError("pip install voxshell-studies[peers] for MuJoCo") from error


class MuJoCoStage:
    """A stage in MuJoCo.

    Args:
        stage: The bodies and their places.
        time_step: Seconds.
        smooth: True if nothing touches.

    Raises:
        MissingExtraError: MuJoCo is not installed.
        SettingsError: No convex parts represent a body.
    """

    def __init__(self, stage: Stage, time_step: float, *, smooth: bool) -> None:
        mujoco = self._mujoco = import_mujoco()
        spec: Any = mujoco.MjSpec()
        spec.option.timestep = time_step
        spec.option.gravity = stage.gravity
        spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
        spec.option.impratio = _STIFFNESS_RATIO
        if smooth:
            spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
        self._meshes: dict[str, str] = {}
        contact = {
            # With a coefficient of zero, there are no tangential constraints to solve.
            "condim": 3 if stage.friction > 0.0 else 1,
            "friction": (stage.friction, 0.0, 0.0),
            "solref": (_STEPS_OF_SPRING * time_step, 1.0),
        }
        for item in stage.items:
            self._add(spec, item, contact)
        self._model = spec.compile()
        self._data = mujoco.MjData(self._model)
        self._time_step = time_step
        self._steps = 0
        self._moving = [item for item in stage.items if item.path is not None]
        self._ids = {
            item.name: mujoco.mj_name2id(self._model, mujoco.mjtObj.mjOBJ_BODY, item.name)
            for item in stage.items
        }
        for item in stage.items:
            if item.moves:
                self._start(item)
        mujoco.mj_forward(self._model, self._data)

    def _add(self, spec: Any, item: Item, contact: dict[str, Any]) -> None:
        mujoco = self._mujoco
        body = spec.worldbody.add_body(name=item.name)
        body.pos = item.pose[:3, 3]
        body.quat = self._quaternion(item.pose)
        if item.form.is_plane:
            body.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=(0.0, 0.0, 1.0), **contact)
            return
        body.mocap = item.path is not None
        for number, piece in enumerate(item.form.pieces):
            geometry: dict[str, Any] = {
                "pos": piece.pose[:3, 3],
                "quat": self._quaternion(piece.pose),
                **contact,
            }
            size = (*piece.size, 0.0, 0.0, 0.0)[:3]
            match piece.kind:
                case "box":
                    geometry |= {"type": mujoco.mjtGeom.mjGEOM_BOX, "size": size}
                case "ellipsoid":
                    geometry |= {"type": mujoco.mjtGeom.mjGEOM_ELLIPSOID, "size": size}
                case "sphere":
                    geometry |= {"type": mujoco.mjtGeom.mjGEOM_SPHERE, "size": size}
                case "capsule" | "cylinder":
                    kind = mujoco.mjtGeom
                    chosen = (
                        kind.mjGEOM_CAPSULE if piece.kind == "capsule" else kind.mjGEOM_CYLINDER
                    )
                    geometry |= {"type": chosen, "size": (size[0], 0.5 * size[1], 0.0)}
                case "hull":
                    geometry |= {
                        "type": mujoco.mjtGeom.mjGEOM_MESH,
                        "meshname": self._add_mesh(spec, item.form, number),
                    }
            body.add_geom(**geometry)
        if not item.form.pieces:
            raise SettingsError(f"no convex parts represent {item.form.name!r}")
        if not item.moves:
            return
        mass = matter(item.form, item.mass)
        inertia = mass.inertia
        body.explicitinertial = True
        body.mass = mass.mass
        body.ipos = mass.center_of_mass
        body.fullinertia = (*np.diag(inertia), inertia[0, 1], inertia[0, 2], inertia[1, 2])
        if item.joint is None:
            body.add_freejoint()
        else:
            kinds = {
                "hinge": mujoco.mjtJoint.mjJNT_HINGE,
                "slider": mujoco.mjtJoint.mjJNT_SLIDE,
                "point": mujoco.mjtJoint.mjJNT_BALL,
            }
            rotation = item.pose[:3, :3]
            body.add_joint(
                type=kinds[item.joint.kind],
                axis=rotation.T @ item.joint.axis,
                pos=rotation.T @ (np.array(item.joint.at) - item.pose[:3, 3]),
            )

    def _add_mesh(self, spec: Any, form: Form, number: int) -> str:
        key = f"{form.name} {number}"
        if key not in self._meshes:
            self._meshes[key] = f"mesh {len(self._meshes)}"
            points = form.pieces[number].points
            assert points is not None
            spec.add_mesh(name=self._meshes[key]).uservert = points.ravel().tolist()
        return self._meshes[key]

    def _quaternion(self, pose: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the rotation of a pose as a quaternion, wxyz."""
        quaternion = np.zeros(4)
        self._mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(pose[:3, :3]).ravel())
        return quaternion

    def _start(self, item: Item) -> None:
        """Set velocities; poses are already in the specification."""
        model, data = self._model, self._data
        number = self._ids[item.name]
        place = model.jnt_dofadr[model.body_jntadr[number]]
        rotation = item.pose[:3, :3]
        if item.joint is None:
            center = rotation @ matter(item.form, 1.0).center_of_mass
            # A free joint's linear velocity is that of the body's origin; its spin is in the body's
            # frame.
            data.qvel[place : place + 3] = np.array(item.velocity) - np.cross(item.spin, center)
            data.qvel[place + 3 : place + 6] = rotation.T @ item.spin
        elif item.joint.kind == "point":
            data.qvel[place : place + 3] = rotation.T @ item.spin
        else:
            moved = item.spin if item.joint.kind == "hinge" else item.velocity
            data.qvel[place] = np.dot(moved, item.joint.axis)
        if item.force != (0.0, 0.0, 0.0):
            data.xfrc_applied[number, :3] = item.force

    def step(self) -> bool:
        """Make a step; return False if MuJoCo reports a state that is not finite or too large."""
        self._steps += 1
        data, kinds = self._data, self._mujoco.mjtWarning
        for item in self._moving:
            assert item.path is not None
            pose = item.path(self._steps * self._time_step)
            place = self._model.body_mocapid[self._ids[item.name]]
            data.mocap_pos[place] = pose[:3, 3]
            data.mocap_quat[place] = self._quaternion(pose)
        self._mujoco.mj_step(self._model, data)
        self._mujoco.mj_kinematics(self._model, data)
        self._mujoco.mj_comPos(self._model, data)
        bad = (kinds.mjWARN_BADQPOS, kinds.mjWARN_BADQVEL, kinds.mjWARN_BADQACC)
        return all(data.warning[int(kind)].number == 0 for kind in bad)

    def state(
        self, name: str
    ) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
        """Return a body's ``world_from_body``, (4, 4), velocity of its center, and spin, (3,)."""
        number = self._ids[name]
        pose = np.eye(4)
        pose[:3, :3] = self._data.xmat[number].reshape(3, 3)
        pose[:3, 3] = self._data.xpos[number]
        velocity = np.zeros(6)
        self._mujoco.mj_objectVelocity(
            self._model, self._data, self._mujoco.mjtObj.mjOBJ_BODY, number, velocity, 0
        )
        return pose, velocity[3:].copy(), velocity[:3].copy()
