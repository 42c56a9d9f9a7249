"""Bunny on bunny: the narrow phase of two meshes that touch, fall or rest, with every method."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from voxshell.base.arguments import as_integer, as_positive
from voxshell.errors import SettingsError
from voxshell.measuring.timing import pinned
from voxshell.measuring.touching_poses import find_poses_between
from voxshell.model.model import Model
from voxshell.query.queries import collide
from voxshell.simulation.world import World

from voxshell_studies.bunny import build_all_shapes
from voxshell_studies.part import Part
from voxshell_studies.scenes.bunny import BunnySettings, find_bunny
from voxshell_studies.scenes.drop import METHODS, DropSettings
from voxshell_studies.scenes.stack import StackSettings, build_bunny_world
from voxshell_studies.timing import STAGES, time_poses

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from numpy.typing import NDArray
    from voxshell.simulation.body_shapes import Inertia

    from voxshell_studies.part import Columns, Tables
    from voxshell_studies.scenes.drop import DropShapes, Method

PAIRED = ("vps-fine", "vps-coarse", "gimpact", "hull", "decomposition")
"""Keys of the methods that support two copies of the same body."""

QUICK = ("vps-fine", "vps-coarse", "hull", "decomposition")
"""Those whose steps take microseconds. They alternate within milliseconds, so that changes of the
machine's speed do not affect their ratios. At rest, GImpact would take minutes, at 0.4 s per
step."""

QUICK_WORLDS: dict[str, tuple[str, dict[str, Any]]] = {key: (key, {}) for key in QUICK}
"""For each key, a method and arguments of its World that differ from the method's own."""

UNFOLLOWED = "vps-fine-unfollowed"
"""Key of the fine shell in falls without CCD for models, because hulls have none."""

GRAVITY = 9.81
"""Gravity of falls, m/s2."""

FALL_SECONDS = 1.0
"""Seconds after which a body has slid off the other, or rests on it."""

FALL_HEIGHT = 1.4
"""Initial distance between the centers, as a fraction of their size."""

UNTIMED_STEPS = 10
"""Untimed steps of a resting or falling pair, which warm up caches."""


@dataclass(frozen=True)
class PairSettings(DropSettings):
    """Settings of the pair.

    Attributes:
        mesh: Path of another mesh; the bunny by default.
        poses: Number of poses, in any orientation and direction.
        least_depth, most_depth: Displacement after the first touch, meters.
        steps_a_pose: Steps at each pose, the first untimed: as in a simulation, a step is near the
            one before.
        drift: Displacement between these steps, meters.
        repeats: Number of times that all poses are timed.
        turns: Number of turns of :data:`QUICK` methods in each repeat.
        seed: Seed of the poses, of the falls and of the stack.
        rest_seconds: Age of a stack of five bunnies when its poses are taken.
        rest_steps: Number of its steps that are timed, one pair after another.
        falls: Number of falls of one body on the other.
        fall_steps: Largest number of timed steps in which they touch.
    """

    mesh: str = ""
    poses: int = 60
    least_depth: float = 0.0005
    most_depth: float = 0.002
    steps_a_pose: int = 4
    drift: float = 0.0001
    repeats: int = 5
    turns: int = 5
    seed: int = 53
    rest_seconds: float = 3.0
    rest_steps: int = 40
    falls: int = 10
    fall_steps: int = 60

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("least_depth", "most_depth", "drift", "rest_seconds"):
            as_positive(getattr(self, name), name)
        for name in ("poses", "repeats", "turns", "falls"):
            as_integer(getattr(self, name), name, 1, 100_000)
        as_integer(self.steps_a_pose, "steps_a_pose", 2, 1000)
        as_integer(self.rest_steps, "rest_steps", 2 * UNTIMED_STEPS, 100_000)
        as_integer(self.fall_steps, "fall_steps", 1, 100_000)
        if self.most_depth < self.least_depth:
            raise SettingsError("most_depth must be at least least_depth")


def plan(settings: PairSettings) -> list[Part]:
    """Return parts for bodies that touch, fall and rest, with all methods in equal poses."""
    touching = Part(
        "times",
        time_methods,
        {"settings": settings},
        timed=True,
        cost=10.0 + 0.01 * settings.poses * settings.repeats,
    )
    resting = Part("at-rest", time_at_rest, {"settings": settings}, timed=True, cost=15.0)
    falling = Part("falling", time_falling, {"settings": settings}, timed=True, cost=15.0)
    return [touching, falling, resting] if rests(settings) else [touching, falling]


def rests(settings: PairSettings) -> bool:
    """Return whether a stack of such bodies stands; this is known for bunnies of one size."""
    return settings.mesh == "" and settings.size == BunnySettings().size


def time_methods(settings: PairSettings) -> Tables:
    """Time every pose.

    Returns:
        "times": seconds of the narrow phase in Bullet, of a model's stages of it ("METHOD-STAGE"),
        and of yes/no queries beside coal's; "contacts": how many, and the deepest.
    """
    shapes = build_all_shapes(settings, Path(settings.mesh) if settings.mesh else find_bunny())
    model = shapes.bodies["vps-fine"]
    assert isinstance(model, Model)
    poses = find_poses_between(
        model, settings.poses, settings.least_depth, settings.most_depth, settings.seed
    )
    rows: dict[str, list[Any]] = {"method": [], "turn": [], "pose": [], "seconds": []}
    asks = _make_queries(model)
    with pinned():
        for turn in range(settings.repeats * settings.turns):
            is_full = turn % settings.turns == 0
            for method in (each for each in METHODS if each.key in (PAIRED if is_full else QUICK)):
                times = _time_in_world(settings, shapes, method, poses)
                _append(rows, method.key, turn, times["narrow_phase"])
                for stage in STAGES if method.is_model else ():
                    _append(rows, f"{method.key}-{stage}", turn, times[stage])
            for name, ask in asks.items() if is_full else ():
                _append(rows, name, turn, _time_queries(ask, poses))
    return {
        "times": {name: np.array(values) for name, values in rows.items()},
        "contacts": _count_contacts(settings, shapes, poses),
    }


def time_at_rest(settings: PairSettings) -> Tables:
    """Time the pairs of a standing stack, step by step.

    Returns:
        "times": seconds as of :func:`time_methods`, medians over the steps; "pose" numbers the
        pairs, the lowest first.
    """
    shapes = build_all_shapes(settings, find_bunny())
    model = shapes.bodies["vps-fine"]
    assert isinstance(model, Model)
    pairs = find_resting_poses(settings, model)
    resting = [(poses, np.zeros((len(poses), 2, 3))) for poses in pairs]
    return _time_states(
        settings, shapes, QUICK_WORLDS, resting, 0.0, lambda times: [np.median(times)]
    )


def time_falling(settings: PairSettings) -> Tables:
    """Time the steps in which a body that falls on the other touches it.

    Returns:
        "times": seconds as of :func:`time_methods`, of UNFOLLOWED, too; "pose" numbers the steps of
        all falls.
    """
    shapes = build_all_shapes(settings, Path(settings.mesh) if settings.mesh else find_bunny())
    model = shapes.bodies["vps-fine"]
    assert isinstance(model, Model)
    falls = find_falls(settings, model, shapes.mass_properties)
    warm = [[np.concatenate([x[:1].repeat(UNTIMED_STEPS, 0), x]) for x in fall] for fall in falls]
    worlds = QUICK_WORLDS | {UNFOLLOWED: ("vps-fine", {"ccd_motion_threshold": math.inf})}
    return _time_states(settings, shapes, worlds, warm, GRAVITY, lambda times: times)


def _time_states(
    settings: PairSettings,
    shapes: DropShapes,
    worlds: Mapping[str, tuple[str, Mapping[str, Any]]],
    sequences: Sequence[Sequence[NDArray[np.float64]]],
    gravity: float,
    reduce: Callable[[NDArray[np.float64]], Sequence[float] | NDArray[np.float64]],
) -> Tables:
    """Time methods in turn.

    Args:
        settings: Settings of the experiment.
        shapes: Shapes of the methods.
        worlds: For each key of times, the key of a method and more arguments of its World.
        sequences: Poses and velocities as in :func:`voxshell_studies.timing.time_poses`, of
            consecutive steps; the first UNTIMED_STEPS are left out.
        gravity: Downward, m/s2.
        reduce: Reduces the times of a sequence to what is kept.
    """
    rows: dict[str, list[Any]] = {"method": [], "turn": [], "pose": [], "seconds": []}
    with pinned():
        for turn in range(settings.repeats * settings.turns):
            for key, (of_method, arguments) in worlds.items():
                method = next(each for each in METHODS if each.key == of_method)
                times = []
                for poses, velocities in sequences:
                    world, body = _build_world(
                        settings, shapes, method, poses[0], gravity, **arguments
                    )
                    times.append(time_poses(world, body, poses, velocities)[UNTIMED_STEPS:])
                for name in ("narrow_phase", *(STAGES if method.is_model else ())):
                    kept = np.concatenate([reduce(of_one[name]) for of_one in times])
                    _append(rows, key if name == "narrow_phase" else f"{key}-{name}", turn, kept)
    return {"times": {name: np.array(values) for name, values in rows.items()}}


def find_falls(
    settings: PairSettings, model: Model, inertia: Inertia
) -> list[tuple[NDArray[np.float64], NDArray[np.float64]]]:
    """Simulate falls from any orientation.

    Args:
        settings: Settings of the experiment.
        model: Model of both bodies; one is fixed.
        inertia: Inertia of the other, as :meth:`voxshell.World.add` takes it.

    Returns:
        For each fall in which they touch, poses and velocities as in
        :func:`voxshell_studies.timing.time_poses`, before the steps in which they touch.
    """
    from trimesh.transformations import random_rotation_matrix

    rng = np.random.default_rng(settings.seed)
    middle = model.bounds.mean(axis=0)
    falls = []
    for _ in range(settings.falls):
        world = World(
            shell="fewest",
            gravity=(0.0, 0.0, -GRAVITY),
            time_step=1.0 / settings.rate,
            sleeping=False,
        )
        world.add(model, mass=0.0)
        pose = random_rotation_matrix(rng.random(3))
        offset = settings.size * np.array([*rng.uniform(-0.2, 0.2, 2), FALL_HEIGHT])
        pose[:3, 3] = middle + offset - pose[:3, :3] @ middle
        body = world.add(model, mass=settings.mass, pose=pose, inertia=inertia)
        poses, velocities = [], []
        for _ in range(round(FALL_SECONDS * settings.rate)):
            pose, velocity = body.pose, (body.linear_velocity, body.angular_velocity)
            world.step()
            if len(world.contacts()):
                poses.append(pose)
                velocities.append(velocity)
            if len(poses) == settings.fall_steps:
                break
        if poses:
            falls.append((np.array(poses), np.array(velocities)))
    if not falls:
        raise SettingsError(f"the bodies touch in none of {settings.falls} falls")
    return falls


def find_resting_poses(settings: PairSettings, model: Model) -> NDArray[np.float64]:
    """Return poses in a standing stack relative to the bunny below, (pairs, steps, 4, 4).

    Args:
        settings: Settings of the experiment.
        model: Model of a bunny, whose frame the poses use.
    """
    world, bodies = build_bunny_world(StackSettings(rate=settings.rate), seed=settings.seed)
    stacked_from_model = np.eye(4)
    stacked = BunnySettings().build_model()
    stacked_from_model[:3, 3] = stacked.bounds.mean(axis=0) - model.bounds.mean(axis=0)
    world.step(round(settings.rest_seconds * settings.rate))
    poses = np.zeros((len(bodies) - 1, settings.rest_steps, 4, 4))
    for step in range(settings.rest_steps):
        world.step()
        placed = [body.pose @ stacked_from_model for body in bodies]
        for pair, (below, above) in enumerate(pairwise(placed)):
            poses[pair, step] = np.linalg.inv(below) @ above
    return poses


def _build_world(
    settings: PairSettings,
    shapes: DropShapes,
    method: Method,
    pose: Any,
    gravity: float = 0.0,
    **arguments: Any,
) -> Any:
    world = World(
        shell="fewest",
        gravity=(0.0, 0.0, -gravity),
        time_step=1.0 / settings.rate,
        sleeping=False,
        **method.solver,
        **arguments,
    )
    shape = shapes.bodies[method.key]
    world.add(shape, mass=0.0)
    body = world.add(shape, mass=settings.mass, pose=pose, inertia=shapes.mass_properties)
    return world, body


def _time_in_world(
    settings: PairSettings, shapes: DropShapes, method: Method, poses: NDArray[np.float64]
) -> dict[str, NDArray[np.float64]]:
    """Return medians of the narrow phase and its stages over the steps at each pose, (poses,)."""
    world, body = _build_world(settings, shapes, method, poses[0])
    near = np.repeat(poses, settings.steps_a_pose, axis=0)
    # Back and forth, so that the depth stays the same.
    near[:, :3, 3] += settings.drift * (np.arange(len(near)) % 2)[:, None] / np.sqrt(3.0)
    times = time_poses(world, body, near)
    return {
        name: np.median(times[name].reshape(len(poses), -1)[:, 1:], axis=1)
        for name in ("narrow_phase", *STAGES)
    }


def _count_contacts(
    settings: PairSettings, shapes: DropShapes, poses: NDArray[np.float64]
) -> Columns:
    """Return contact points and largest depth, meters, for each method and pose."""
    keys, counts, depths = [], [], []
    for method in (each for each in METHODS if each.key in PAIRED):
        world, body = _build_world(settings, shapes, method, poses[0])
        for pose in poses:
            body.pose = pose
            body.linear_velocity = body.angular_velocity = (0.0, 0.0, 0.0)
            world.step()
            found = world.contacts()
            keys.append(method.key)
            counts.append(len(found))
            depths.append(max(float(found["depth"].max(initial=0.0)), 0.0))
    return {"method": np.array(keys), "contacts": np.array(counts), "depth": np.array(depths)}


def _make_queries(model: Model) -> dict[str, Callable[[NDArray[np.float64]], object]]:
    """Return yes/no queries of the pair: ours, and coal's if it is installed."""
    queries: dict[str, Callable[[NDArray[np.float64]], object]] = {
        "collide": lambda pose: collide(model, model, None, pose, shell="a")
    }
    try:
        import coal  # pyright: ignore[reportMissingImports]
    except ImportError:
        return queries
    tree = coal.BVHModelOBBRSS()
    tree.beginModel(len(model.mesh.faces), len(model.mesh.vertices))
    vertices = coal.StdVec_Vec3s()
    vertices.extend(np.asarray(model.mesh.vertices, dtype=float))
    triangles = coal.StdVec_Triangle()
    triangles.extend([coal.Triangle(*(int(i) for i in face)) for face in model.mesh.faces])
    tree.addSubModel(vertices, triangles)
    tree.endModel()
    fixed, request = coal.Transform3s(), coal.CollisionRequest()
    # Settings that only distances and contacts need would make it several times slower.
    request.break_distance = request.distance_upper_bound = 0.0

    def ask(pose: NDArray[np.float64]) -> object:
        moved = coal.Transform3s(pose[:3, :3], pose[:3, 3])
        return coal.collide(tree, fixed, tree, moved, request, coal.CollisionResult())

    queries["coal"] = ask
    return queries


def _time_queries(
    ask: Callable[[NDArray[np.float64]], object], poses: NDArray[np.float64]
) -> NDArray[np.float64]:
    seconds = np.zeros(len(poses))
    for i, pose in enumerate(poses):
        start = time.perf_counter()
        ask(pose)
        seconds[i] = time.perf_counter() - start
    return seconds


def _append(rows: dict[str, list[Any]], name: str, turn: int, seconds: NDArray) -> None:
    rows["method"] += [name] * len(seconds)
    rows["turn"] += [turn] * len(seconds)
    rows["pose"] += range(len(seconds))
    rows["seconds"] += seconds.tolist()
