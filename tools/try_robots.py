#!/usr/bin/env python3
"""Loads every robot in some folders, and writes a table of the results.

usage: tools/try_robots.py [--format mjcf] [--mesh-as model] [--steps N] [--write PAGE] FOLDER...

The program searches each FOLDER for URDF files, or for MJCF files. If `pip install --target FOLDER` filled the folder, the
table names the package and version of each file; otherwise it names the first subfolder. A robot that
loads then moves freely for some steps, which finds robots that diverge. The program prints a line for
each file, and exits with 1 if a file neither loads nor is refused with a voxshell error.
"""

from __future__ import annotations

import argparse
import concurrent.futures
import csv
import json
import os
import re
import subprocess
import sys
import warnings
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from importlib.metadata import distributions
from pathlib import Path
from typing import Literal

TIME_LIMIT = 600.0
"""Seconds for one batch of files."""

BATCH = 20
"""Number of files that one process loads in turn: starting a process takes as long as loading a robot."""

MANY = 100
"""From this number on, files in sibling folders share a row of the table if all of them load."""

FORMATS = {"urdf": ".urdf", "mjcf": ".xml"}
"""Endings of the files of each format."""

MJCF_ROOT = re.compile(rb"\s*(<\?.*?\?>\s*|<!--.*?-->\s*)*<mujoco\b", re.DOTALL)

HEADS = {
    "urdf": """# Robots

`vx.load_urdf` adds the robot of a URDF file to a world, and `vx.load_mjcf` does so with [models of MuJoCo](mjcf.md). This
program writes a small arm to a file, loads it, and moves it. Replace the path by that of your robot:

```python
import pathlib

import voxshell as vx

path = pathlib.Path("arm.urdf")
path.write_text(\"\"\"
<robot name="arm">
  <link name="base">
    <collision><geometry><cylinder radius="0.08" length="0.1"/></geometry></collision>
  </link>
  <link name="upper">
    <inertial><origin xyz="0.2 0 0"/><mass value="1.5"/>
      <inertia ixx="0.001" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0.2 0 0"/><geometry><box size="0.4 0.06 0.06"/></geometry></collision>
  </link>
  <link name="lower">
    <inertial><origin xyz="0.15 0 0"/><mass value="1.0"/>
      <inertia ixx="0.001" iyy="0.008" izz="0.008" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0.15 0 0"/><geometry><box size="0.3 0.04 0.04"/></geometry></collision>
  </link>
  <link name="hand"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/><origin xyz="0 0 0.1"/><axis xyz="0 -1 0"/>
    <limit lower="-1.5" upper="1.5" effort="50" velocity="1"/>
  </joint>
  <joint name="elbow" type="revolute">
    <parent link="upper"/><child link="lower"/><origin xyz="0.4 0 0"/><axis xyz="0 -1 0"/>
    <limit lower="-2" upper="2" effort="20" velocity="1"/>
  </joint>
  <joint name="wrist" type="fixed">
    <parent link="lower"/><child link="hand"/><origin xyz="0.3 0 0"/>
  </joint>
</robot>\"\"\")
world = vx.World()
world.add(vx.Plane(offset=-0.05), mass=0)
robot = vx.load_urdf(world, path)
print(robot)  # Robot('arm', 4 links, 2 joints that move)

robot.set_targets({{"shoulder": 0.8, "elbow": -0.5}})  # radians, with the efforts of the file
world.step(400)
print(dict(robot.positions))  # {{'shoulder': 0.8, 'elbow': -0.5}} to a thousandth
print(robot.links["hand"].pose[:3, 3].round(3))  # [0.565 0.    0.476]
print(robot.joints["elbow"].reaction.torque.round(2))  # what holds the lower arm, newton meters
```

All joints begin at position 0, or where you tell them to, as in `vx.load_urdf(world, path, positions={{"elbow": -0.5}})`, in
radians or meters. Joints whose limits exclude 0 begin at the nearest limit, and a `RobotWarning` names them. Joints move freely
until you drive them. The root link is fixed to the world, unless you pass `fixed_base=False`. `vx.load_urdf` returns a `Robot`:

| what | contents |
|---|---|
| `robot.links["hand"]` | a link: its `pose` in the world, the `body` that it is part of, its `color`. Links that fixed joints hold together are one body |
| `robot.joints["elbow"]` | a [joint](joints.md) that turns or slides: position, velocity, reaction, motor |
| `robot.ball_joints` | joints that turn about a point; they have no motor |
| `robot.bodies` | the bodies of all links |
| `robot.positions`, `robot.velocities` | radians or meters, and rad/s or m/s, of all joints that turn or slide, by name; to read |
| `robot.set_positions({{...}})` | puts joints at positions at once and at rest, as for a new episode |
| `robot.set_targets({{...}})` | drives joints to positions, at most with the effort and the velocity in the file. If the file states no effort, pass `max_force`. `robot.set_targets(robot.positions)` holds the robot where it is |
| `robot.set_target_velocities({{...}})`, `robot.release()` | drive joints at velocities; turn motors off |
| `robot.remove()` | removes the robot from its world |

Collision meshes become [models](start.md) of 100 voxels along the longest side, or convex hulls with `mesh_as="hull"`, which
load faster. If an `AccuracyWarning` says that these models may miss contacts with others, pass a `tolerance` in meters, such as
`tolerance=0.0002`. The first load then takes two to eight times as long (Panda: 2.5 s instead of 1.1 s, UR5: 13 s instead of
1.7 s), and steps took 0.4 to 1.9 times as long with six robots. Links of the robot do not collide with each other, unless you
pass `self_collision=True`. Links without a `<collision>` touch nothing. A `RobotWarning` names those that have a `<visual>`, and
the links and files of faulty meshes.

Bodies have friction 0.5, unless you pass `friction`, or links have the element `<contact>` that pybullet adds to URDF. Its
`lateral_friction`, `restitution`, `rolling_friction` and `spinning_friction` are read; a body of several links gets the largest
of each. A `RobotWarning` names the other elements in it, such as `stiffness` and `damping`, which are not simulated.

A `RobotWarning` also names elements of the robot, its links and its joints that URDF does not have, such as `<colision>`, with
the name that was probably meant. Common extensions, such as `<gazebo>`, `<transmission>` and `<drake:joint>`, are not read and not
named. A file with elements of xacro is refused: expand it first with `xacro robot.urdf.xacro > robot.urdf`.

Some files have a placeholder for the inertia, such as 1 kg m2 for a domino of 25 g, with which a body hardly turns. pybullet does
not show this, because it computes inertias from the shapes unless it gets `URDF_USE_INERTIA_FROM_FILE`. A `RobotWarning` names
each link whose radius of gyration is more than 5 times the distance from its center of mass to the farthest point of its
collision geometry. No matter inside of the geometry exceeds 1 times. Pass `inertia="shape"` to take the inertias of the shapes,
with the masses and centers of mass of the file.

## Robots that were tried

This section lists what `vx.load_urdf` does with every URDF file of the packages below. Each robot that loads then moves freely for
{steps} steps. Some files leave out masses, inertias, limits or collisions, have joints that cannot begin at 0, or have elements that
are not read. They load with a `RobotWarning`, which states what voxshell used instead. The last column quotes the error of a refused file. The meshes were
loaded {kind}. These commands write the page:

```
pip install --no-deps --target robots {packages}
{command}
```

""",
    "mjcf": """# Models of MuJoCo

`vx.load_mjcf` loads MJCF files, the XML of MuJoCo. A file becomes one robot, even if it describes a scene of several bodies:

```python
import pathlib

import voxshell as vx

path = pathlib.Path("scene.xml")
path.write_text(\"\"\"
<mujoco model="scene">
  <worldbody>
    <geom name="floor" type="plane" size="1 1 0.1"/>
    <body name="arm" pos="0 0 0.5">
      <joint name="shoulder" axis="0 1 0" range="-90 90" damping="0.1"/>
      <geom type="capsule" fromto="0 0 0 0.4 0 0" size="0.03"/>
    </body>
    <body name="cup" pos="0 0.5 0.2"><freejoint/><geom type="cylinder" size="0.04 0.05"/></body>
  </worldbody>
</mujoco>\"\"\")
world = vx.World()
robot = vx.load_mjcf(world, path)
robot.set_targets({{"shoulder": 0.3}}, max_force=50.0)
world.step(400)
print(robot.positions["shoulder"], robot.links["cup"].pose[:3, 3])
```

| in the file | in voxshell |
|---|---|
| `<worldbody>` | the link `world`: one static body, and one for each plane, such as `world/floor` |
| body | a link with the same name. A body without joints is rigidly part of the body that contains it, or static in `<worldbody>` |
| body with several joints | a chain of links: the joint `hip_x` moves the link `torso/hip_x`. Each link between two joints gets a tenth of the body's matter |
| `hinge`, `slide`, `ball`, `freejoint` | `HingeJoint`, `SliderJoint`, `PointJoint`, no joint; with range, damping, frictionloss, stiffness, springref, armature and `actuatorfrcrange` |
| positions | `qpos` of MuJoCo. `vx.load_mjcf(world, path, positions={{"shoulder": 0.3}})` sets those at the start. A joint whose `ref` is beyond its range begins at the nearest limit |
| mass and inertia | as MuJoCo compiles them, also from geoms and meshes |
| box, sphere, capsule, cylinder, ellipsoid, plane, mesh | the same shapes; ellipsoids become models. Meshes (STL, OBJ, MSH, inline) become models of 100 voxels along the longest side, or to a `tolerance=`, or hulls with `mesh_as="hull"`. MuJoCo always takes hulls |
| `contype`, `conaffinity`, `<exclude>`, `<pair>`, parents | decide which bodies of the file collide. A body collides as a whole: if any two geoms may collide, their bodies do. Bodies of one tree that overlap at the start by more than 2 % of the smaller one do not collide; a warning names them. Bodies that your program adds collide with all |
| friction | a body has the largest friction of its geoms. Bullet multiplies the frictions of two bodies, MuJoCo takes the larger one. A warning names each `<pair>` whose friction its bodies do not have |
| contacts without friction: `condim="1"` of both geoms, `<pair>` with `condim="1"` or friction 0 | as in MuJoCo if all contacts of one of the two bodies are frictionless; a static body or a body of another tree then has friction 0. Otherwise the bodies keep their frictions, and a warning names the geoms |
| `<default>`, `<include>`, `<attach>`, `<frame>`, `<compiler>` | as in MuJoCo; `<replicate>`, global coordinates and meshes that MuJoCo makes (`builtin`) are refused |
| `<freejoint align="true">`, `alignfree` | the link has the frame of the body's inertia, as in MuJoCo |
| unknown elements and attributes | refused; the error suggests the name that was probably meant. All names of MuJoCo 2.2.0 to 4.0.0 are known |
| limits of actuators: `forcerange`, and `ctrlrange` of a `motor`, times `gear` | the `max_force` of `robot.set_targets`, if the joint has one actuator; at most its `actuatorfrcrange` |
| `<actuator>`, `<tendon>`, `<equality>`, springs and armatures of tendons and balls, height fields, soft bodies, mocap, fluids | not simulated; one `RobotWarning` lists them |
| `<option>` | the world's gravity and time step apply; if the file states another gravity or `timestep`, a warning says so |
| `<flag>` | `contact` and `filterparent` hold for the bodies of the file. A warning names `gravity`, `constraint`, `limit`, `frictionloss`, `damper` and `passive` if they are disabled; other flags are not read |
| `<keyframe>` | `vx.load_mjcf(world, path, keyframe="home")` lets all joints begin at the `qpos` of the `<key>` with that name; the rest is not read |
| solver parameters, sensors, sites, cameras, pictures | not read |

The tables list what `vx.load_mjcf` does with every MJCF file of the packages below. Each model that loads then moves freely
for {steps} steps. Files with elements that are not simulated load with a warning. The last column quotes the error of a refused
file. Most of the refused files are parts that other files include, or name files that are not in the package; MuJoCo refuses
`xarm7_gripper.xml`, too. The meshes were loaded {kind}. These commands write the page:

```
pip install --no-deps --target robots {packages}
{command}
```

""",
}


@dataclass(frozen=True)
class Outcome:
    """The result for a file.

    Attributes:
        result: "loads", "refused", or "fails" if the error is not voxshell's or the process dies.
        reason: The text of the error; empty if it loads.
        warned: Whether the file left something out.
        links: Their number; 0 if it does not load.
        joints: The number of those that move.
    """

    result: Literal["loads", "refused", "fails"]
    reason: str = ""
    warned: bool = False
    links: int = 0
    joints: int = 0


def try_robot(path: str, kind: str, mesh_as: Literal["model", "hull"], steps: int) -> Outcome:
    """Loads one file into a world of its own."""
    import voxshell as vx

    world = vx.World()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            load = vx.load_urdf if kind == "urdf" else vx.load_mjcf
            robot = load(world, path, mesh_as=mesh_as)
            world.step(steps)
        except vx.VoxshellError as error:
            return Outcome("refused", f"{type(error).__name__}: {error}")
        except Exception as error:  # a defect, whatever it is
            return Outcome("fails", f"{type(error).__name__}: {error}")
    return Outcome(
        "loads",
        warned=any(issubclass(it.category, vx.RobotWarning) for it in caught),
        links=len(robot.links),
        joints=len(robot.joints) + len(robot.ball_joints),
    )


def try_apart(paths: list[Path], kind: str, mesh_as: str, steps: int) -> list[Outcome]:
    """Loads several files in other processes; a process that dies fails only the file that killed it."""
    outcomes: list[Outcome] = []
    while len(outcomes) < len(paths):
        command = [sys.executable, __file__, "--batch", "--format", kind]
        command += ["--mesh-as", mesh_as, "--steps", str(steps)]
        command += map(str, paths[len(outcomes) :])
        try:
            done = subprocess.run(command, capture_output=True, timeout=TIME_LIMIT)
            said, reason = done.stdout, f"the process ends with {done.returncode}"
        except subprocess.TimeoutExpired as late:
            said, reason = late.stdout or b"", f"takes more than {TIME_LIMIT:g} s"
        outcomes += [
            Outcome(**json.loads(line)) for line in said.splitlines(True) if _is_whole(line)
        ]
        if len(outcomes) < len(paths):
            outcomes.append(Outcome("fails", reason))
    return outcomes


def _is_whole(line: bytes) -> bool:
    """Whether it is an outcome, and the process lived to write all of it."""
    return line.startswith(b"{") and line.endswith(b"}\n")


def find_robots(folder: Path, kind: str = "urdf") -> Iterator[tuple[str, Path]]:
    """The files of a format below a folder, each with the name of its package."""
    suffix = FORMATS[kind]
    owners = {
        # pip counts shared files from another folder than the one that it puts them into, where some
        # versions of `package.files` miss them.
        Path(
            *(part for part in Path(name).parts if part != "..")
        ): f"{package.metadata['Name']} {package.version}"
        for package in distributions(path=[str(folder)])
        for name, *_ in filter(None, csv.reader((package.read_text("RECORD") or "").splitlines()))
        if name.endswith(suffix)
    }
    for path in sorted(folder.rglob(f"*{suffix}")):
        if path.is_file() and (kind == "urdf" or MJCF_ROOT.match(path.read_bytes()[:100_000])):
            below = path.relative_to(folder)
            yield owners.get(below, below.parts[0]), path


def make_table(outcomes: dict[tuple[str, Path], Outcome]) -> str:
    """A summary by package, and a row for each file or folder of many that all load."""
    by_package: dict[str, dict[Path, Outcome]] = defaultdict(dict)
    for (package, path), outcome in outcomes.items():
        by_package[package][path] = outcome
    lines = ["| package | files | load | with a warning | refused |", "|---|---|---|---|---|"]
    for package, found in by_package.items():
        lines.append(f"| {package} | {_count(found.values())} |")
    lines.append(f"| all | {_count(outcomes.values())} |")
    lines += ["", "| package | file | links | joints that move | result | reason of refusal |"]
    lines += ["|---|---|---|---|---|---|"]
    for package, found in by_package.items():
        root = Path(os.path.commonpath([path.parent for path in found]))
        for name, outcome in _join_many(found, root):
            reason = outcome.reason.replace(f"{root}{os.sep}", "")
            result = "loads, with a warning" if outcome.warned else outcome.result
            counts = f"{outcome.links} | {outcome.joints}" if outcome.result == "loads" else " | "
            lines.append(f"| {package} | {name} | {counts} | {result} | {_escape(reason)} |")
    return "\n".join(lines) + "\n"


def _count(outcomes: Iterable[Outcome]) -> str:
    found = list(outcomes)
    loaded = [it for it in found if it.result == "loads"]
    warned = sum(it.warned for it in loaded)
    return f"{len(found)} | {len(loaded)} | {warned} | {len(found) - len(loaded)}"


def _join_many(found: dict[Path, Outcome], root: Path) -> Iterator[tuple[str, Outcome]]:
    """The rows of a package: what a file is called, and what became of it."""
    groups: dict[tuple[Path, Outcome], list[Path]] = defaultdict(list)
    for path, outcome in found.items():
        groups[path.parent.parent, outcome].append(path)
    for (folder, outcome), paths in groups.items():
        if len(paths) >= MANY and outcome.result == "loads":
            name = (folder.relative_to(root) / "*" / f"*{paths[0].suffix}").as_posix()
            yield f"{_escape(name)} ({len(paths)} files)", outcome
            continue
        for path in paths:
            yield path.relative_to(root).as_posix(), outcome


def _escape(text: str) -> str:
    """As Markdown's tables and mathematics leave it alone."""
    for sign, written in (("\\", "\\\\"), ("|", "\\|"), ("<", "&lt;"), ("$", "\\$"), ("*", "\\*")):
        text = text.replace(sign, written)
    return text.replace("\n", " ")


def make_page(
    outcomes: dict[tuple[str, Path], Outcome], kind: str, command: str, mesh_as: str, steps: int
) -> str:
    """The page of the documentation."""
    packages = sorted({package.replace(" ", "==") for package, _ in outcomes})
    head = HEADS[kind].format(
        steps=steps,
        kind="as convex hulls" if mesh_as == "hull" else "as models",
        packages=" ".join(packages),
        command=command,
    )
    return head + make_table(outcomes)


def main(arguments: list[str] | None = None) -> int:
    """The command line; returns the exit code."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n")[0])
    parser.add_argument("folders", nargs="+", type=Path, metavar="FOLDER", help="where to search")
    parser.add_argument("--format", choices=tuple(FORMATS), default="urdf", dest="kind")
    parser.add_argument(
        "--mesh-as", choices=("model", "hull"), default="hull", help="hull is faster"
    )
    parser.add_argument("--steps", type=int, default=10, help="for which each robot moves")
    parser.add_argument("--write", type=Path, metavar="PAGE", help="the page to write")
    parser.add_argument("--batch", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args(arguments)
    if given.batch:
        for path in given.folders:
            outcome = try_robot(str(path), given.kind, given.mesh_as, given.steps)
            print(json.dumps(asdict(outcome)), flush=True)
        return 0
    robots = [it for folder in given.folders for it in find_robots(folder, given.kind)]
    if not robots:
        print(f"no {given.kind.upper()} file below {', '.join(map(str, given.folders))}")
        return 1
    outcomes: dict[tuple[str, Path], Outcome] = {}
    batches = [robots[at : at + BATCH] for at in range(0, len(robots), BATCH)]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        tried = pool.map(
            lambda batch: try_apart(
                [path for _, path in batch], given.kind, given.mesh_as, given.steps
            ),
            batches,
        )
        for batch, found in zip(batches, tried, strict=True):
            for robot, outcome in zip(batch, found, strict=True):
                outcomes[robot] = outcome
                print(f"{outcome.result}: {robot[1]} {outcome.reason}".rstrip(), flush=True)
    loaded = sum(it.result == "loads" for it in outcomes.values())
    print(f"{loaded} of {len(outcomes)} files load")
    if given.write:
        options = "" if given.kind == "urdf" else f"--format {given.kind} "
        options += f"--mesh-as {given.mesh_as} --steps {given.steps} --write {given.write}"
        command = f".venv/bin/python tools/try_robots.py {options} robots"
        given.write.write_text(make_page(outcomes, given.kind, command, given.mesh_as, given.steps))
    return int(any(it.result == "fails" for it in outcomes.values()))


if __name__ == "__main__":
    sys.exit(main())
