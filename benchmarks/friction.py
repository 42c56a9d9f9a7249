#!/usr/bin/env python3
"""Slides bodies down slopes and lets them run out, beside Coulomb's closed form.

Every case is a body of visible facets or of a scan, on a plane or a model slab, in one heading at one
rate, at the default settings of a World. The closed form is that of the time steps: a body that loses
mu g dt a step from v runs v^2 / (2 mu g) - v dt / 2 far.

    .venv/bin/python benchmarks/friction.py              # all cases; --quick: a tenth of them
    .venv/bin/python benchmarks/friction.py --solver sequential_impulse
    .venv/bin/python benchmarks/friction.py --creep 60   # adds how far bodies creep on a slope
    .venv/bin/python benchmarks/friction.py --cost       # instead: time of a step, beside Bullet's solver
"""

from __future__ import annotations

import argparse
import itertools
import math
from functools import cache

import numpy as np
import trimesh
import voxshell as vx
from sliding_bodies import MESHES, build, build_slab
from trimesh.creation import box, torus

GRAVITY = 9.81  # m/s2
RATES = (1000, 200, 60, 30)  # Hz
HEADINGS = (0.0, 22.5, 45.0, 67.0)  # degrees from the ground's x axis
GROUNDS = ("plane", "slab")


@cache
def standing(name: str) -> np.ndarray:
    """world_from_body of the body at rest on z = 0."""
    pose = np.eye(4)
    pose[2, 3] = -build(name).bounds[0, 2]
    if name != "bunny":
        return pose
    pose[2, 3] += 0.002
    world = vx.World(sleeping=False)
    world.add(vx.Plane(), mass=0, rolling_friction=0.016, spinning_friction=0.016)
    body = world.add(
        build(name), pose=pose, friction=1.0, rolling_friction=0.016, spinning_friction=0.016
    )
    world.step(1200)
    return body.pose


def place(
    name: str,
    ground: str,
    *,
    slope: float,
    heading: float,
    friction: float,
    rate: float,
    **settings,
) -> tuple[vx.World, vx.Body, np.ndarray]:
    """The body at rest on a ground whose gravity leans by `slope` toward `heading`, radians.

    Returns:
        World, body and the heading's unit vector.
    """
    along = np.array([math.cos(heading), math.sin(heading), 0.0])
    gravity = GRAVITY * (math.sin(slope) * along - math.cos(slope) * np.array([0.0, 0.0, 1.0]))
    world = vx.World(gravity=gravity, time_step=1.0 / rate, sleeping=False, **settings)
    world.add(vx.Plane() if ground == "plane" else build_slab(), mass=0, friction=1.0)
    pose = standing(name).copy()
    pose[:3, 3] -= 0.4 * along
    return world, world.add(build(name), mass=1.0, pose=pose, friction=friction), along


def slide(
    name: str, ground: str, *, slope: float = math.radians(35), friction: float = 0.5, rate, **k
):
    """Speed along the slope after 0.5 s from rest, of the exact one."""
    world, body, along = place(name, ground, slope=slope, friction=friction, rate=rate, **k)
    world.step(round(0.5 * rate))
    exact = 0.5 * GRAVITY * (math.sin(slope) - friction * math.cos(slope))
    return float(body.linear_velocity @ along) / exact


def stop(name: str, ground: str, *, speed: float = 1.0, friction: float = 0.5, rate, **k):
    """Way from `speed`, m/s, until it stands, of that of the same steps."""
    world, body, along = place(name, ground, slope=0.0, friction=friction, rate=rate, **k)
    world.step(round(0.2 * rate))
    start = center(body)
    body.linear_velocity = speed * along
    world.step(math.ceil(1.5 * speed / (friction * GRAVITY) * rate) + 5)
    return float((center(body) - start) @ along) / run_out(speed, friction, rate)


def center(body: vx.Body) -> np.ndarray:
    """The center of mass, meters, world frame."""
    return (body.pose @ [*body.shape.mass_properties(1.0).center_of_mass, 1.0])[:3]


def run_out(speed: float, friction: float, rate: float) -> float:
    """The sum of what a body that loses friction * g / rate a step moves, meters."""
    way = 0.0
    while speed > 0.0:
        speed -= friction * GRAVITY / rate
        way += max(speed, 0.0) / rate
    return way


def creep(
    name: str,
    ground: str,
    *,
    fraction: float = 0.95,
    friction: float = 0.5,
    seconds=60.0,
    rate,
    **k,
):
    """How far the body gets below the angle of friction, from a second after the ground has leaned on."""
    slope = fraction * math.atan(friction)
    world, body, _ = place(name, ground, slope=slope, friction=friction, rate=rate, **k)
    world.step(round(rate))
    start = center(body)
    world.step(round(seconds * rate))
    return float(np.linalg.norm(center(body) - start))


def build_stack(solver: str) -> vx.World:
    """Eight bricks on each other."""
    brick = vx.Model.from_mesh(box((0.2, 0.1, 0.06)))
    world = vx.World(solver=solver, sleeping=False)
    world.add(vx.Plane(), mass=0)
    for i in range(8):
        pose = np.eye(4)
        pose[2, 3] = 0.0301 + 0.0601 * i
        world.add(brick, pose=pose)
    world.step(100)
    return world


def build_heap(solver: str) -> vx.World:
    """24 rings that have fallen on each other."""
    ring = vx.Model.from_mesh(torus(0.06, 0.02))
    world = vx.World(solver=solver, sleeping=False)
    world.add(vx.Plane(), mass=0)
    random = np.random.default_rng(1)
    for i in range(24):
        pose = trimesh.transformations.random_rotation_matrix(random.random(3))
        pose[:3, 3] = [*(0.1 * (random.random(2) - 0.5)), 0.1 + 0.09 * i]
        world.add(ring, pose=pose)
    world.step(600)
    return world


def compare_cost() -> None:
    """Prints the median time of a step with both solvers, run by turns, and the ratio."""
    for scene in (build_stack, build_heap):
        worlds = {solver: scene(solver) for solver in ("sequential_impulse", "coulomb")}
        times: dict[str, list[float]] = {solver: [] for solver in worlds}
        for _ in range(40):
            for solver, world in worlds.items():
                world.clear_timings()
                world.step(10)
                parts = world.timings
                times[solver].append(float(np.median(parts["step"] - parts["narrow_phase"])))
        ratio = np.median(np.array(times["coulomb"]) / np.array(times["sequential_impulse"]))
        print(scene.__doc__)
        for solver, world in worlds.items():
            points = world.contacts()
            fastest = max(float(np.linalg.norm(body.linear_velocity)) for body in world.bodies)
            print(
                f"  {solver:18} {1e3 * np.median(times[solver]):.3f} ms a step without narrow phase, "
                f"{len(points)} points, fastest body {1e3 * fastest:.3f} mm/s"
            )
        print(f"  ratio {ratio:.3f}")


def main() -> None:
    """Runs what the command line asks for."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--quick", action="store_true", help="one case in ten")
    parser.add_argument("--solver", default="coulomb")
    parser.add_argument("--rates", type=float, nargs="*", default=RATES)
    parser.add_argument("--bodies", nargs="*", default=list(MESHES))
    parser.add_argument("--grounds", nargs="*", default=GROUNDS)
    parser.add_argument("--directions", type=int, default=2, help="friction directions a point")
    parser.add_argument("--headings", type=float, nargs="*", default=HEADINGS, help="degrees")
    parser.add_argument("--creep", type=float, default=0.0, help="seconds on a slope")
    parser.add_argument("--cost", action="store_true", help="compare times of steps instead")
    options = parser.parse_args()
    if options.cost:
        compare_cost()
        return
    settings = {"solver": options.solver, "friction_directions": options.directions}
    cases = itertools.product(options.bodies, options.grounds, options.rates)
    print(
        f"{'body':11} {'ground':6} {'Hz':>5}  sliding, of the exact speed     stopping, of the exact way"
    )
    for name, ground, rate in itertools.islice(cases, 0, None, 10 if options.quick else 1):
        rows = []
        for case in (slide, stop):
            rows += [
                case(name, ground, heading=math.radians(h), rate=rate, **settings)
                for h in options.headings
            ]
        rests = ""
        if options.creep:
            crept = creep(name, ground, heading=0.3, rate=rate, seconds=options.creep, **settings)
            rests = f"   creep {1e3 * crept:.3f} mm"
        print(
            f"{name:11} {ground:6} {rate:5g}  " + "  ".join(f"{x:5.3f}" for x in rows) + rests,
            flush=True,
        )


if __name__ == "__main__":
    main()
