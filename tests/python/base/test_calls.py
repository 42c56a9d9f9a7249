"""Calls that do not fit: a typed error with public names, what to do, and all arguments."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import trimesh
import voxshell as vx
from voxshell.base.calls import explain_calls

WORLD = vx.World()
GROUND = WORLD.add(vx.Plane(), mass=0)
BALL = WORLD.add(vx.Sphere(0.1), pose=(0, 0, 1))
HINGE = WORLD.add_joint(vx.HingeJoint(), None, BALL)
MESH = trimesh.creation.box()

WRONG: list[tuple[Callable[..., Any], tuple[Any, ...], dict[str, Any], str]] = [
    (vx.World, (), {"dt": 0.01}, r"World() has no argument 'dt': did you mean time_step? "),
    (
        vx.World,
        (0.01, (0, 0, -9.81)),
        {},
        r"World() takes 1 positional argument (time_step), but 2 were given",
    ),
    (WORLD.add, (vx.Sphere(1), 1.0), {}, "as in add(shape, mass=1.0, pose=(0, 0, 1)). Call it as"),
    (WORLD.add, (), {}, "World.add() needs shape. Call it as World.add(shape, *, pose=..., "),
    (WORLD.add, (vx.Sphere(1),), {"position": (0, 0, 1)}, "'position': did you mean pose?"),
    (WORLD.add, (vx.Sphere(1),), {"velocity": (0, 0, 1)}, "'velocity': set the body's linear_"),
    (WORLD.add, (vx.Sphere(1),), {"shape": vx.Sphere(1)}, "World.add() got 'shape' twice"),
    (WORLD.add_joint, (vx.HingeJoint(), BALL), {}, "World.add_joint() needs child. Call it as"),
    (WORLD.set_collision, (BALL, GROUND), {}, "World.set_collision(a, b, collide)"),
    (WORLD.ray_cast, ((0, 0, 1),), {}, "World.ray_cast() needs ends. Call it as World.ray_cast("),
    (WORLD.overlaps, (BALL,), {}, "World.overlaps() needs b. Call it as World.overlaps(a, b)"),
    (
        WORLD.view,
        (8080,),
        {},
        "World.view() takes no positional arguments, but 1 was given: name all",
    ),
    (WORLD.step, (), {"dt": 0.01}, "'dt': it belongs to the world: World(time_step=...)"),
    (BALL.apply_force, (0, 0, 1), {}, "pass the three numbers as one argument: apply_force((0, 0,"),
    (HINGE.set_target_position, (0.5,), {}, "set_target_position() needs max_force. Call it as "),
    (HINGE.set_target_velocity, (1, 5), {}, "set_target_velocity(velocity, *, max_force)"),
    (
        vx.HingeJoint,
        (),
        {"limit": (0, 1)},
        "HingeJoint() has no argument 'limit': did you mean lim",
    ),
    (vx.Box, (1, 1, 1), {}, "pass half of each edge length as one argument: Box((0.5, 0.5, 0.5))"),
    (vx.Box, (), {"size": (1, 1, 1)}, "'size': pass half_extents, half of each edge length"),
    (vx.Cylinder, (0.1,), {}, "Cylinder() needs length. Call it as Cylinder(radius, length)"),
    (vx.Cylinder, (), {"radius": 1, "height": 2}, "no argument 'height': did you mean length?"),
    (vx.Cone, (), {"radius": 1, "length": 2}, "no argument 'length': did you mean height?"),
    (vx.Compound, (vx.Sphere(1), vx.Sphere(2)), {}, "Compound([(shape, pose), ...])"),
    (vx.Model.from_mesh, (MESH, 0.001), {}, "as in scale=0.001; pass vertices and faces as one"),
    (vx.Model.from_mesh, (MESH,), {"tolerence": 1e-3}, "'tolerence': did you mean tolerance?"),
    (
        vx.distance,
        (BALL, BALL),
        {"pose_a": 1},
        "distance() has no argument 'pose_a': did you mean a_pose?",
    ),
    (vx.contact_bounds, (), {}, "contact_bounds() needs a and b. Call it as"),
    (vx.contacts_batch, (BALL, BALL), {"pose_b": 1}, "'pose_b': did you mean b_poses?"),
    (
        vx.sweep,
        (BALL, BALL),
        {"b_edn": 1},
        "sweep() has no argument 'b_edn': did you mean b_end",
    ),
    (
        vx.Mesh,
        ("a.stl",),
        {},
        "for a model of a file, call Model.from_mesh(path). Call it as Mesh(",
    ),
    (vx.Model.from_mesh, (), {}, "Model.from_mesh() needs mesh. Call it as Model.from_mesh(mesh, "),
    (vx.pose, ((0, 0, 1), (0, 0, 0, 1)), {}, "xyzw=... or wxyz=...; for a matrix, pass rotation="),
    (vx.pose, (), {"quaternion": (0, 0, 0, 1)}, "pass xyzw=... (real part last) or wxyz=..."),
    (vx.pose, (), {"rpy": (0, 0, 1)}, "pose() has no argument 'rpy': did you mean euler?"),
]


@pytest.mark.parametrize(("call", "args", "options", "message"), WRONG)
def test_a_call_that_does_not_fit_says_what_does(call, args, options, message):
    with pytest.raises(vx.InputTypeError, match=re.escape(message)) as caught:
        call(*args, **options)
    assert caught.value.__context__ is None  # one traceback
    text = str(caught.value)
    assert not re.search(r"WorldContents|WorldQueries|ViewedWorld|__init__|self", text)


@pytest.mark.parametrize("wrong", ["add", "add_joint", "set_collision", "ray_cast", "view", "step"])
def test_methods_have_the_name_of_the_class_that_users_know(wrong: str):
    assert getattr(vx.World, wrong).__qualname__ == f"World.{wrong}"
    assert wrong in vars(vx.World)


def test_what_a_call_may_be_is_what_it_was():
    assert vx.World(1 / 100).time_step == 0.01
    assert str(inspect.signature(vx.Box)) == "(half_extents: 'ArrayLike') -> 'None'"
    assert next(iter(inspect.signature(vx.Model.from_mesh).parameters)) == "mesh"
    assert "half extents" in (inspect.getdoc(vx.Box) or "")


def test_errors_from_inside_a_call_stay_as_they_are():
    @explain_calls
    def fall(height: float) -> float:
        return height + "m"  # pyright: ignore[reportOperatorIssue]

    with pytest.raises(TypeError, match="unsupported operand") as caught:
        fall(1.0)
    assert type(caught.value) is TypeError


def test_a_wrong_call_inside_a_call_stays_as_it_is():
    @explain_calls
    def fall(height: float) -> float:
        return math_of(height, 1)  # pyright: ignore[reportCallIssue]

    def math_of(height: float) -> float:
        return height

    with pytest.raises(TypeError, match="math_of") as caught:
        fall(1.0)
    assert type(caught.value) is TypeError


def test_a_class_gets_what_it_inherits_and_leaves_its_base():
    class _Inner:
        def run(self, n: int) -> int:
            return n

    _Inner.__module__ = "voxshell.example"

    @explain_calls
    class Outer(_Inner):
        pass

    assert Outer().run(3) == 3
    with pytest.raises(
        vx.InputTypeError, match=r"Outer\.run\(\) needs n\. Call it as Outer\.run\(n\)"
    ):
        Outer().run()  # pyright: ignore[reportCallIssue]
    assert "__wrapped__" not in vars(_Inner.run)


def test_starred_arguments_are_shown():
    @explain_calls
    def show(*bodies: str, title: str, **colors: str) -> None: ...

    with pytest.raises(vx.InputTypeError, match=r"show\(\*bodies, title, \*\*colors\)"):
        show("a", "b", red="a")  # pyright: ignore[reportCallIssue]


@pytest.mark.parametrize("name", ["callback", "before"])
def test_a_callback_that_does_not_take_the_world_is_refused(name: str):
    with pytest.raises(vx.InputTypeError, match=rf"^{name} is called with one argument, the world"):
        vx.World().step(3, **{name: lambda: None})


def test_errors_of_callbacks_stay_as_they_are():
    def fail(world: vx.World) -> None:
        world + 1  # pyright: ignore[reportOperatorIssue, reportUnusedExpression]

    for callback in (fail, np.ndarray.sum):  # the second has no signature
        with pytest.raises(TypeError) as caught:
            vx.World().step(1, callback)
        assert type(caught.value) is TypeError


def test_no_memory_is_an_error_of_ours():
    @explain_calls
    def fill(count: int) -> list[int]:
        raise MemoryError

    with pytest.raises(vx.MemoryLimitError, match=r"^no memory left for .*fill\(\)$"):
        fill(5)
    with pytest.raises(vx.MemoryLimitError, match=r"no memory left for World\.ray_cast\(\)"):
        WORLD.ray_cast(range(10**15), (0, 0, 0))
