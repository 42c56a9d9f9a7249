"""A body dropped on a ground: the bunny benchmark of the thesis (section 5.3).

The same drop is set up for models and for Bullet's own ways with a mesh, so that they can be
compared. World frame: z up, the ground's surface at z = 0.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from voxshell.base.arguments import as_integer, as_positive
from voxshell.errors import MeshError, MissingExtraError
from voxshell.model.meshes import Mesh, naming_file, read_mesh
from voxshell.model.model import Model
from voxshell.model.shapes import Box, Plane
from voxshell.simulation.body import Body
from voxshell.simulation.body_shapes import Shape, mesh_of
from voxshell.simulation.comparison_shapes import ConvexDecomposition, ConvexHull, GImpact
from voxshell.simulation.world import World

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray
    from voxshell.model.mass_properties import MassProperties
    from voxshell.model.meshes import MeshLike

Ground = Literal["voxels", "box", "plane"]
"""The block as a model, as Bullet's box, or an endless plane in its place."""

GROUND_HALF_EXTENTS = (0.3, 0.3, 0.05)
"""Of the block, meters: thicker than the way of a step at the speed of the drop, 16 mm."""

BULLET_SOLVER: dict[str, Any] = {"split_impulse_threshold": -0.04, "friction_directions": 1}
"""Bullet's defaults, as arguments of World, which its own shapes are simulated with."""


def choose_bullet_solver(method: str) -> dict[str, Any]:
    """Arguments of World with which a method of Bullet's does best.

    With contacts that resist sliding along one direction, GImpact is thrown off the block.
    """
    return BULLET_SOLVER | ({"friction_directions": 2} if method.startswith("gimpact") else {})


BULLET_MARGIN = 0.005
"""Collision margin of Bullet's own shapes, meters: the least of 1, 5, 10 and 20 mm with which all of
them stay on the block. They float by it."""


@dataclass(frozen=True)
class DropSettings:
    """Settings of the drop.

    Attributes:
        size: The mesh is scaled so that its longest side is this, meters.
        up: The mesh's axis that points up, "x", "y" or "z".
        height: Between the ground and the body's lowest point at the start, meters.
        rate: Steps a second.
        fine_points: Points of the fine shell.
        coarse_points: Points of the coarse shell.
        voxel_size: Of the fields of body and ground, meters.
        mass: Kilograms; the inertia is that of the surface, as in the thesis.

    Raises:
        SettingsError: A number is not above 0.
    """

    size: float = 0.2115
    up: Literal["x", "y", "z"] = "y"
    height: float = 0.5
    rate: float = 200.0
    fine_points: int = 35_596
    coarse_points: int = 799
    voxel_size: float = 0.002
    mass: float = 1.0

    def __post_init__(self) -> None:
        for name in ("size", "height", "rate", "voxel_size", "mass"):
            as_positive(getattr(self, name), name)
        for name in ("fine_points", "coarse_points"):
            as_integer(getattr(self, name), name, 1, 2**31 - 1)


@dataclass(frozen=True)
class Method:
    """One way to collide the body with the ground.

    Attributes:
        key: Short name, for data and the command line.
        label: For people.
        ground: What it lands on.
        thesis_ratio: Published narrow-phase time, as a multiple of the thesis' fine VPS; None where
            there is none.
        is_slow: Takes tens of milliseconds a step; may be run for fewer steps.
    """

    key: str
    label: str
    ground: Ground
    thesis_ratio: float | None = None
    is_slow: bool = False

    @property
    def is_model(self) -> bool:
        """Whether it is ours rather than one of Bullet's own."""
        return self.key.startswith("vps")

    @property
    def solver(self) -> dict[str, Any]:
        """As arguments of World: that with which the method does best."""
        return {} if self.is_model else choose_bullet_solver(self.key)


# Published (experiments of section 5.3): fine 0.71 ms, 137 times faster than GImpact, 339 times
# slower than GJK on the hull; coarse 0.102 ms, 1.3 times slower than the decomposition.
METHODS = (
    Method("vps-fine", "VPS fine", "voxels", 1.0),
    Method("vps-coarse", "VPS coarse", "voxels", 0.102 / 0.71),
    Method("vps-fine-plane", "VPS fine, plane", "plane"),
    Method("gimpact", "GImpact", "box", 137.0, is_slow=True),
    Method("gimpact-plane", "GImpact, plane", "plane"),
    Method("hull", "Convex hull", "box", 1.0 / 339.0),
    Method("decomposition", "Decomposition", "box", 0.102 / 1.3 / 0.71),
)


@dataclass(frozen=True)
class DropShapes:
    """Everything that takes time to build, once for all methods.

    Attributes:
        mesh: The scaled body.
        bodies: The body's shape by method key.
        grounds: The ground's shape by kind.
        mass_properties: Of the body, for every method.
    """

    mesh: Mesh
    bodies: dict[str, Shape]
    grounds: dict[Ground, Shape]
    mass_properties: MassProperties


def build_shapes(
    mesh: MeshLike,
    settings: DropSettings,
    methods: tuple[Method, ...] = METHODS,
    progress: Callable[[str, float], object] | None = None,
) -> DropShapes:
    """Makes the shapes that some methods need.

    Args:
        mesh: The body, closed; any unit, it is scaled.
        settings: Of the drop.
        methods: Those wanted.
        progress: Called with what is being made and the fraction of it that is done, 0 to 1.

    Raises:
        MeshError: The mesh cannot be used.
        SettingsError: A setting is out of range.
        MissingExtraError: The decomposition is wanted, but its library is not installed.
    """
    with naming_file(mesh):
        return _build_shapes(_scale(read_mesh(mesh), settings.size), settings, methods, progress)


def _build_shapes(
    scaled: Mesh,
    settings: DropSettings,
    methods: tuple[Method, ...],
    progress: Callable[[str, float], object] | None,
) -> DropShapes:
    keys = {method.key for method in methods}

    def stage(name: str) -> Callable[[str, float], None]:
        def report(part: str, fraction: float) -> None:
            if progress is not None:
                progress(f"{name}: {part}", fraction)

        return report

    def model(points: int, name: str) -> Model:
        return Model.from_mesh(
            scaled,
            voxel_size=settings.voxel_size,
            target_points=points,
            progress=stage(name),
        )

    fine = model(settings.fine_points, "fine model")
    bodies: dict[str, Shape] = {"vps-fine": fine, "vps-fine-plane": fine}
    if "vps-coarse" in keys:
        bodies["vps-coarse"] = model(settings.coarse_points, "coarse model")
    if "hull" in keys:
        bodies["hull"] = ConvexHull.sampled(scaled.vertices, margin=BULLET_MARGIN)
    if keys & {"gimpact", "gimpact-plane"}:
        bodies["gimpact"] = bodies["gimpact-plane"] = GImpact(scaled, margin=BULLET_MARGIN)
    if "decomposition" in keys:
        stage("convex decomposition")("V-HACD", 0.0)
        bodies["decomposition"] = decompose(scaled)
        stage("convex decomposition")("V-HACD", 1.0)

    block = Box(GROUND_HALF_EXTENTS)
    grounds: dict[Ground, Shape] = {"box": block, "plane": Plane()}
    if any(method.ground == "voxels" for method in methods):
        grounds["voxels"] = Model.from_mesh(
            mesh_of(block), voxel_size=settings.voxel_size, progress=stage("ground model")
        )
    return DropShapes(scaled, bodies, grounds, fine.mass_properties(settings.mass, "surface"))


def decompose(mesh: Mesh, *, hulls: int = 8, vertices: int = 100) -> ConvexDecomposition:
    """Splits a mesh into convex hulls with V-HACD, as many and as large as the thesis' (section 5.3).

    Raises:
        MissingExtraError: vhacdx is not installed.
        MeshError: V-HACD finds no hull.
    """
    try:
        from vhacdx import compute_vhacd
    except ImportError as error:
        raise MissingExtraError(
            "the convex decomposition needs vhacdx: pip install voxshell-studies"
        ) from error
    faces = np.column_stack([np.full(len(mesh.faces), 3, np.uint32), mesh.faces])
    parts = compute_vhacd(
        mesh.vertices, faces.ravel(), maxConvexHulls=hulls, maxNumVerticesPerCH=vertices
    )
    if not parts:
        raise MeshError("V-HACD found no convex part in the mesh")
    return ConvexDecomposition([points for points, _ in parts], margin=BULLET_MARGIN)


def build_world(
    shapes: DropShapes,
    method: Method,
    settings: DropSettings,
    *,
    rotation: NDArray[np.float64] | None = None,
    gravity: float = 9.81,
) -> tuple[World, Body]:
    """The drop at its first moment, and the body that falls. Nothing sleeps.

    Args:
        shapes: From :func:`build_shapes`.
        method: Which way the body and the ground collide.
        settings: Of the drop.
        rotation: (4, 4) ``world_from_body`` without a place; upright by default.
        gravity: m/s2, downward.
    """
    world = World(
        shell="fewest",
        gravity=(0.0, 0.0, -gravity),
        time_step=1.0 / settings.rate,
        sleeping=False,
        **method.solver,
    )
    ground = shapes.grounds[method.ground]
    pose = np.eye(4)
    if method.ground != "plane":
        pose[2, 3] = -GROUND_HALF_EXTENTS[2]
    world.add(ground, mass=0.0, pose=pose, name="ground")
    body = world.add(
        shapes.bodies[method.key],
        mass=settings.mass,
        pose=compute_start_pose(shapes.mesh, settings, rotation),
        inertia=shapes.mass_properties,
        name="body",
    )
    return world, body


def compute_start_pose(
    mesh: Mesh, settings: DropSettings, rotation: NDArray[np.float64] | None = None
) -> NDArray[np.float64]:
    """``world_from_body`` with the mesh's middle over the ground's, (4, 4).

    Args:
        mesh: The scaled body.
        settings: Of the drop.
        rotation: (4, 4); by default the one that turns the mesh's ``settings.up`` upward.
    """
    pose = np.eye(4)
    if rotation is not None:
        pose[:3, :3] = rotation[:3, :3]
    else:
        # Rows: the mesh's axes that become the world's x, y and z.
        pose[:3, :3] = {
            "x": [[0, 1, 0], [0, 0, 1], [1, 0, 0]],
            "y": [[1, 0, 0], [0, 0, -1], [0, 1, 0]],
            "z": np.eye(3),
        }[settings.up]
    upright = mesh.vertices @ pose[:3, :3].T
    low, high = upright.min(axis=0), upright.max(axis=0)
    pose[:2, 3] = -(low + high)[:2] / 2.0
    pose[2, 3] = settings.height - low[2]
    return pose


def _scale(mesh: Mesh, size: float) -> Mesh:
    if len(mesh.faces) == 0:
        raise MeshError("mesh has no triangles")
    used = mesh.vertices[np.unique(mesh.faces)]
    longest = float(np.ptp(used, axis=0).max())
    if not (np.isfinite(longest) and longest > 0.0):
        raise MeshError(f"mesh has no finite size: its longest side is {longest:g}")
    return Mesh(mesh.vertices * (size / longest), mesh.faces)
