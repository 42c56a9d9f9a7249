"""Any number in any argument of the compiled modules is harmless."""

from __future__ import annotations

import numpy as np
import voxshell as vx
from poses import at
from voxshell import _bullet


def test_any_number_in_any_argument_of_a_simulation_is_harmless(brick):
    world = vx.World()
    world.add(vx.Plane(), mass=0)
    for _ in range(3):
        world.add_joint(vx.HingeJoint(), None, world.add(brick))
    simulation = world._simulation
    vector, pose, motor = (0.0, 0.0, 1.0), np.eye(4), _bullet.MotorMode
    calls = {
        "pose": (), "set_pose": (pose,), "linear_velocity": (), "angular_velocity": (),
        "set_linear_velocity": (vector,), "set_angular_velocity": (vector,), "bounds": (),
        "apply_force": (vector, vector), "apply_torque": (vector,), "apply_torque_impulse": (vector,),
        "apply_impulse": (vector, None), "material": (), "set_material": (_bullet.BodyMaterial(),),
        "is_asleep": (), "wake": (), "read_joint": (), "joint_reaction": (), "motor": (),
    }  # fmt: skip
    generator = np.random.default_rng(5)
    numbers = [
        -(2**63),
        -(2**31),
        -2,
        -1,
        *range(7),
        2**31 - 1,
        2**31,
        2**63 - 1,
        2**63,
        2**64 - 1,
        2**64,
    ]
    refused = 0

    def call(function, *arguments):
        nonlocal refused
        try:
            function(*arguments)
        except (vx.SettingsError, TypeError):
            refused += 1

    def any_number() -> int:
        return numbers[generator.integers(len(numbers))]

    for _ in range(1000):
        name = str(generator.choice([*calls]))
        call(getattr(simulation, name), any_number(), *calls[name])
        call(simulation.set_collision, any_number(), any_number(), False)
        call(simulation.find_contacts, any_number(), any_number(), 0.1)
        mode = motor.FOLLOW if generator.random() < 0.5 else motor.VELOCITY
        call(
            lambda mode=mode: simulation.set_motor(
                any_number(), _bullet.Motor(mode, 0.0, 1.0, 1.0, any_number())
            )
        )
        if generator.random() < 0.1:
            call(
                lambda: simulation.add_joint(
                    _bullet.JointSettings(
                        kind=_bullet.JointKind.HINGE,
                        parent=any_number(),
                        child=any_number(),
                        parent_from_joint=pose,
                        child_from_joint=pose,
                        lower=1.0,
                        upper=-1.0,
                        friction=0.0,
                        damping=0.0,
                        collides=False,
                    )
                )
            )
        call(simulation.step, 1)
    call(simulation.remove_joint, 99)
    call(simulation.remove_body, 99)
    assert refused > 2000


def test_any_number_in_any_argument_of_a_query_is_harmless(brick):
    tree = brick.shell.tree
    near = vx.contacts(brick, brick, a_pose=at(z=0.05))
    for number in (-(2**63), -(2**31), -1, 0, 13, 31, 64, 2**31, 2**63, 2**64):
        for ask in (
            tree.spheres,
            tree.segments,
            lambda level: vx.contacts(brick, brick, level=level),
            lambda level: vx.deepest_per_segment(brick, brick, level=level),
            lambda count: vx.contacts(brick, brick, max_points=count),
            lambda count: near.manifold(count),
        ):
            try:
                ask(number)
            except vx.SettingsError:
                continue
            assert number >= 0
