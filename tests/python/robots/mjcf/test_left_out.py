from __future__ import annotations

import pytest
import voxshell as vx

BALL = "<geom size='0.1'/>"


def warning_of(path) -> str:
    with pytest.warns(vx.RobotWarning) as caught:
        vx.load_mjcf(vx.World(), path)
    [one] = caught
    assert one.filename == __file__
    return str(one.message)


def test_one_warning_lists_what_is_not_simulated(write):
    path = write(
        "<actuator><motor joint='a'/><motor joint='a'/><position joint='a'/></actuator>",
        "<tendon><fixed/></tendon><equality><weld/></equality>",
        "<option density='1.2' gravity='0 0 -1'/>",
        f"<worldbody><geom type='hfield' name='hills'/><body name='x' gravcomp='1'><joint name='a' stiffness='1 2' armature='1'/>{BALL}</body>",
        f"<body name='y'><joint type='ball' name='b' range='0 1' damping='1' stiffness='1'/>{BALL}</body>",
        f"<body name='z' mocap='true'>{BALL}<flexcomp name='cloth'/></body></worldbody>",
    )
    message = warning_of(path)
    assert message.startswith(f"{path} contains what is not simulated: ")
    for phrase in (
        "<actuator> (2 motor, 1 position)", "<tendon> (1 fixed)", "<equality> (1 weld)",
        "<option> ('density', 'gravity [0.0, 0.0, -1.0]; pass it to the World')",
        "geoms of type hfield ('hills')", "joint stiffness below 0 or of a higher order ('a')",
        "limits of ball joints ('b')", "damping, frictionloss, stiffness or armature of ball and free joints ('b')",
        "gravcomp ('x')", "mocap bodies, which stand still ('z')", "<flexcomp> ('cloth')",
    ):  # fmt: skip
        assert phrase in message


def test_a_model_of_bodies_and_joints_does_not_warn(write, recwarn):
    path = write(
        "<visual/><statistic/><size/><sensor><touch site='s'/></sensor><option gravity='0 0 -9.81'/>",
        f"<worldbody><light/><camera/><body><joint damping='1' stiffness='1' armature='1'/>{BALL}<site name='s'/></body></worldbody>",
    )
    vx.load_mjcf(vx.World(), path)
    assert not recwarn.list


def test_flags_that_switch_off_what_is_simulated_are_listed(write):
    path = write("\n<option gravity='0 0 -1'><flag gravity='disable' limit='disable' contact='disable' warmstart='disable'/>",
                 f"</option><worldbody><body name='x'><freejoint/>{BALL}</body></worldbody>")  # fmt: skip
    assert (
        '<flag> (\'gravity="disable" at model.xml:2; give gravity=(0, 0, 0) to the World\', \'limit="disable" at '
        "model.xml:2')"
    ) in warning_of(path)


def test_a_world_without_gravity_does_not_warn_of_a_file_without(write, recwarn):
    flag = "<option gravity='0 0 -1'><flag gravity='disable'/></option>"
    path = write(flag, f"<worldbody><body name='x'><freejoint/>{BALL}</body></worldbody>")
    vx.load_mjcf(vx.World(gravity=(0, 0, 0)), path)
    assert not recwarn.list


def test_another_time_step_than_the_worlds_is_named(write, recwarn):
    path = write(
        "<option timestep='0.002'/>", f"<worldbody><body name='x'>{BALL}</body></worldbody>"
    )
    assert (
        "simulated: <option> ('timestep 0.002; give time_step=0.002 to the World')"
        in warning_of(path)
    )
    recwarn.clear()
    vx.load_mjcf(vx.World(time_step=0.002), path)
    assert not recwarn.list
