"""Says how much energy and angular momentum two free cubes keep that hit each other.

.venv/bin/python benchmarks/blows.py --help
"""

from __future__ import annotations

import argparse

import numpy as np
import trimesh
import voxshell as vx
from scipy.spatial.transform import Rotation

SIDE = 0.1  # meters
INERTIA = SIDE**2 / 6.0  # of a cube of 1 kg, kg m2
SPEED = 1.0  # m/s
SHAPES = {
    "model": lambda: vx.Model.from_mesh(trimesh.creation.box((SIDE, SIDE, SIDE))),
    "box": lambda: vx.Box((0.5 * SIDE, 0.5 * SIDE, 0.5 * SIDE)),
}


def measure_energy(bodies: list[vx.Body]) -> float:
    """The kinetic energy of cubes of 1 kg, joules."""
    return sum(
        0.5 * float(body.linear_velocity @ body.linear_velocity)
        + 0.5 * INERTIA * float(body.angular_velocity @ body.angular_velocity)
        for body in bodies
    )


def measure_angular_momentum(bodies: list[vx.Body]) -> np.ndarray:
    """Of cubes of 1 kg, about the origin, kg m2/s."""
    return np.sum(
        [
            np.cross(body.position, body.linear_velocity) + INERTIA * body.angular_velocity
            for body in bodies
        ],
        axis=0,
    )


def add_cubes(
    world: vx.World,
    shape: vx.Model | vx.Box,
    seed: int,
    *,
    restitution: float = 1.0,
    friction: float = 0.0,
    spin: float = 0.0,
) -> list[vx.Body]:
    """One cube at rest, and one that flies at it; both turned at random.

    Args:
        world: Bodies fly at each other along its x axis.
        shape: Of both.
        seed: Of a generator of random numbers.
        restitution: Of the pair.
        friction: Of the pair.
        spin: Standard deviation of each component of the angular velocities, rad/s.
    """
    rng = np.random.default_rng(seed)
    aside = rng.uniform(-0.04, 0.04, 2)
    start = 0.18 + rng.uniform(0.0, SPEED * world.time_step)
    bodies = []
    for place, velocity in (((0.0, 0.0, 0.0), 0.0), ((start, *aside), -SPEED)):
        pose = np.eye(4)
        pose[:3, :3] = Rotation.random(random_state=rng.integers(1 << 30)).as_matrix()
        pose[:3, 3] = place
        body = world.add(
            shape,
            mass=1.0,
            pose=pose,
            restitution=float(np.sqrt(restitution)),
            friction=float(np.sqrt(friction)),
        )
        body.linear_velocity = (velocity, 0.0, 0.0)
        body.angular_velocity = spin * rng.standard_normal(3)
        bodies.append(body)
    return bodies


def blow(shape: vx.Model | vx.Box, rate: float, seed: int, **of_pair: float) -> tuple[float, float]:
    """What a random blow and those that follow change; `of_pair` as in add_cubes().

    Returns:
        The fraction of the energy that is left, and the change of angular momentum relative to what it was.
    """
    world = vx.World(time_step=1.0 / rate, gravity=(0, 0, 0), sleeping=False)
    bodies = add_cubes(world, shape, seed, **of_pair)
    energy, momentum = measure_energy(bodies), measure_angular_momentum(bodies)
    world.step(int(0.3 * rate / SPEED))
    change = np.linalg.norm(measure_angular_momentum(bodies) - momentum)
    return measure_energy(bodies) / energy, float(change / np.linalg.norm(momentum))


def main() -> None:
    """Prints a line for each rate."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--shape", choices=SHAPES, default="model", help="(default: model)")
    parser.add_argument("--count", type=int, default=200, help="random blows (default: 200)")
    parser.add_argument("--restitution", type=float, default=1.0, help="(default: 1)")
    parser.add_argument("--friction", type=float, default=0.0, help="(default: 0)")
    parser.add_argument("--spin", type=float, default=0.0, help="rad/s (default: 0)")
    options = parser.parse_args()
    shape = SHAPES[options.shape]()
    of_pair = {name: getattr(options, name) for name in ("restitution", "friction", "spin")}
    for rate in (1000.0, 200.0, 60.0):
        blows = [blow(shape, rate, seed, **of_pair) for seed in range(options.count)]
        kept, changes = np.array(blows).T
        print(
            f"{rate:4.0f} Hz: {np.mean(kept < 0.98):4.0%} lose more than 2 %, "
            f"{np.mean(kept > 1.02):3.0%} gain more than 2 %, "
            f"from {kept.min():.2f} to {kept.max():.2f}, mean {kept.mean():.3f}; "
            f"angular momentum changes by {np.median(changes):.2%} in the median",
            flush=True,
        )


if __name__ == "__main__":
    main()
