"""What opens hostile files: functions of the package, and the command line."""

from __future__ import annotations

import functools
from collections.abc import Callable
from pathlib import Path

import numpy as np
import trimesh
import voxshell as vx

from .array_files import make_world

RESOLUTION = 12


def open_mesh(path: Path) -> None:
    model = vx.Model.from_mesh(path, resolution=RESOLUTION, threads=1, cache=False)
    ask(model)


def open_model(path: Path) -> None:
    ask(vx.Model.load(path))


def open_urdf(path: Path) -> None:
    open_robot(vx.load_urdf, path)


def open_mjcf(path: Path) -> None:
    open_robot(vx.load_mjcf, path)


def open_state(path: Path) -> None:
    state = vx.WorldState.load(path)
    world = make_world()
    before = [body.pose for body in world.bodies]
    try:
        world.restore_state(state)
    except vx.VoxshellError:
        assert np.array_equal(before, [body.pose for body in world.bodies]), "a part is restored"
        raise vx.StateError(f"{path}: of another scene") from None
    world.step(2)


def open_recording(path: Path) -> None:
    recording = vx.Recording.load(path)
    recording.save(path.with_name("again.npz"))


def open_robot(load: Callable[..., vx.Robot], path: Path) -> None:
    world = vx.World()
    try:
        robot = load(world, path, resolution=RESOLUTION)
    except vx.VoxshellError:
        assert not world.bodies, "a part of the robot is left in the world"
        raise
    world.step(2)
    for name, link in robot.links.items():
        assert np.isfinite(link.pose).all(), f"link {name} is nowhere: {link.pose}"


def ask(model: vx.Model) -> None:
    """Coarse questions, whose answers must be numbers."""
    low, high = model.bounds
    assert np.isfinite([low, high]).all(), f"bounds {low} to {high}"
    assert len(model.shell) > 0, "no points"
    pose = np.eye(4)
    pose[2, 3] = -(low[2] + high[2]) / 2
    contacts = vx.contacts(model, vx.Plane(), a_pose=pose)
    assert np.isfinite(contacts.depths).all(), "depths that are not finite"
    assert np.isfinite(model.field.sample(np.array([low, high, (low + high) / 2]))).all(), (
        "distances that are not finite"
    )


IN_PYTHON: dict[str, Callable[[Path], None]] = {
    "mesh": open_mesh,
    "model": open_model,
    "urdf": open_urdf,
    "mjcf": open_mjcf,
    "state": open_state,
    "recording": open_recording,
}
"""By entrance; the others are entrances of the command line alone."""


@functools.cache
def write_partner(folder: Path) -> Path:
    """A sound model for files that are opened beside one."""
    path = folder / "sound.vxs"
    vx.Model.from_mesh(trimesh.creation.box(), resolution=8, cache=False, threads=1).save(path)
    return path


ON_THE_COMMAND_LINE = ("mesh", "model", "scene", "poses", "settings")


def list_arguments(entrance: str, path: Path, shared: Path) -> list[str]:
    """Those of the command line that opens the file."""
    out = path.parent / "out"
    coarse = ["--resolution", str(RESOLUTION), "--threads", "1", "--no-cache"]
    match entrance:
        case "mesh":
            return ["build", f"{path}", "--output", f"{out}.vxs", *coarse]
        case "model":
            return ["query", f"{path}", "plane", "--json"]
        case "scene":
            return ["simulate", f"{path}", "--out", f"{out}", "--json"]
        case "poses":
            partner = str(write_partner(shared))
            return ["query", partner, partner, "--poses", f"{path}", "--json"]
        case _:
            return ["reproduce", "slope", "--quick", "--settings", f"{path}", "--out", f"{out}"]
