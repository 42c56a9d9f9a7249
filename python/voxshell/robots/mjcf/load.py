"""Loading an MJCF file into a world."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

from voxshell.robots.assembly import Assembly, check_place
from voxshell.robots.lumps import find_lumps
from voxshell.robots.matter import complete_matter
from voxshell.robots.mjcf.carriers import share_matter
from voxshell.robots.mjcf.reading import read_mjcf
from voxshell.robots.shapes import MeshSettings, Shaper

if TYPE_CHECKING:
    import os

    from numpy.typing import ArrayLike

    from voxshell.robots.robot import Robot
    from voxshell.simulation.world import World


def load_mjcf(
    world: World,
    path: str | os.PathLike[str],
    *,
    pose: ArrayLike | None = None,
    voxel_size: float | None = None,
    resolution: int | None = None,
    mesh_as: Literal["model", "hull"] = "model",
    friction: float | None = None,
    self_collision: bool = True,
) -> Robot:
    """DOC"""
    world_from_file = check_place(world, pose, 0.5 if friction is None else friction)
    settings = MeshSettings(voxel_size, resolution, mesh_as)
    model = read_mjcf(path, world.gravity)
    robot, filters = model.robot, model.filters
    lump_of = find_lumps(robot)
    lumps = list(dict.fromkeys(lump_of.values()))
    static = {lump_of[root] for root in robot.roots}
    carriers = {lump_of[name] for name in model.carriers}
    matter = complete_matter(robot, (it for it in lumps if it not in static | carriers))
    share_matter(matter, model.carriers, lump_of)
    shaper = Shaper(robot, settings)
    assembly = Assembly(
        robot,
        lump_of,
        matter,
        {lump: shaper.shape_of(lump) for lump in lumps},
        world_from_file,
        friction=friction,
        apart=lambda meeting: filters.list_apart(lump_of, static, meeting, self_collision),
        joints_collide=True,
    )
    made = assembly.add(world)
    assembly.warn()
    return made
