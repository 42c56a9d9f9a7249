"""URDF gripper: a robot from a file grasps a mug by its wall and carries it aside.

One finger is inside the mug, where a convex hull of the mug would leave no room for it. The meshes of the arm's links,
of the fingers and of the mug become models. Friction alone holds the mug.
"""

from pathlib import Path

import numpy as np
import voxshell as vx
from command import parse_command, tell
from drawing import draw, plot
from gripper import WALL, make_mug, write_robot

TURN = 0.6  # radians from the robot's x axis to the mug
RATE = 1000.0  # Hz; the grip also holds at 200 and 60 Hz


def build(folder: Path, voxel_size: float = 0.002) -> tuple[vx.World, vx.Robot, vx.Body]:
    """Builds the world: the robot, and the mug on the ground in front of it."""
    world = vx.World(time_step=1 / RATE)
    world.add(vx.Plane(), mass=0, name="ground")
    robot = vx.load_urdf(world, write_robot(folder), voxel_size=voxel_size, friction=0.9)
    place = (0.263 + WALL) * np.array([np.cos(TURN), np.sin(TURN), 0]) + (0, 0, 0.0002)
    pose = vx.pose(place, axis_angle=((0, 0, 1), TURN))
    mug = vx.Model.from_mesh(make_mug(), voxel_size=voxel_size)
    return world, robot, world.add(mug, mass=0.25, pose=pose, friction=0.9, name="mug")


def take(world: vx.World, robot: vx.Robot, *, close: float = 0.024, note=None) -> None:
    """Turns to the mug, grasps it, lifts it and holds it."""
    for seconds, targets in (
        (1.5, {"turn": TURN, "lift": 0.0, "grip": 0.0}),
        (1.0, {"lift": -0.2}),
        (0.8, {"grip": close}),
        (1.5, {"lift": -0.05}),
    ):
        robot.set_targets(targets)
        world.step(round(seconds * RATE), note)


if __name__ == "__main__":
    options = parse_command(__doc__)
    world, robot, mug = build(options.out, 0.002 if options.quick else 0.001)
    fingers = [robot.links[name].body.number for name in ("outer", "inner")]
    start, recorder, rows = mug.pose, world.record(every=20), []
    colors = robot.colors | {mug: (72, 163, 154)}

    def note(world):
        """Records the heights of mug and wrist, and the depth (m) and impulse (N s) at the fingers."""
        found = world.contacts()
        held = np.isin(found["body_a"], fingers) | np.isin(found["body_b"], fingers)
        heights = (body.pose[2, 3] for body in (mug, robot.links["wrist"]))
        rows.append((*heights, found["depth"][held].max(initial=0), found["impulse"][held].sum()))

    take(world, robot, note=note)
    held = np.linalg.inv(robot.links["outer"].pose) @ mug.pose  # the mug in the finger's frame
    robot.set_targets({"turn": -TURN})
    world.step(round(1.8 * RATE), note)
    slip = np.linalg.inv(robot.links["outer"].pose) @ mug.pose - held
    view = {"frames": (230,), "focus": ("gripper/outer", "mug"), "cut": ("mug",), "fill": 0.6}
    draw(options.out / "picture.png", recorder.recording(colors=colors), frame=230, **view)
    for targets in ({"lift": -0.19}, {"grip": 0.0}):
        robot.set_targets(targets)
        world.step(round(1.8 * RATE), note)
    mug_heights, wrist_heights, depths, impulses = np.array(rows).T
    figures = {
        "lifted_mm": 1e3 * float(mug_heights.max()),
        "carried_mm": 1e3 * float(np.linalg.norm((mug.pose - start)[:2, 3])),
        "slip_on_the_way_mm": 1e3 * float(np.linalg.norm(slip[:3, 3])),
        "tilt_at_the_end_degrees": float(np.degrees(np.arccos(min(mug.pose[2, 2], 1.0)))),
        "height_at_the_end_mm": 1e3 * float(mug_heights[-1]),
        "deepest_finger_contact_mm": 1e3 * float(depths.max()),
        "median_force_N": RATE * float(np.median(impulses)),
    }
    tell(options.out, figures)
    lines = {"mug": 1e3 * mug_heights, "wrist": 1e3 * wrist_heights}
    axes = {"x": np.arange(1, len(rows) + 1) / RATE, "x_label": "time, s", "y_label": "height, mm"}
    plot(options.out / "plot.png", lines=lines, **axes)
    recorder.save_html(options.out / "replay.html", title="A gripper and a mug", colors=colors)
