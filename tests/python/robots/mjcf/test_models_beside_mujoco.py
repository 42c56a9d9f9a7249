"""Models as MuJoCo compiles them: the same poses, masses, inertias, limits and swings, where it is installed."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import voxshell as vx

mujoco: Any = pytest.importorskip("mujoco", reason="compares with the package mujoco")

GEOMS = (
    "type='box' size='0.1 0.2 0.3'",
    "type='sphere' size='0.1' mass='0.7'",
    "type='capsule' size='0.05' fromto='0 0 0 0.1 0.2 -0.3'",
    "type='capsule' size='0.05 0.2' density='300'",
    "type='cylinder' size='0.1 0.2' group='4'",
    "type='ellipsoid' size='0.1 0.2 0.3'",
    "type='box' size='0.05' fromto='0.1 0 0 0.1 0.2 0.3'",
    "type='mesh' mesh='wedge'",
    "type='mesh' mesh='turned'",
    "type='cylinder' mesh='wedge'",
    "type='box' mesh='wedge' fitscale='1.1'",
    "type='sphere' mesh='wedge'",
    "type='capsule' mesh='wedge'",
    "type='box' size='0.1 0.2 0.3' shellinertia='true'",
    "type='sphere' size='0.1' mass='0.7' shellinertia='true'",
    "type='capsule' size='0.05 0.2' density='3' shellinertia='true'",
    "type='cylinder' size='0.1 0.2' density='3' shellinertia='true'",
    "type='ellipsoid' size='0.1 0.2 0.3' density='3' shellinertia='true'",
)
VERTICES = "0 0 0 0.3 0 0 0 0.2 0 0 0 0.4 0.2 0.2 0.1"
ASSET = f"""<asset><mesh name="wedge" vertex="{VERTICES}"/>
  <mesh name="turned" vertex="{VERTICES}" refpos="0.1 0.2 0.3" refquat="1 2 3 4" scale="1 -2 0.5"/></asset>"""
COMPILERS = (
    "",
    "angle='radian' eulerseq='zyx'",
    "eulerseq='XYZ' boundmass='0.5' boundinertia='0.01'",
    "balanceinertia='true' inertiafromgeom='true'",
    "settotalmass='33' autolimits='true'",
    "inertiagrouprange='0 3'",
    "fitaabb='true'",
    "alignfree='true'",
)


def write_model(rng: np.random.Generator, compiler: str) -> str:
    """A tree of bodies with all kinds of joints, rotations and geoms."""
    counter = iter(range(1000))

    def numbers(count: int, size: float = 1.0) -> str:
        return " ".join(f"{value:.4f}" for value in rng.uniform(-size, size, count))

    def rotation() -> str:
        turn = rng.choice(["quat 4", "axisangle 4", "euler 3", "xyaxes 6", "zaxis 3"]).split()
        return f"{turn[0]}='{numbers(int(turn[1]))}'"

    def geom(attributes: str) -> str:
        place = "" if "fromto" in attributes else f"pos='{numbers(3)}' {rotation()}"
        return f"<geom {attributes} {place}/>"

    def joint(kind: str) -> str:
        limits = "range='-0.5 1.5'" if kind != "ball" and rng.random() < 0.5 else ""
        ref = f"ref='{rng.uniform(0, 1):.3f}'" if kind != "ball" and rng.random() < 0.5 else ""
        return f"<joint name='j{next(counter)}' type='{kind}' axis='{numbers(3)}' pos='{numbers(3)}' {limits} {ref}/>"

    def body(depth: int) -> str:
        # Every body has a geom that counts, whatever the groups.
        kinds = rng.choice(
            ["", "hinge", "slide", "ball", "hinge hinge", "slide slide hinge"]
        ).split()
        joints = "".join(map(joint, kinds))
        if depth == 0 and rng.random() < 0.3:
            joints = str(rng.choice(["<freejoint/>", "<freejoint align='true'/>"]))
        geoms = "<geom size='0.1'/>"
        geoms += "".join(geom(str(rng.choice(GEOMS))) for _ in range(rng.integers(1, 4)))
        if rng.random() < 0.3:
            geoms += (
                f"<inertial pos='{numbers(3)}' {rotation()} mass='2' diaginertia='0.1 0.15 0.2'/>"
            )
        inside = "".join(body(depth + 1) for _ in range(rng.integers(0, 3))) if depth < 4 else ""
        made = f"<body name='b{next(counter)}' pos='{numbers(3)}' {rotation()}>{joints}{geoms}{inside}</body>"
        return (
            f"<frame pos='{numbers(3)}' {rotation()}>{made}</frame>" if rng.random() < 0.3 else made
        )

    bodies = "".join(body(0) for _ in range(3))
    return f"<mujoco><compiler {compiler}/>{ASSET}<worldbody>{bodies}</worldbody></mujoco>"


def load_both(path: Path) -> tuple[Any, Any, vx.World, vx.Robot]:
    """MuJoCo's model and data, and ours, all joints where ours begin."""
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    world = vx.World()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", vx.RobotWarning)
        robot = vx.load_mjcf(world, path, mesh_as="hull")
    for index in range(model.njnt):
        place = model.jnt_qposadr[index]
        if model.jnt_limited[index]:
            data.qpos[place] = np.clip(data.qpos[place], *model.jnt_range[index])
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    return model, data, world, robot


def matter_of(
    parts: list[tuple[float, np.ndarray, np.ndarray]],
) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass, center and inertia of parts together, world frame."""
    mass = sum(part[0] for part in parts)
    center = sum(part[0] * part[1] for part in parts) / mass
    inertia = np.zeros((3, 3))
    for own, middle, tensor in parts:
        arm = middle - center
        inertia += tensor + own * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    return mass, center, inertia


def compare(path: Path) -> int:
    """Compares all bodies and joints; returns how many bodies move."""
    model, data, _, robot = load_both(path)
    groups: dict[int, list[int]] = {}
    for index in range(model.nbody):
        name = model.body(index).name
        np.testing.assert_allclose(robot.links[name].pose[:3, 3], data.xpos[index], atol=1e-9)
        turn = data.xmat[index].reshape(3, 3)
        np.testing.assert_allclose(robot.links[name].pose[:3, :3], turn, atol=1e-9)
        if model.body_weldid[index] != 0:
            groups.setdefault(model.body_weldid[index], []).append(index)
    for first, members in groups.items():
        name = model.body(first).name
        bodies = [
            link.body
            for key, link in robot.links.items()
            if key == name or key.startswith(f"{name}/")
        ]
        ours = matter_of([
            (it.mass, (it.pose @ [*it._center, 1])[:3], it.pose[:3, :3] @ it._inertia @ it.pose[:3, :3].T)
            for it in bodies
        ])  # fmt: skip
        theirs = matter_of([
            (model.body_mass[it], data.xipos[it],
             data.ximat[it].reshape(3, 3) @ np.diag(model.body_inertia[it]) @ data.ximat[it].reshape(3, 3).T)
            for it in members
        ])  # fmt: skip
        assert ours[0] == pytest.approx(theirs[0], rel=1e-6)
        np.testing.assert_allclose(ours[1], theirs[1], atol=1e-6)
        np.testing.assert_allclose(ours[2], theirs[2], atol=1e-5 * np.abs(theirs[2]).max())
    for index in range(model.njnt):
        name = model.jnt(index).name
        if name not in robot.joints:
            continue
        assert robot.positions[name] == pytest.approx(data.qpos[model.jnt_qposadr[index]], abs=1e-9)
        limits = robot.joints[name].kind.limits
        assert (limits is not None) == bool(model.jnt_limited[index])
        if limits is not None:
            assert limits == pytest.approx(tuple(model.jnt_range[index]))
    return len(groups)


@pytest.mark.parametrize("compiler", COMPILERS)
def test_random_models_are_those_of_mujoco(tmp_path, compiler):
    moving = 0
    for seed in range(8):
        path = tmp_path / "model.xml"
        path.write_text(write_model(np.random.default_rng([seed, 7]), compiler))
        moving += compare(path)
    assert moving > 30


def test_links_follow_moved_joints_as_in_mujoco(tmp_path):
    """Joints are driven, and MuJoCo's kinematics at the same positions put the links at the same places."""
    path = tmp_path / "model.xml"
    joints = [
        "<joint name='a' axis='1 2 3' pos='0.1 0.2 0.3' ref='20'/>",
        "<joint name='b' type='slide' axis='0 1 1' ref='0.1'/><joint name='c' axis='1 0 0' pos='0 0 0.2'/>",
    ]
    inner = f"<body name='y' pos='0.3 0 0' euler='10 20 30'>{joints[1]}<geom size='0.1'/></body>"
    path.write_text(
        f"<mujoco><worldbody><body name='x'>{joints[0]}<geom size='0.1'/>{inner}</body></worldbody></mujoco>"
    )
    model, data, world, robot = load_both(path)
    robot.set_targets({"a": 0.9, "b": 0.3, "c": -0.5}, max_force=1000.0)
    world.step(400)
    for name, position in robot.positions.items():
        data.qpos[model.jnt_qposadr[model.joint(name).id]] = position
    mujoco.mj_kinematics(model, data)
    for name in ("x", "y"):
        np.testing.assert_allclose(robot.links[name].pose[:3, 3], data.body(name).xpos, atol=2e-3)
        turn = data.body(name).xmat.reshape(3, 3)
        np.testing.assert_allclose(robot.links[name].pose[:3, :3], turn, atol=5e-3)


PENDULUM = """<mujoco><worldbody><body name="a" pos="0 0 2" euler="0 60 0"><joint axis="0 1 0"/>
  <geom type="capsule" fromto="0 0 0 0 0 -0.5" size=".03"/>
  <body name="b" pos="0 0 -.5"><joint axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0 0 -0.4" size=".02"/>
  </body></body></worldbody></mujoco>"""
# It leans, so that it falls: upright, it is in balance on its feet, and stands or falls by rounding errors.
DOLL = """<mujoco><default><geom type="capsule" size="0.05"/><joint range="-60 60" damping="1"/></default><worldbody>
  <geom type="plane" size="1 1 1"/>
  <body name="torso" pos="0 0 1.2" euler="0 10 0"><freejoint/><geom fromto="0 0 0 0 0 0.5" size="0.1"/>
    <geom type="sphere" pos="0 0 0.7" size="0.1"/>
    <body name="left" pos="0 0.12 -0.1"><joint axis="1 0 0"/><joint axis="0 1 0"/><geom fromto="0 0 0 0 0 -0.4"/>
      <body name="left shin" pos="0 0 -0.45"><joint axis="0 1 0"/><geom fromto="0 0 0 0 0 -0.4"/></body></body>
    <body name="right" pos="0 -0.12 -0.1"><joint axis="1 0 0"/><joint axis="0 1 0"/><geom fromto="0 0 0 0 0 -0.4"/>
      <body name="right shin" pos="0 0 -0.45"><joint axis="0 1 0"/><geom fromto="0 0 0 0 0 -0.4"/></body></body>
  </body></worldbody></mujoco>"""


def centers(path: Path, seconds: float) -> tuple[np.ndarray, np.ndarray, float]:
    """Center of mass, ours and MuJoCo's, every tenth of a second, and our highest speed."""
    model, data, world, robot = load_both(path)
    model.opt.timestep = 0.001
    ours, theirs, speed = [], [], 0.0
    for _ in range(round(seconds * 10)):
        world.step(20)
        for _ in range(100):
            mujoco.mj_step(model, data)
        moving = [body for body in robot.bodies if body.mass > 0.0]
        speed = max(speed, *(float(np.linalg.norm(body.linear_velocity)) for body in moving))
        weighted = [body.mass * (body.pose @ [*body._center, 1])[:3] for body in moving]
        ours.append(sum(weighted) / sum(body.mass for body in moving))
        theirs.append(data.subtree_com[0].copy())
    return np.array(ours), np.array(theirs), speed


@pytest.mark.parametrize("joint", ["", "armature='0.01' stiffness='0.4' springref='20'"])
def test_a_double_pendulum_swings_as_in_mujoco(tmp_path, joint):
    path = tmp_path / "model.xml"
    path.write_text(PENDULUM.replace("<joint ", f"<joint {joint} "))
    ours, theirs, _ = centers(path, 2.0)
    assert np.ptp(theirs[:, 0]) > 0.5
    np.testing.assert_allclose(ours, theirs, atol=0.01)


def test_a_doll_falls_and_lies_as_in_mujoco(tmp_path):
    path = tmp_path / "model.xml"
    path.write_text(DOLL)
    ours, theirs, speed = centers(path, 4.0)
    np.testing.assert_allclose(ours[:3], theirs[:3], atol=0.02)
    assert speed < 6.0
    assert theirs[-1, 2] < 0.1  # it lies
    np.testing.assert_allclose(ours[-1, 2], theirs[-1, 2], atol=0.04)


SLOPE = """<geom name="floor" type="plane" size="5 5 1" euler="0 10 0" {floor}/><body pos="0.01736 0 0.09848" euler="0 10 0">
  <freejoint/><geom name="block" type="box" size="0.1 0.1 0.1" {block}/></body>"""
RULES = {
    "condim of both": ("condim='1'", "condim='1'", ""),
    "condim of one": ("condim='1'", "", ""),
    "condim of higher priority": ("", "condim='1' priority='1'", ""),
    "pair without friction": ("", "", "<contact><pair geom1='floor' geom2='block' friction='0 0'/></contact>"),
    "pair of geoms without bits": ("contype='0' conaffinity='0'", "contype='4' conaffinity='8'",
                                   "<contact><pair geom1='floor' geom2='block'/></contact>"),
    "no contacts": ("", "", "<option><flag contact='disable'/></option>"),
}  # fmt: skip


@pytest.mark.parametrize("case", RULES)
def test_a_block_slides_stays_or_falls_as_in_mujoco(tmp_path, case):
    floor, block, rules = RULES[case]
    path = tmp_path / "model.xml"
    bodies = SLOPE.format(floor=floor, block=block)
    path.write_text(f"<mujoco>{rules}<worldbody>{bodies}</worldbody></mujoco>")
    ours, theirs, _ = centers(path, 1.0)
    np.testing.assert_allclose(ours, theirs, atol=0.04)
