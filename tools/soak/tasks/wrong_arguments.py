"""Calls of the public functions and of the compiled module with arguments that are wrong or odd.

An array that only lies otherwise in memory must give the same answer. A value that is wrong must be
refused with a typed error. An odd value, which may make sense, must do one of the two.
"""

from __future__ import annotations

import tempfile
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import trimesh
import voxshell as vx
from voxshell import _core

from soak.task import Check, Outcome, Task, Totals

CALLS = 100  # a case

WITHOUT_ANSWER = ("load",)  # of a file that is not there

ROBOT = """<robot name="robot"><link name="base"><collision><geometry><sphere radius="0.1"/></geometry>
</collision></link></robot>"""


@dataclass(frozen=True)
class Call:
    """A function, and arguments that are right.

    The package promises errors of its own. The compiled module checks types alone: a number that makes
    no sense may be answered there, and an array that lies otherwise be refused.
    """

    function: Callable[..., Any]
    arguments: dict[str, Any]
    is_public: bool = True

    @property
    def errors(self) -> tuple[type[Exception], ...]:
        """Those that may be raised."""
        return (vx.VoxshellError,) if self.is_public else (vx.VoxshellError, TypeError)


def list_calls() -> dict[str, Call]:
    mesh = trimesh.creation.icosphere(1, 0.1)
    vertices, faces = np.array(mesh.vertices), np.array(mesh.faces)
    ball = vx.Model.from_mesh((vertices, faces), resolution=12, cache=False)
    pose = np.eye(4)
    pose[0, 3] = 0.15
    pair = {"a": ball, "b": ball, "a_pose": pose, "b_pose": np.eye(4)}
    poses = np.tile(pose, (3, 1, 1))
    points = np.random.default_rng(0).uniform(-0.2, 0.2, (5, 3))
    urdf = Path(tempfile.mkdtemp(prefix="voxshell-soak-"), "robot.urdf")
    urdf.write_text(ROBOT)

    def build(vertices: Any, faces: Any, **settings: Any) -> Any:
        return vx.Model.from_mesh((vertices, faces), cache=False, threads=1, **settings)

    def simulate(
        world: dict[str, Any] | None = None, steps: Any = 2, shape: Any = ball, **body: Any
    ) -> Any:
        made = vx.World(**(world or {}))
        ball_in_world = made.add(shape, **body)
        made.step(steps)
        return ball_in_world.pose

    def make_world(**settings: Any) -> Any:
        return simulate(settings)

    def set_state(**state: Any) -> Any:
        world = vx.World()
        body = world.add(vx.Sphere(0.1))
        for name, value in state.items():
            setattr(body, name, value)
        world.step(1)
        return body.pose

    def push(**force: Any) -> Any:
        world = vx.World()
        body = world.add(vx.Sphere(0.1))
        body.apply_force(**force)
        world.step(1)
        return body.pose

    def hinge(
        kind: Any = vx.HingeJoint, drive: dict[str, Any] | None = None, **settings: Any
    ) -> Any:
        world = vx.World()
        names = ("parent_from_joint", "child_from_joint")
        places = {name: settings.pop(name) for name in names if name in settings}
        joint = world.add_joint(kind(**settings), None, world.add(vx.Sphere(0.1)), **places)
        if drive:
            joint.set_target_velocity(**drive)
        world.step(2)
        return world.bodies[0].pose

    def slide(**settings: Any) -> Any:
        return hinge(vx.SliderJoint, **settings)

    def turn(**drive: Any) -> Any:
        return hinge(drive=drive)

    def meet(a: Any = None, b: Any = None, margin: Any = 0.0, every: Any = 1) -> Any:
        world = vx.World()
        first, second = world.add(ball), world.add(ball, pose=pose)
        recorder = world.record(every=every)
        world.step(1)
        assert recorder.recording().frame_count > 0
        pair = first if a is None else a, second if b is None else b
        return world.overlaps(*pair), world.query_contacts(*pair, margin=margin).tobytes()

    def load(**arguments: Any) -> Any:
        return vx.load_urdf(**{"world": vx.World(), **arguments}).links["base"].pose

    def compound(place: Any, half_extents: Any) -> Any:
        return simulate(shape=vx.Compound([(vx.Box(half_extents), place), (ball, np.eye(4))]))

    def hulls(points: Any, margin: Any) -> Any:
        return simulate(shape=vx.ConvexHull(points, margin=margin))

    def triangles(vertices: Any, faces: Any, margin: Any) -> Any:
        return simulate(shape=vx.GImpact((vertices, faces), margin=margin))

    def polyhedron(vertices: Any, faces: Any) -> Any:
        return vx.ConvexPolyhedron((vertices, faces)).sample(points)

    def cast(**rays: Any) -> Any:
        world = vx.World()
        world.add(ball)
        return world.ray_cast(**rays)

    core = {
        **{"field_a": ball.field._core, "model_a": ball._core},
        **{"field_b": ball.field._core, "model_b": ball._core},
        **{"a_pose": pose, "b_pose": None, "shells": _core.Shells.AUTOMATIC, "margin": 0.0},
    }
    return {
        "contacts": Call(vx.contacts, {**pair, "margin": 0.01, "level": 2, "max_points": 5}),
        "contacts in a budget": Call(vx.contacts, {**pair, "shell": "a", "budget": 100}),
        "manifold": Call(vx.manifold, {**pair, "margin": 0.01, "max_points": 3}),
        "deepest_per_segment": Call(vx.deepest_per_segment, {**pair, "level": 2, "margin": 0.0}),
        "collide": Call(vx.collide, {**pair, "shell": "auto", "margin": 0.01}),
        "distance": Call(vx.distance, {**pair, "max_distance": 1.0}),
        "wrench": Call(vx.wrench, {**pair, "stiffness": 100.0}),
        "contacts_batch": Call(
            vx.contacts_batch, {"a": ball, "b": ball, "a_poses": poses, "level": 2, "threads": 1}
        ),
        "collide_batch": Call(
            vx.collide_batch, {"a": ball, "b": ball, "a_poses": poses, "margin": 0.01}
        ),
        "distance_batch": Call(
            vx.distance_batch, {"a": ball, "b": ball, "a_poses": poses, "max_distance": 1.0}
        ),
        "sample": Call(ball.field.sample, {"points": points}),
        "gradient": Call(vx.Box((0.1, 0.1, 0.1)).gradient, {"points": points}),
        "from_mesh": Call(build, {"vertices": vertices, "faces": faces, "resolution": 6}),
        "from_mesh with all settings": Call(
            build,
            {
                **{"vertices": vertices, "faces": faces, "voxel_size": 0.03, "scale": 1.0},
                **{"point_spacing": 0.04, "padding": 0.1, "sign": "auto", "open": "auto"},
            },
        ),
        "load": Call(vx.Model.load, {"path": "no such file"}),
        "Plane": Call(vx.Plane, {"normal": np.array([0.0, 0.0, 1.0]), "offset": 0.1}),
        "Box": Call(vx.Box, {"half_extents": np.array([0.1, 0.2, 0.3])}),
        "Capsule": Call(vx.Capsule, {"radius": 0.1, "length": 0.2}),
        "Cone": Call(vx.Cone, {"radius": 0.1, "height": 0.2}),
        "World": Call(
            make_world,
            {
                **{"gravity": np.array([0.0, 0.0, -9.81]), "time_step": 0.005, "level": 3},
                **{"margin": 0.001, "iterations": 10, "friction_directions": 2},
            },
        ),
        "add": Call(
            simulate,
            {
                **{"mass": 1.0, "pose": pose, "friction": 0.5, "restitution": 0.5, "steps": 2},
                **{"rolling_friction": 0.001, "linear_damping": 0.1, "group": 1, "mask": 3},
            },
        ),
        "body": Call(
            set_state,
            {"pose": pose, "linear_velocity": np.ones(3), "angular_velocity": np.ones(3)},
        ),
        "apply_force": Call(push, {"force": np.ones(3), "at": np.zeros(3)}),
        "Sphere": Call(vx.Sphere, {"radius": 0.1}),
        "Cylinder": Call(vx.Cylinder, {"radius": 0.1, "length": 0.2}),
        "ConvexPolyhedron": Call(polyhedron, {"vertices": vertices, "faces": faces}),
        "Compound": Call(compound, {"place": pose, "half_extents": np.full(3, 0.1)}),
        "ConvexHull": Call(hulls, {"points": vertices, "margin": 0.001}),
        "GImpact": Call(triangles, {"vertices": vertices, "faces": faces, "margin": 0.001}),
        "contact_bounds": Call(vx.contact_bounds, {"a": ball, "b": ball, "shell": "auto"}),
        "contacts_flat": Call(vx.testing.contacts_flat, {**pair, "margin": 0.01, "level": 2}),
        "mass_properties": Call(ball.mass_properties, {"mass": 2.0, "kind": "solid"}),
        "HingeJoint": Call(
            hinge,
            {
                **{"axis": np.array([0.0, 1.0, 0.0]), "friction": 0.1, "damping": 0.1},
                **{"parent_from_joint": pose, "child_from_joint": np.eye(4)},
            },
        ),
        "SliderJoint": Call(slide, {"axis": np.array([0.0, 1.0, 0.0]), "limits": (-1.0, 1.0)}),
        "set_target_velocity": Call(turn, {"velocity": 1.0, "max_force": 10.0}),
        "pairs in a world": Call(meet, {"margin": 0.01, "every": 1}),
        "load_urdf": Call(
            load,
            {
                **{"path": urdf, "pose": pose, "voxel_size": 0.01, "friction": 0.5},
                **{"mesh_as": "model"},
            },
        ),
        "ray_cast": Call(cast, {"starts": points, "ends": points + 1.0}),
        "core: contacts": Call(
            _core.contacts,
            {**core, "level": 1, "max_points": None, "budget": None, "scratch": None},
            is_public=False,
        ),
        "core: collide": Call(_core.collide, core, is_public=False),
        "core: sample": Call(ball.field._core.sample, {"points": points}, is_public=False),
    }


# ---- values --------------------------------------------------------------------------------------


def lay_out(array: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """The same numbers, elsewhere in memory."""
    match rng.integers(5):
        case 0:
            other = np.asfortranarray(array)
        case 1:
            wide = np.zeros([2 * size for size in array.shape], array.dtype)
            other = wide[tuple(slice(None, None, 2) for _ in array.shape)]
            other[...] = array
        case 2:
            turned = (slice(None, None, -1),) * array.ndim
            other = array[turned].copy()[turned]
        case 3:
            packed = np.zeros(
                len(array), dtype=[("gap", "i1"), ("row", array.dtype, array.shape[1:])]
            )
            packed["row"] = array
            other = packed["row"]
        case _:
            other = array.copy()
            other.flags.writeable = False
    return other


WRONG: tuple[Any, ...] = (np.nan, "text", b"bytes", object(), [1, [2]], {}, 1j)


def make_wrong(value: Any, rng: np.random.Generator) -> Any:
    """A value that no function may take in the place of this one."""
    if not isinstance(value, np.ndarray):
        return WRONG[rng.integers(len(WRONG))]
    other = value.astype(np.float64)
    match rng.integers(8):
        case 0:
            return other[..., :-1]
        case 1:
            return other[None, None]
        case 2:
            return other.astype(complex)
        case 3:
            return value.astype(str)
        case 4:
            return value.astype("datetime64[s]") if value.dtype.kind == "i" else other.astype("V8")
        case 5:
            return WRONG[rng.integers(len(WRONG))]
        case 6:
            return other.flat[0]
        case _:
            other.flat[rng.integers(other.size)] = rng.choice([np.nan, np.inf, -np.inf])
            return other


ODD: tuple[Any, ...] = (
    *(
        None,
        True,
        0,
        -1,
        1,
        2**31,
        2**63,
        2**64,
        -(2**80),
        np.inf,
        1e-320,
        1e300,
        -0.0,
        1e15,
        "a",
        "both",
        "",
        (),
    ),
    *(np.float32(0.5), np.int8(3), np.array(1.0), np.array([2]), [], [[]], range(3), "\0", "é"),
)


def make_odd(value: Any, rng: np.random.Generator) -> Any:
    """A value that may or may not make sense in the place of this one."""
    if not isinstance(value, np.ndarray) or rng.integers(3) == 0:
        return ODD[rng.integers(len(ODD))]
    other = value.astype(np.float64)
    match rng.integers(8):
        case 0:
            return other[:0]
        case 1:
            return np.concatenate([other, other])
        case 2:
            return other * 10.0 ** rng.uniform(-300, 300)
        case 3:
            return other.astype(rng.choice(["f4", "f2", "i4", "u1", "i8", "?", ">f8", "O", "f16"]))
        case 4:
            return rng.permuted(other, axis=0)
        case 5:
            return np.ma.masked_array(other, other > 0)
        case 6:
            # As large as an address space, in eight bytes.
            return np.broadcast_to(other.flat[0], (2**40, *other.shape[1:]))
        case _:
            return other + rng.normal(size=other.shape)


# ---- the task ------------------------------------------------------------------------------------


def digest(answer: Any) -> object:
    """Something that is equal where answers are."""
    if hasattr(answer, "depths"):
        return answer.depths.tobytes(), answer.ids.tobytes()
    if isinstance(answer, vx.Model):
        return answer.shell.points.tobytes()
    return answer.tobytes() if isinstance(answer, np.ndarray) else str(answer)


def run(name: str, call: Call, want: object, rng: np.random.Generator) -> str:
    """One call; returns how it ended."""
    arguments = dict(call.arguments)
    arrays = [key for key, value in arguments.items() if isinstance(value, np.ndarray)]
    kind = ("layout", "wrong", "wrong", "odd")[rng.integers(4)]
    if not call.is_public or (kind == "layout" and not arrays):
        kind = "odd"
    key = str(rng.choice(arrays if kind == "layout" else list(arguments)))
    makers = {"layout": [lay_out], "wrong": [make_wrong], "odd": [make_odd, make_wrong]}[kind]
    make = makers[rng.integers(len(makers))]
    arguments[key] = make(arguments[key], rng)
    what = f"{name}({key}={arguments[key]!r:.200}), which is {kind}"
    try:
        answer = call.function(**arguments)
    except Exception as error:
        refused = error
    else:
        assert kind != "wrong", f"{what}: taken"
        assert kind != "layout" or digest(answer) == want, f"{what}: another answer"
        return "answered"
    # numpy has no memory for a copy of what is as large as an address space.
    typed = (*call.errors, MemoryError) if kind == "odd" else call.errors
    assert isinstance(refused, typed), f"{what}: untyped {refused!r}"
    assert kind != "layout", f"{what}: refused: {refused!r}"
    return "refused"


def prepare() -> Check:
    warnings.simplefilter("ignore")
    calls = list_calls()
    wants: dict[str, object] = {}
    for name, call in calls.items():
        if name not in WITHOUT_ANSWER:
            wants[name] = digest(call.function(**call.arguments))

    def check(case: int) -> Outcome:
        rng = np.random.default_rng([case, 7])
        ends = {"refused": 0.0, "answered": 0.0}
        for _ in range(CALLS):
            name = str(rng.choice(list(calls)))
            ends[run(name, calls[name], wants.get(name), rng)] += 1
        return Outcome(CALLS, ends)

    return check


def describe(totals: Totals) -> str:
    refused = totals.tallies["refused"] / totals.count
    return f"{refused:.0%} refused with a typed error, {1 - refused:.0%} answered"


TASK = Task(
    promise="Wrong arguments are refused with a typed error, and array layouts change nothing",
    oracle="the type of the error, and the result of the plain call",
    unit="calls",
    target=100_000,
    prepare=prepare,
    describe=describe,
    patience=60.0,
)
