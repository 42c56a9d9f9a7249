"""Worlds of random bodies, joints and settings, stepped for a while.

With Bullet's own solvers, which have instabilities of their own, only NaN and crashes count. The same
holds where `iterations` are given and bodies are joined: too few do not solve joints between very
different masses, as docs/limits.md says.
"""

from __future__ import annotations

import math
import warnings
from typing import Any

import numpy as np
import parts
import trimesh
import voxshell as vx

from soak.task import WORLDS, Check, Outcome, Task, Totals

RADIUS = 0.1  # meters: no body reaches farther from its origin
SPACING = 0.25  # between origins at the start, so that no two bodies overlap
GAIN = 0.25  # of what a fall of a meter gives and the motion at the start
BLOCKS = 10  # of steps, after each of which the world is looked at
LEAST_STEPS, MOST_STEPS = 6, 30  # a block: a tenth of a second, about


def make_shapes() -> list[Any]:
    ring = trimesh.creation.torus(0.06, 0.02, 24, 12)
    cone = trimesh.creation.cone(0.05, 0.1, sections=7)
    cone.apply_translation(-cone.center_mass)
    ball = vx.Model.from_mesh(trimesh.creation.icosphere(3, 0.05), tolerance=5e-4)
    apart = np.eye(4)
    apart[0, 3] = 0.06
    return [
        ball,
        vx.Model.from_mesh(trimesh.creation.box((0.08, 0.06, 0.1)), tolerance=5e-4),
        vx.Model.from_mesh(ring, resolution=40),
        vx.Model.from_mesh(ring, tolerance=5e-4),
        vx.Model.from_mesh(trimesh.creation.box((0.12, 0.12, 0.01)), resolution=40),
        vx.Box((0.05, 0.04, 0.03)),
        vx.Sphere(0.04),
        vx.Capsule(0.02, 0.08),
        vx.Cylinder(0.04, 0.06),
        vx.Cone(0.04, 0.08),
        vx.ConvexHull(cone.vertices),
        vx.Compound([(vx.Sphere(0.03), np.eye(4)), (vx.Box((0.03, 0.02, 0.02)), apart)]),
    ]


def choose(rng: np.random.Generator, *values: Any) -> Any:
    return values[rng.integers(len(values))]


def draw_settings(rng: np.random.Generator) -> dict[str, Any]:
    settings: dict[str, Any] = {
        "time_step": choose(rng, 1 / 1000, 1 / 200, 1 / 60, 1 / 30),
        "contact": choose(rng, "auto", "auto", "regular", "segmented"),
        "shell": choose(rng, "auto", "auto", "fewest"),
        "sleeping": bool(rng.integers(2)),
        "solver": choose(rng, "coulomb", "coulomb", "sequential_impulse", "nncg", "dantzig"),
        "friction_directions": choose(rng, 2, 2, 1),
        "gravity": choose(rng, (0, 0, -9.81), (0, 0, -9.81), (0, 0, 0), (1.0, 2.0, -20.0)),
    }
    if rng.integers(4) == 0:
        settings["margin"] = choose(rng, 0.0, 0.002)
    if rng.integers(4) == 0:
        settings["iterations"] = int(rng.integers(1, 100))
    if rng.integers(4) == 0:
        settings["ccd_motion_threshold"] = choose(rng, 0.0, 0.01, math.inf)
    return settings


def add_bodies(world: vx.World, shapes: list[Any], rng: np.random.Generator) -> list[vx.Body]:
    """A ground or none, and bodies in a lattice above it, moving."""
    ground = choose(rng, "plane", "box", "model", None)
    floor = np.eye(4)
    floor[2, 3] = -0.25
    if ground == "plane":
        world.add(vx.Plane(offset=-0.2), mass=0)
    elif ground == "box":
        world.add(vx.Box((1.0, 1.0, 0.05)), mass=0, pose=floor, friction=rng.uniform(0, 1))
    elif ground == "model":
        world.add(shapes[4], mass=0, pose=floor)
    bodies = []
    for place in rng.permutation(27)[: rng.integers(1, 9)]:
        pose = np.eye(4)
        pose[:3, :3] = parts.random_rotation(rng)
        pose[:3, 3] = SPACING * (np.array(np.unravel_index(place, (3, 3, 3))) - [1.0, 1.0, 0.0])
        body = world.add(
            shapes[rng.integers(len(shapes))],
            mass=10.0 ** rng.uniform(-2, 2),
            pose=pose,
            friction=choose(rng, 0.0, 0.5, 1.0),
            restitution=choose(rng, 0.0, 0.0, 0.5, 0.9),
            rolling_friction=choose(rng, 0.0, 0.0, 0.005),
            angular_damping=choose(rng, 0.0, 0.0, 0.1),
        )
        body.linear_velocity = rng.normal(0.0, choose(rng, 0.0, 1.0, 3.0), 3)
        body.angular_velocity = rng.normal(0.0, choose(rng, 0.0, 5.0), 3)
        bodies.append(body)
    return bodies


def add_joints(world: vx.World, bodies: list[vx.Body], rng: np.random.Generator) -> float:
    """A few; returns the watts that their motors exert at most."""
    power = 0.0
    for child, parent in zip(bodies, [None, *bodies], strict=False):
        if rng.integers(3) > 0:
            continue
        axis = rng.normal(size=3)
        limits = choose(rng, None, (-0.1, 0.1))
        joint = choose(
            rng,
            vx.FixedJoint(),
            vx.PointJoint(),
            vx.HingeJoint(axis=axis, limits=limits, friction=choose(rng, 0.0, 0.1)),
            vx.SliderJoint(axis=axis, limits=limits),
        )
        made = world.add_joint(joint, parent, child)
        if isinstance(joint, (vx.HingeJoint, vx.SliderJoint)) and rng.integers(2):
            speed, force = float(rng.normal()), 10.0 ** rng.uniform(-1, 2)
            made.set_target_velocity(speed, max_force=force)
            power += abs(speed) * force
    return power


def measure_energy(bodies: list[vx.Body], gravity: np.ndarray) -> tuple[float, float]:
    """Joules: of motion without spin and in gravity, and of spin at most."""
    straight = spin = 0.0
    for body in bodies:
        velocity, turning = body.linear_velocity, body.angular_velocity
        height = -float(gravity @ body.pose[:3, 3])
        straight += body.mass * (0.5 * float(velocity @ velocity) + height)
        spin += 0.5 * body.mass * RADIUS**2 * float(turning @ turning)
    return straight, spin


def prepare() -> Check:
    warnings.simplefilter("ignore")
    shapes = make_shapes()

    def check(case: int) -> Outcome:
        rng = np.random.default_rng([case, 8])
        settings = draw_settings(rng)
        gravity = np.array(settings["gravity"], dtype=float)
        world = vx.World(**settings)
        bodies = add_bodies(world, shapes, rng)
        power = 0.0 if settings["solver"] == "nncg" else add_joints(world, bodies, rng)
        straight, spin = measure_energy(bodies, gravity)
        # What the motion at the start has, and what a fall of a meter gives.
        motion = sum(0.5 * b.mass * float(b.linear_velocity @ b.linear_velocity) for b in bodies)
        fall = sum(body.mass for body in bodies) * float(np.linalg.norm(gravity))
        scale = max(motion + spin + fall, 1e-9)
        solves = "iterations" not in settings or not world.joints
        is_bounded = settings["solver"] == "coulomb" and solves
        steps = int(np.clip(0.1 / world.time_step, LEAST_STEPS, MOST_STEPS))
        worst, touches, diverged = 0.0, False, False
        for block in range(1, BLOCKS + 1):
            try:
                world.step(steps)
            except vx.SimulationError:
                # Bullet's solver may, and the world says so.
                assert settings["solver"] == "nncg", f"diverges: {settings}"
                diverged = True
                break
            state = [np.r_[b.pose.ravel(), b.linear_velocity, b.angular_velocity] for b in bodies]
            assert np.isfinite(state).all(), f"not finite: {settings}"
            touches = touches or len(world.contacts()) > 0
            if is_bounded:
                work = power * block * steps * world.time_step
                gain = (measure_energy(bodies, gravity)[0] - straight - spin - work) / scale
                worst = max(worst, gain)
                assert gain <= GAIN, f"gains {gain:.0%} of the energy there is: {settings}"
        tallies = {"joints": len(world.joints), "bodies": len(bodies), "touching": touches}
        tallies |= {"diverged": diverged, "bounded": is_bounded}
        return Outcome(1, tallies, {"gain": worst})

    return check


def describe(totals: Totals) -> str:
    each = {name: totals.tallies[name] / totals.count for name in totals.tallies}
    return (
        f"{each['bodies']:.1f} bodies and {each['joints']:.1f} joints each; {each['touching']:.0%} "
        f"touch; the energy of {each['bounded']:.0%} is bounded, and gains {totals.peaks['gain']:.1%} at "
        "most; "
        f"{totals.tallies['diverged']} diverge under Bullet's solver nncg, with an error"
    )


def doubt(totals: Totals) -> str:
    touching = totals.tallies["touching"] / totals.count
    few = totals.count >= 100 and touching < 0.3
    return f"bodies touch in only {touching:.0%} of the worlds" if few else ""


TASK = Task(
    promise=(
        "A random world neither crashes nor silently becomes NaN, and its energy stays bounded unless "
        "it has joints and a given number of iterations"
    ),
    oracle="the energy at the start, and the work of motors",
    unit="worlds",
    target=10_000,
    prepare=prepare,
    sources=(*WORLDS, "tests/python/support/parts.py"),
    describe=describe,
    doubt=doubt,
    patience=120.0,
)
