"""Building the world of a scene file: meshes, bodies and joints."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from voxshell.base.user_warnings import warn_user
from voxshell.errors import MemoryLimitError
from voxshell.model.meshes import MeshWarning, doubt_unit, read_mesh
from voxshell.model.model import Model
from voxshell.model.shapes import Box, Capsule, Cone, Cylinder, Plane, Sphere
from voxshell.simulation.comparison_shapes import ConvexHull, GImpact
from voxshell.simulation.compound import Compound
from voxshell.simulation.world import World

if TYPE_CHECKING:
    from collections.abc import Callable

    from voxshell.scenes.body_settings import BodySettings, PartSettings
    from voxshell.scenes.scene_file import Scene
    from voxshell.scenes.scene_settings import MeshSettings
    from voxshell.simulation.body_shapes import Shape
    from voxshell.simulation.compound import Part

_BUILD_NAMES = (
    "tolerance",
    "voxel_size",
    "resolution",
    "point_spacing",
    "target_points",
    "sign",
    "open",
    "sheet_thickness",
)
"""The settings of a mesh that :meth:`voxshell.Model.from_mesh` takes."""


def build_world(scene: Scene, progress: Callable[[str, float], object]) -> World:
    """Build the meshes and add bodies and joints with their names in the file.

    Args:
        scene: The scene.
        progress: Called with the name of the current stage and the completed fraction, 0 to 1.

    Raises:
        SettingsError: A mesh cannot be read or built, or a body or joint cannot be added. The
            message names file, line and key.
    """
    meshes: dict[str, Part] = {}
    for index, (name, settings) in enumerate(scene.meshes.items()):

        def report(stage: str, fraction: float, name: str = name, index: int = index) -> None:
            progress(f"{name}: {stage}" if stage else name, (index + fraction) / len(scene.meshes))

        try:
            with scene.naming("meshes", name, "file"):
                meshes[name] = _build_mesh(scene, settings, report)
        except MemoryLimitError as error:
            raise scene.describe_error(("meshes", name, "file"), str(error)) from error
    settings = scene.world
    with scene.naming("scene"):
        world = World(
            gravity=settings.gravity,
            time_step=1.0 / settings.rate,
            contact=settings.contact,
            shell=settings.shell,
            level=settings.level,
            solver=settings.solver,
            iterations=settings.iterations,
            sleeping=settings.sleeping,
            ccd_motion_threshold=settings.ccd_motion_threshold,
        )
    for name, body in scene.bodies.items():
        with scene.naming("bodies", name):
            added = world.add(
                _make_shape(body, meshes),
                mass=body.kilograms,
                motion=body.motion,
                pose=body.pose,
                inertia=body.inertia,
                material=body.material,
                surface_velocity=body.surface_velocity,
                linear_damping=body.linear_damping,
                angular_damping=body.angular_damping,
                group=body.group,
                mask=body.mask,
                name=name,
            )
            if body.kilograms > 0.0:
                added.linear_velocity = body.linear_velocity
                added.angular_velocity = body.angular_velocity
    bodies = {body.name: body for body in world.bodies}
    for name, joint in scene.joints.items():
        with scene.naming("joints", name):
            added = world.add_joint(
                joint.make_kind(),
                None if joint.parent is None else bodies[joint.parent],
                bodies[joint.child],
                world_from_joint=joint.place(scene.bodies[joint.child]),
                collide=joint.collide,
                name=name,
            )
            if joint.max_force is not None:
                if joint.target_velocity is not None:
                    added.set_target_velocity(joint.target_velocity, max_force=joint.max_force)
                elif joint.target_position is not None:
                    added.set_target_position(joint.target_position, max_force=joint.max_force)
    return world


def _build_mesh(
    scene: Scene, settings: MeshSettings, progress: Callable[[str, float], object]
) -> Part:
    path = scene.path.parent / settings.file
    if settings.collide_as == "model":
        sizes = {name: getattr(settings, name) for name in _BUILD_NAMES}
        return Model.from_mesh(path, scale=settings.scale, progress=progress, **sizes)
    progress("read", 0.0)
    scaled = read_mesh(path, settings.scale)
    if settings.scale is None and (doubt := doubt_unit(path, scaled.vertices)):
        warn_user(doubt, MeshWarning)
    return GImpact(scaled) if settings.collide_as == "gimpact" else ConvexHull(scaled.vertices)


def _make_shape(body: BodySettings, meshes: dict[str, Part]) -> Shape:
    if not body.parts:
        return _make_part(body, meshes)
    return Compound((cast("Part", _make_part(part, meshes)), part.pose) for part in body.parts)


def _make_part(part: PartSettings, meshes: dict[str, Part]) -> Part | Plane:
    if part.mesh is not None:
        return meshes[part.mesh]
    half_extents = part.half_extents or (0.0, 0.0, 0.0)
    radius, length, height = part.radius or 0.0, part.length or 0.0, part.height or 0.0
    match part.shape:
        case "box":
            return Box(half_extents)
        case "sphere":
            return Sphere(radius)
        case "capsule":
            return Capsule(radius, length)
        case "cylinder":
            return Cylinder(radius, length)
        case "cone":
            return Cone(radius, height)
        case _:
            normal = (0.0, 0.0, 1.0) if part.normal is None else part.normal
            return Plane(normal, 0.0 if part.offset is None else part.offset)
