from __future__ import annotations

import numpy as np
import pytest
import voxshell as vx

INNER = """<mujoco><compiler angle="radian"/><default><geom size="0.3"/></default>
<worldbody><body name="o" pos="1 0 0"><geom/><body name="b" pos="0 1 0"><joint name="j" range="0 1"/><geom name="g"/></body>
</body></worldbody><contact><exclude body1="o" body2="b"/></contact><actuator><motor joint="j"/></actuator></mujoco>"""
ASSET = "<asset><model name='m' file='inner.xml'/></asset>"


@pytest.fixture
def load(write, tmp_path):
    (tmp_path / "inner.xml").write_text(INNER)

    def load(*content: str):
        return vx.load_mjcf(vx.World(), write(ASSET, *content))

    return load


def test_models_are_attached_with_their_own_settings_and_a_prefix(load):
    with pytest.warns(vx.RobotWarning, match=r"<actuator> \(2 motor\)"):
        robot = load(
            "<worldbody><frame pos='0 0 1'><attach model='m' body='b' prefix='p_'/></frame>",
            "<body name='q' pos='0 0 5'><attach model='m' prefix='z_'/></body></worldbody>",
        )
    assert set(robot.links) == {"world", "p_b", "q", "z_o", "z_b"}
    assert robot.joints["p_j"].kind.limits == (0.0, 1.0)
    np.testing.assert_allclose(robot.links["p_b"].pose[:3, 3], (0, 1, 1))
    np.testing.assert_allclose(robot.links["z_b"].pose[:3, 3], (1, 1, 5))
    np.testing.assert_allclose(np.ptp(robot.links["p_b"].body.bounds, axis=0), 0.6, rtol=0.02)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("<attach model='x'/>", "attaches the model 'x', but <asset> has no such model"),
        ("<attach model='m' body='x'/>", "attaches the body 'x', but the model has no such body"),
        ("<attach/>", "has a <attach> without model"),
    ],
)
def test_wrong_attachments_are_refused(load, content, message):
    with pytest.raises(vx.RobotError, match=message):
        load(f"<worldbody>{content}</worldbody>")


def test_a_model_that_attaches_itself_is_refused(write):
    asset = "<asset><model name='m' file='model.xml'/></asset>"
    path = write(asset, "<worldbody><attach model='m' prefix='p'/></worldbody>")
    with pytest.raises(vx.RobotError, match=r"model\.xml:1: .* 100 "):
        vx.load_mjcf(vx.World(), path)
