"""Growth of the time of a step with the number of bodies: bunnies poured into a bin, by engine."""

from __future__ import annotations

import time
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from voxshell.measuring.timing import pinned
from voxshell.model.model import Model
from voxshell.simulation.world import World

from voxshell_studies.everyday.mujoco import import_mujoco
from voxshell_studies.scenes.drop import decompose
from voxshell_studies.scenes.pour import PourSettings, build_world, find_plates

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray
    from voxshell.simulation.body import Body

    from voxshell_studies.part import Tables

Engine = Literal["default", "uniform", "hulls", "mujoco"]

RATE = 200.0
"""Steps per second."""

SIDE = 0.45
"""Side of the floor for a hundred bodies, meters; it grows so that heaps have equal depth."""

LEAST_SIDE = 0.14
"""Side of the narrowest floor, meters: bunnies of 0.1 m would begin within the walls of narrower bins."""

DEPTH = 0.6
"""Height of the bin, meters."""

SETTLING, TIMED = 50, 100
"""Steps of the heap before it is timed, and while it is timed."""

_PAGE = 4096


def list_engines() -> list[Engine]:
    """Return the engines that can run: MuJoCo only if it is installed."""
    engines: list[Engine] = ["default", "uniform", "hulls"]
    if find_spec("mujoco") is not None:
        engines.append("mujoco")
    return engines


def settings_of(count: int) -> PourSettings:
    """Return settings of bunnies of 0.1 m in a bin of equal depth for any number."""
    side = max(SIDE * float(np.sqrt(count / 100)), LEAST_SIDE)
    return PourSettings(count=count, rate=RATE, bin_size=(side, side, DEPTH))


def time_bodies(engine: Engine, count: int, seconds: float) -> Tables:
    """Time steps while bodies are poured, and steps of the heap, on one core, without sleeping.

    Returns:
        "pouring" and "heap": seconds of each step and of its narrow phase, which MuJoCo does not
        tell; "end": contacts, median speed in m/s, mean height of the bodies in meters, bodies
        lost, and megabytes that the process took from the first step on. Of ours, "all_cores": the
        heap on all cores.
    """
    settings = settings_of(count)
    if engine == "mujoco":
        return _time_mujoco(settings, seconds)
    return _time_world(engine, settings, seconds)


# ---- worlds --------------------------------------------------------------------------------------


def _time_world(engine: Engine, settings: PourSettings, seconds: float) -> Tables:
    starts = settings.compute_starts()
    with pinned():
        world, bodies = build_heap(engine, settings, starts, threads=1)
        before = measure_memory()
        world.step(round(seconds * RATE))
        pouring = world.timings.copy()
        world.step(SETTLING)
        world.step(TIMED)
        heap = world.timings[-TIMED:].copy()
        contacts = len(world.contacts())
        memory = measure_memory() - before
        poses = np.array([body.pose for body in bodies])
        speeds = np.linalg.norm([body.linear_velocity for body in bodies], axis=1)
    tables = {
        "pouring": _columns(pouring["step"], pouring["narrow_phase"]),
        "heap": _columns(heap["step"], heap["narrow_phase"]),
        "end": _end(settings, poses, speeds, contacts, memory),
    }
    if engine != "hulls":
        again, others = build_heap(engine, settings, poses, threads=None)
        for body, known in zip(others, bodies, strict=True):
            body.linear_velocity = known.linear_velocity
            body.angular_velocity = known.angular_velocity
        again.step(SETTLING)
        again.step(TIMED)
        timings = again.timings[-TIMED:]
        tables["all_cores"] = _columns(timings["step"], timings["narrow_phase"])
    return tables


def build_heap(
    engine: Engine, settings: PourSettings, poses: NDArray[np.float64], threads: int | None
) -> tuple[World, list[Body]]:
    """Return the bin and the bodies in given poses, (count, 4, 4). Nothing sleeps.

    Args:
        engine: Any engine except "mujoco".
        settings: Settings of the bodies and the bin.
        poses: ``world_from_body``, meters.
        threads: Threads of worlds of models; None: one per core. Hulls use one.
    """
    if engine == "hulls":
        return build_world(settings, "decomposition", poses)
    is_uniform = engine == "uniform"
    body, container = settings.build_mesh(), settings.build_bin()
    if is_uniform:
        models = (
            settings.build_model(),
            Model.from_mesh(container, voxel_size=settings.bin_voxel_size),
        )
    else:
        models = Model.from_mesh(body), Model.from_mesh(container)
    world = World(
        shell="fewest" if is_uniform else "auto",
        time_step=1.0 / settings.rate,
        sleeping=False,
        threads=threads,
    )
    world.add(models[1], mass=0.0)
    matter = models[0].mass_properties(settings.mass)
    return world, [
        world.add(models[0], mass=settings.mass, pose=pose, inertia=matter) for pose in poses
    ]


# ---- MuJoCo --------------------------------------------------------------------------------------


def _time_mujoco(settings: PourSettings, seconds: float) -> Tables:
    """Time MuJoCo at its defaults, with equal hulls, masses, inertias, friction and bin."""
    mujoco = import_mujoco()
    spec: Any = mujoco.MjSpec()
    spec.option.timestep = 1.0 / settings.rate
    friction = (0.5, 0.005, 0.0001)
    for middle, half in find_plates(settings):
        spec.worldbody.add_geom(
            type=mujoco.mjtGeom.mjGEOM_BOX, pos=middle, size=half, friction=friction
        )
    hulls = decompose(settings.build_mesh()).hulls
    for number, points in enumerate(hulls):
        spec.add_mesh(name=f"hull {number}").uservert = points.ravel().tolist()
    matter = settings.build_model().mass_properties(settings.mass)
    inertia = matter.inertia
    for pose in settings.compute_starts():
        body = spec.worldbody.add_body()
        body.pos = pose[:3, 3]
        quaternion = np.zeros(4)
        mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(pose[:3, :3]).ravel())
        body.quat = quaternion
        body.explicitinertial = True
        body.mass = matter.mass
        body.ipos = matter.center_of_mass
        body.fullinertia = (*np.diag(inertia), inertia[0, 1], inertia[0, 2], inertia[1, 2])
        body.add_freejoint()
        for number in range(len(hulls)):
            body.add_geom(
                type=mujoco.mjtGeom.mjGEOM_MESH, meshname=f"hull {number}", friction=friction
            )
    model = spec.compile()
    data = mujoco.MjData(model)
    with pinned():
        before = measure_memory()
        pouring = _clock(round(seconds * RATE), lambda: mujoco.mj_step(model, data))
        heap = _clock(SETTLING + TIMED, lambda: mujoco.mj_step(model, data))[SETTLING:]
        memory = measure_memory() - before
    speeds = np.linalg.norm(data.qvel.reshape(-1, 6)[:, :3], axis=1)
    poses = np.tile(np.eye(4), (settings.count, 1, 1))
    poses[:, :3, 3] = data.qpos.reshape(-1, 7)[:, :3]
    return {
        "pouring": _columns(pouring, np.full(len(pouring), np.nan)),
        "heap": _columns(heap, np.full(len(heap), np.nan)),
        "end": _end(settings, poses, speeds, int(data.ncon), memory),
    }


def _clock(steps: int, step: Callable[[], object]) -> NDArray[np.float64]:
    seconds = np.zeros(steps)
    for i in range(steps):
        start = time.perf_counter()
        step()
        seconds[i] = time.perf_counter() - start
    return seconds


# ---- tables --------------------------------------------------------------------------------------


def _columns(
    step: Sequence[float] | NDArray[np.float64], narrow: NDArray[np.float64]
) -> dict[str, NDArray[np.float64]]:
    return {"step": np.array(step), "narrow_phase": np.array(narrow)}


def _end(
    settings: PourSettings,
    poses: NDArray[np.float64],
    speeds: NDArray[np.float64],
    contacts: int,
    memory: float,
) -> dict[str, NDArray[np.float64]]:
    lost = int(settings.find_lost(poses).sum())
    values = {
        "contacts": contacts,
        "speed": float(np.median(speeds)),
        "height": float(poses[:, 2, 3].mean()),
        "lost": lost,
        "megabytes": memory,
    }
    return {name: np.array([value], dtype=np.float64) for name, value in values.items()}


def measure_memory() -> float:
    """Return the memory of this process, megabytes; NaN if the system does not report it."""
    status = Path("/proc/self/statm")
    if not status.exists():
        return float("nan")
    return int(status.read_text(encoding="ascii").split()[1]) * _PAGE / 1e6
