"""Drake's hydroelastic contact: surfaces of equal pressure, without depths."""

from __future__ import annotations

from importlib import metadata
from typing import TYPE_CHECKING, Any

import numpy as np

from voxshell_studies.peers.protocol import load_library, seconds_of

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from voxshell.model.meshes import Mesh

    from voxshell_studies.peers.protocol import Case, Job, Other

MODULUS = 1e7
"""Hydroelastic modulus of compliant bodies, pascals: the body sinks by micrometers."""

SLAB = 0.05
"""Thickness of the compliant layer of a half-space, meters."""

RESOLUTION_HINT = 0.01
"""Longest edge of the meshes that Drake makes from shapes, meters."""

FRICTION = 0.5
"""Friction, equal to that of the other peers' bodies."""


def set_up(job: Job, variant: str) -> Drake:
    """Return a contender that calls ``ComputeContactSurfaces``; ``variant`` is not used."""
    return Drake(job)


class Drake:
    """The body as a rigid mesh; the other bodies are compliant."""

    timed = "ComputeContactSurfaces called from Python, polygons"

    def __init__(self, job: Job) -> None:
        self._drake = load_library("pydrake.all", "drake")
        self.version = metadata.version("drake")
        self.settings: dict[str, object] = {
            "modulus": MODULUS,
            "resolution_hint": RESOLUTION_HINT,
            "body": "rigid mesh",
            "pairs": "the other body is compliant, which Drake makes of its convex hull",
        }
        self._job = job
        drake = self._drake
        file = drake.MemoryFile(
            contents=_describe_obj(job.mesh), extension=".obj", filename_hint="body.obj"
        )
        self._mesh = drake.Mesh(mesh_data=drake.InMemoryMesh(mesh_file=file))

    def meet(self, case: Case) -> _Query:
        """Return the pair of a case."""
        drake = self._drake
        scene = drake.SceneGraph()
        source = scene.RegisterSource("pair")
        frames = [scene.RegisterFrame(source, drake.GeometryFrame(name)) for name in ("a", "b")]
        for frame, shape, properties in (
            (frames[0], self._mesh, self._rigid()),
            (frames[1], self._shape(case.other), self._compliant(case.other)),
        ):
            geometry = scene.RegisterGeometry(
                source, frame, drake.GeometryInstance(drake.RigidTransform(), shape, "shape")
            )
            scene.AssignRole(source, geometry, properties)
        return _Query(drake, scene, source, frames, case.other_pose)

    def drop(self, other: Other, rate: float) -> _Fall:
        """Return the body above the plane or the box."""
        drake = self._drake
        builder = drake.DiagramBuilder()
        plant, _ = drake.AddMultibodyPlantSceneGraph(builder, time_step=1.0 / rate)
        plant.set_contact_model(drake.ContactModel.kHydroelastic)
        matter = self._job.mass_properties
        inertia = matter.inertia
        moments = drake.UnitInertia(
            *(np.diag(inertia) / matter.mass),
            *(np.array((inertia[0, 1], inertia[0, 2], inertia[1, 2])) / matter.mass),
        )
        body = plant.AddRigidBody(
            "body", drake.SpatialInertia(matter.mass, matter.center_of_mass, moments)
        )
        friction = drake.CoulombFriction(FRICTION, FRICTION)
        rigid, compliant = self._rigid(), self._compliant(other)
        for properties in (rigid, compliant):
            properties.AddProperty("material", "coulomb_friction", friction)
        plant.RegisterCollisionGeometry(body, drake.RigidTransform(), self._mesh, "body", rigid)
        below = np.eye(4)
        below[2, 3] = -self._job.box_half_extents[2] if other == "box" else 0.0
        plant.RegisterCollisionGeometry(
            plant.world_body(),
            drake.RigidTransform(below),
            self._shape(other),
            "ground",
            compliant,
        )
        plant.Finalize()
        diagram = builder.Build()
        simulator = drake.Simulator(diagram)
        context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())
        plant.SetFreeBodyPose(context, body, drake.RigidTransform(self._job.drop_pose))
        return _Fall(simulator, plant, body, context, 1.0 / rate)

    def _shape(self, other: Other) -> Any:
        match other:
            case "plane":
                return self._drake.HalfSpace()
            case "box":
                return self._drake.Box(*(2.0 * half for half in self._job.box_half_extents))
            case "body":
                return self._mesh

    def _rigid(self) -> Any:
        properties = self._drake.ProximityProperties()
        self._drake.AddRigidHydroelasticProperties(RESOLUTION_HINT, properties)
        return properties

    def _compliant(self, other: Other) -> Any:
        properties = self._drake.ProximityProperties()
        if other == "plane":
            self._drake.AddCompliantHydroelasticPropertiesForHalfSpace(SLAB, MODULUS, properties)
        else:
            self._drake.AddCompliantHydroelasticProperties(RESOLUTION_HINT, MODULUS, properties)
        return properties


class _Query:
    def __init__(
        self,
        drake: Any,
        scene: Any,
        source: Any,
        frames: list[Any],
        other_pose: NDArray[np.float64],
    ) -> None:
        self._drake = drake
        self._scene = scene
        self._source = source
        self._frames = frames
        self._other_pose = drake.RigidTransform(other_pose)
        self._context = scene.CreateDefaultContext()
        self._surfaces: list[Any] = []

    def ask(self, pose: NDArray[np.float64]) -> float:
        poses = self._drake.FramePoseVector()
        poses.set_value(self._frames[0], self._drake.RigidTransform(pose))
        poses.set_value(self._frames[1], self._other_pose)
        self._scene.get_source_pose_port(self._source).FixValue(self._context, poses)
        query = self._scene.get_query_output_port().Eval(self._context)
        polygons = self._drake.HydroelasticContactRepresentation.kPolygon

        def find() -> None:
            self._surfaces = query.ComputeContactSurfaces(polygons)

        return seconds_of(find)

    def answer(self) -> tuple[int, float | None]:
        return sum(surface.num_faces() for surface in self._surfaces), None


class _Fall:
    def __init__(self, simulator: Any, plant: Any, body: Any, context: Any, time_step: float):
        self._simulator = simulator
        self._plant = plant
        self._body = body
        self._context = context
        self._time_step = time_step
        self._steps = 0

    def step(self) -> NDArray[np.float64]:
        self._steps += 1
        self._simulator.AdvanceTo(self._steps * self._time_step)
        pose = self._plant.EvalBodyPoseInWorld(self._context, self._body)
        return pose.GetAsMatrix4()


def _describe_obj(mesh: Mesh) -> str:
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh.vertices.tolist()]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in mesh.faces.tolist()]
    return "\n".join(lines) + "\n"
