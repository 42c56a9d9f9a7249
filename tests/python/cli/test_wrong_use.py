"""What people do wrong: each time one message, exit code 2, and nothing left behind."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import numpy as np
import pytest
import trimesh
import voxshell as vx

COMMANDS = [
    ("solve", "Unknown command"),
    ("reproduce bal", "Available commands: ball, "),
    ("reproduce bal", ", ... (see voxshell reproduce --help)"),
    (
        "build cone.stl -o x.vxs --tolerance 0.1 --resolution 9",
        "a uniform model (--voxel-size, --resolution, --point-spacing, --target-points), not both",
    ),
    ("query cone.vxs cone.vxs --a-pose 1 2", "--a-pose must be 3 numbers (x y z), 7 "),
    ("build", "parameter MESH requires an argument"),
    ("build cone.stl", "--output requires an argument"),
    ("build cone.stl -o", "-o requires an argument"),
    ("build cone.stl other.stl -o x.vxs", "too many arguments: other.stl"),
    ("build missing.stl -o x.vxs", "cannot read missing.stl: it does not exist"),
    ("build folder -o x.vxs", "cannot read folder: it is a folder"),
    ("build noise.stl -o x.vxs", "cannot read mesh noise.stl"),
    ("build empty.stl -o x.vxs", "empty.stl"),
    ("build line.stl -o x.vxs", "line.stl: "),
    ("build open.ply -o x.vxs --sign closed", "open.ply: mesh is not"),
    ("build cone.vxs -o x.vxs", "cone.vxs is a model already"),
    ("build cone.stl -o folder", "folder is a folder; name a file"),
    ("build cone.stl -o pipe", "pipe is not a regular file"),
    ("build cone.stl -o cone.stl/x.vxs", "x.vxs: cone.stl is not a folder"),
    ("build cone.stl -o nowhere/x.vxs", "the folder nowhere does not exist; create it first"),
    ("build cone.stl -o cone.stl", "cone.stl is the mesh itself"),
    ("build cone.stl -o noise.stl", "a model file needs a file name that ends in .vxs"),
    ("build cone.stl -o x", "'x' ends without a suffix; try 'x.vxs'"),
    ("build cone.stl -o x.vxs --voxel-size 0", "--voxel-size must be above 0"),
    ("build cone.stl -o x.vxs --voxel-size nan", "--voxel-size must be finite"),
    ("build cone.stl -o x.vxs --voxel-size 2mm", 'unable to convert "2mm" into float'),
    ("build cone.stl -o x.vxs --voxel-size 1e-6", "voxel size"),
    (
        "build cone.stl -o x.vxs --voxel-size 1 --resolution 9",
        "either --voxel-size or --resolution",
    ),
    (
        "build cone.stl -o x.vxs --point-spacing 1 --target-points 9",
        "either --point-spacing or --target-points",
    ),
    ("build cone.stl -o x.vxs --resolution 1", "resolution must be at least 2"),
    ("build cone.stl -o x.vxs --target-points 0", "--target-points must be at least 1"),
    ("build cone.stl -o x.vxs --scale -1", "scale must be above 0"),
    ("build cone.stl -o x.vxs --padding -1", "padding must be from 0"),
    ("build cone.stl -o x.vxs --sign guess", "Choose from"),
    ("build cone.stl -o x.vxs --threads 0", "threads must be from 1"),
    ("build cone.stl -o x.vxs --voxels 3", "Unknown option: --voxels"),
    ("info missing.vxs", "cannot read missing.vxs: it does not exist"),
    ("info torn.vxs", "torn.vxs: "),
    ("info false.vxs", "false.vxs: not a model file"),
    ("info noise.stl --advise", "cannot read mesh noise.stl"),
    ("info cone.vxs --scale 2", "scale is for meshes"),
    ("info cone.stl --scale 0", "scale must be above 0"),
    ("query cone.vxs", "requires an argument"),
    ("query cone.vxs missing.stl", "cannot read missing.stl: it does not exist"),
    ("bench missing.vxs", "cannot read missing.vxs: it does not exist"),
    ("info pipe", "cannot read mesh pipe"),
    ("query cone.vxs egg", "'egg' is neither a file nor a shape"),
    ("query cone.vxs sphere", "write sphere:RADIUS"),
    ("query cone.vxs sphere:big", "write sphere:RADIUS"),
    ("query cone.vxs box:1,2", "3 numbers, not 2"),
    ("query cone.vxs sphere:-1", "radius must be above 0"),
    ("query plane sphere:1", "must be a model"),
    ("query cone.vxs cone.vxs --pose", "not 0"),
    ("query cone.vxs cone.vxs --pose 1 2", "not 2"),
    ("query cone.vxs cone.vxs --ask", "ask must name a question"),
    ("query cone.vxs cone.vxs --pose 1 2 x", 'unable to convert "x" into float'),
    ("query cone.vxs cone.vxs --pose 0 0 0 1 1 0 0", "has the length 1.41421 instead of 1"),
    (
        "query cone.vxs cone.vxs --pose 0 0 nan",
        "pose: the position has an entry that is not finite",
    ),
    (
        "query cone.vxs cone.vxs --pose 2 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1",
        "rotation is not orthonormal (error 3, at most 0.001)",
    ),
    ("query cone.vxs cone.vxs --pose 0 0 0 --poses poses.csv", "either pose or poses"),
    ("query cone.vxs cone.vxs --poses missing.csv", "cannot read missing.csv: it does not exist"),
    ("query cone.vxs cone.vxs --poses poses.csv", "poses.csv:3: not all entries are numbers"),
    (
        "query cone.vxs cone.vxs --poses typo.csv",
        "typo.csv:1: not all entries are numbers: column 3 is 'O.01'",
    ),
    (
        "query cone.vxs cone.vxs --poses spaces.csv",
        "spaces.csv:1: not all entries are numbers: column 1 is '0 0 0.01'; separate numbers with commas",
    ),
    ("query cone.vxs cone.vxs --poses loop.csv", "cannot read loop.csv: Too many levels of"),
    ("simulate loop.toml --out x", "cannot read loop.toml: Too many levels of symbolic links"),
    ("query cone.vxs cone.vxs --poses short.csv", "short.csv:2 must be 3"),
    ("query cone.vxs cone.vxs --poses none.csv", "none.csv holds no poses"),
    ("query cone.vxs cone.vxs --poses flat.npy", "flat.npy must hold an array of numbers"),
    ("query cone.vxs cone.vxs --poses objects.npy", "objects.npy is not a NumPy array"),
    ("query cone.vxs cone.vxs --ask wrench", "wrench needs a stiffness"),
    ("query cone.vxs cone.vxs --ask wrench --stiffness -1", "stiffness must be at least 0"),
    ("query cone.vxs cone.vxs --ask depth", "Choose from"),
    ("query cone.vxs plane --shell b", "shell"),
    ("query cone.vxs cone.vxs --margin inf", "margin"),
    ("query cone.vxs cone.vxs --max-points -1", "--max-points must be"),
    ("bench sphere:1", "sphere:1 is a shape"),
    ("bench cone.vxs --poses 0", "poses must be from 1"),
    ("bench cone.vxs --repeats 0", "repeats must be from 1"),
    ("simulate", "requires an argument"),
    ("simulate scene.toml", "--out requires an argument"),
    ("simulate missing.toml --out x", "cannot read missing.toml: it does not exist"),
    ("simulate scene.toml --out cone.stl", "cone.stl is a file; name a folder"),
    ("simulate scene.toml --out taken", "taken/index.html is a folder"),
    ("simulate cone.stl --out x", "is not a scene file, which is TOML text; if it is a mesh, use"),
    ("simulate cone.stl --out x", "voxshell simulate drop cone.stl"),
    ("simulate words.obj --out x", "if it is a mesh, use voxshell simulate drop words.obj"),
    ("simulate cone.stl", "(see voxshell simulate --help)"),
    ("simulate drop --steps x", "(see voxshell simulate drop --help)"),
    ("simulate drop cone.vxs --out folder", "cone.vxs is a model already: "),
    (
        "simulate drop nan.obj --out folder",
        "nan.obj: 2 of 4 vertices of the mesh are not finite (first:",
    ),
    ("info nan.obj", "nan.obj: 2 of 4 vertices of the mesh are not finite (first:"),
    ("info beyond.ply", "beyond.ply: 1 of 36 face indices are out of range for 8 vertices"),
    (
        "build cone.stl -o x.vxs --voxel-size 100",
        "cone.stl: mesh has a longest side of 60 m, below the",
    ),
    ("build cone.stl -o x.vxs --padding 1e6", "use a padding of at most 60 m"),
    ("build cone.stl -o x.vxs --voxel-size 5e-3", "use a voxel size of at least"),
    ("simulate drop --steps 0", "steps must be at least 1"),
    ("simulate drop missing.stl --out x", "cannot read missing.stl: it does not exist"),
    ("simulate drop noise.stl --out x", "cannot read mesh noise.stl"),
    ("simulate drop noise.stl --out cone.stl", "cone.stl is a file; name a folder"),
    ("simulate drop noise.stl --out cone.stl/sub", "cone.stl is a file; name a folder"),
    ("simulate drop noise.stl --out taken", "taken/index.html is a folder"),
    ("reproduce tower", "Unknown command"),
    ("reproduce ball --out cone.stl", "cone.stl is a file; name a folder"),
    ("reproduce peers --out cone.stl/sub", "cone.stl is a file; name a folder"),
    ("reproduce ball --jobs 0 --out x", "jobs must be at least 1"),
    (
        "reproduce ball --settings missing.toml --out x",
        "cannot read missing.toml: it does not exist",
    ),
    ("reproduce ball --settings false.toml --out x", "false.toml: not valid TOML"),
    ("reproduce ball extra --out x", "too many arguments: extra"),
    ("view cone.vxs --show", "show must name at least one layer"),
    ("view noise.stl --export folder", "folder is a folder; name a file"),
    ("view noise.stl --export pipe", "pipe is not a regular file"),
    ("view noise.stl --export nowhere/x.html", "the folder nowhere does not exist; create it"),
    ("view cone.stl --export cone.stl", "a page needs a file name that ends in .html or .htm"),
    ("cache empty", "Unknown command"),
    ("cache list all", "too many arguments: all"),
]

DOOR = '[bodies.door]\nshape = "sphere"\nradius = 1\n'

PART = "[[bodies.a.parts]]\nshape = 'sphere'\nradius = 1\n"

# What a scene file says, and what is wrong with it, at which line.
SCENES = [
    ("[scene\n", 1, "not valid TOML: Expected ']'"),
    ("[scene]\nrate = 100\nrate = 200\n", 3, "not valid TOML: a key is given twice"),
    ("", 1, "bodies must contain at least one body"),
    ("[world]\n", 1, "world: unknown table; valid tables: scene, outputs"),
    ("bodies = 3\n", 1, "bodies must be a table"),
    ("[bodies]\nball = 3\n", 2, "bodies.ball must be a table"),
    ('[bodies."my ball"]\nshape = "plane"\n', 1, "names of letters, digits"),
    ("[scene]\nduration = 0\n", 2, "scene.duration must be above 0"),
    ("[scene]\n# slowly\nrate = -1\n", 3, "scene.rate must be above 0"),
    ("[scene]\nduration = 1e9\n", 2, "scene.duration must be at most"),
    ("[scene]\nrate = true\n", 2, "scene.rate must be a number"),
    ("[scene]\ngravity = [0, 0]\n", 2, "scene.gravity must be 3 finite numbers"),
    ("[scene]\n\ngravity = [\n 0,\n 0,\n nan,\n]\n", 3, "scene.gravity must be 3 finite"),
    ("[scene]\niterations = 0\n", 2, "scene.iterations must be from 1"),
    ('[scene]\ncontact = "soft"\n', 2, "scene.contact must be 'auto'"),
    ('[scene]\ncontact = "regular"\nlevel = 2\n', 3, "scene.level has no effect with contact"),
    ("[scene]\nspeed = 3\n", 2, "scene.speed: unknown setting; valid settings: title, duration"),
    ("[outputs]\nevery = 0\n", 2, "outputs.every must be from 1"),
    ('[outputs]\nposes = "xml"\n', 2, "outputs.poses must be 'parquet'"),
    ("[meshes.part]\nscale = 1\n", 1, "meshes.part.file must be given"),
    ('[meshes.part]\nfile = "part.stl"\nscale = 0\n', 3, "meshes.part.scale must be above 0"),
    (
        '[meshes.part]\nfile = "a.stl"\nvoxel_size = 1\nresolution = 9\n',
        4,
        "meshes.part.resolution and voxel_size cannot both be given",
    ),
    (
        '[meshes.part]\nfile = "a.stl"\ntolerance = "fine"\n',
        3,
        "meshes.part.tolerance must be a number, not 'fine'",
    ),
    (
        '[meshes.part]\nfile = "a.stl"\ntolerance = 0\n',
        3,
        "meshes.part.tolerance must be above 0, not 0",
    ),
    (
        '[meshes.part]\nfile = "a.stl"\ntolerance = 1e-4\ntarget_points = 9\n',
        3,
        "meshes.part.tolerance and target_points cannot both be given",
    ),
    (
        '[meshes.part]\nfile = "a.stl"\nopen = true\n',
        3,
        "meshes.part.open must be 'auto', 'solid' or 'sheet', not True",
    ),
    (
        '[meshes.part]\nfile = "a.stl"\nopen = "solid"\nsheet_thickness = 1\n',
        4,
        "meshes.part.sheet_thickness is for open='sheet' or 'auto'",
    ),
    ("[bodies.ball]\nmass = 1\n", 1, "bodies.ball.shape must be given, or mesh or parts"),
    ('[bodies.ball]\nshape = "egg"\n', 2, "bodies.ball.shape must be 'plane'"),
    ('[bodies.ball]\nshape = "sphere"\n', 1, "bodies.ball.radius must be given"),
    ('[bodies.ball]\nshape = "sphere"\nradius = 0\n', 3, "bodies.ball.radius must be above 0"),
    (
        '[bodies.ball]\nshape = "sphere"\nradius = 1\noffset = 1\n',
        4,
        "bodies.ball.offset is not a setting of a sphere",
    ),
    (
        '[bodies.ball]\nshape = "sphere"\nradius = 1\nmass = -1\n',
        4,
        "bodies.ball.mass must be at least 0 kg (0: static), not -1",
    ),
    (
        '[bodies.ball]\nshape = "sphere"\nradius = 1\nmotion = "free"\n',
        4,
        "bodies.ball.motion must be 'dynamic', 'static' or 'kinematic', not 'free'",
    ),
    (
        '[bodies.ball]\nshape = "sphere"\nradius = 1\nmotion = "dynamic"\nmass = 0\n',
        5,
        "bodies.ball.mass of a dynamic body must be above 0 kg",
    ),
    (
        '[bodies.ball]\nshape = "sphere"\nradius = 1\nmotion = "static"\n'
        "linear_velocity = [1, 0, 0]\n",
        5,
        "bodies.ball.linear_velocity is for dynamic and kinematic bodies",
    ),
    (
        '[bodies.ground]\nshape = "plane"\nmotion = "dynamic"\n',
        3,
        "bodies.ground.motion of a plane must be 'static'",
    ),
    (
        f'{DOOR}motion = "kinematic"\n[joints.j]\nchild = "door"\nkind = "fixed"\n',
        6,
        "joints.j.child must be a body that moves, or its parent",
    ),
    ('[bodies.ground]\nshape = "plane"\nmass = 2\n', 3, "bodies.ground.mass of a plane must be 0"),
    (
        '[bodies.brick]\nshape = "box"\nhalf_extents = [1, 1, 0]\n',
        3,
        "bodies.brick.half_extents must be above 0",
    ),
    (
        '[bodies.brick]\nmesh = "part"\n',
        2,
        "bodies.brick.mesh is 'part', but the scene has no [meshes.NAME]",
    ),
    ('[bodies.ground]\nshape = "plane"\nfriction = -1\n', 3, "bodies.ground.friction must be at"),
    (
        '[bodies.ground]\nshape = "plane"\nrolling_friction = -1\n',
        3,
        "bodies.ground.rolling_friction must be at least 0, not -1",
    ),
    ('[bodies.ground]\nshape = "plane"\nrestitution = 2\n', 3, "bodies.ground.restitution must be"),
    (
        '[bodies.ground]\nshape = "plane"\nquaternion_xyzw = [0, 0, 0, 2]\n',
        3,
        "bodies.ground.quaternion_xyzw must have length 1, not 2",
    ),
    (
        '[bodies.a]\nshape = "plane"\nposition = [0, "up", 0]\n',
        3,
        "bodies.a.position[1] must be a number, not 'up'",
    ),
    ('[bodies.a]\nshape = "cone"\nradius = 1\n', 1, "bodies.a.height must be given for a cone"),
    (f'{DOOR}[joints.j]\nkind = "hinge"\n', 4, "joints.j.child must be given"),
    (f'{DOOR}[joints.j]\nkind = "rope"\n', 5, "joints.j.kind must be 'fixed', 'hinge'"),
    (
        f'{DOOR}[joints.j]\nchild = "gate"\nkind = "fixed"\n',
        5,
        "joints.j.child is 'gate', but the scene has only the bodies door",
    ),
    (
        f'{DOOR}[joints.j]\nchild = "door"\nparent = "door"\nkind = "fixed"\n',
        6,
        "joints.j.parent must not be the child itself",
    ),
    (
        f'{DOOR}[joints.j]\nchild = "door"\nkind = "point"\nlimits = [0, 1]\n',
        7,
        "joints.j.limits is not a setting of a point joint",
    ),
    (
        f'{DOOR}[joints.j]\nchild = "door"\nkind = "hinge"\nlimits = [1, 0]\n',
        7,
        "joints.j.limits must be in order",
    ),
    (
        f'{DOOR}[joints.j]\nchild = "door"\nkind = "slider"\ntarget_velocity = 1\n',
        4,
        "joints.j.max_force must be given with a target",
    ),
    (
        f'{DOOR}[joints.j]\nchild = "door"\nkind = "hinge"\nstiffness = -1\n',
        7,
        "joints.j.stiffness must be at least 0",
    ),
    (
        f'{DOOR}[joints.j]\nchild = "door"\nkind = "hinge"\nspring_position = 1\n',
        7,
        "joints.j.spring_position needs a stiffness",
    ),
    (f"{DOOR}parts = 3\n", 4, "bodies.door.parts must be a list, not 3"),
    (f"{DOOR}parts = [3]\n", 4, "bodies.door.parts[0] must be a table, not 3"),
    (
        f"{DOOR}[[bodies.door.parts]]\nshape = 'sphere'\nradius = 1\n",
        2,
        "bodies.door.shape must be given, or mesh or parts, but only one",
    ),
    ("[bodies.a]\nmass = 1\nparts = []\n", 1, "bodies.a.shape must be given, or mesh or parts"),
    (
        "[bodies.a]\nmass = 1\nparts = [{shape = 'sphere', radius = 0}]\n",
        3,
        "bodies.a.parts[0].radius must be above 0",
    ),
    (
        f"[bodies.a]\nmass = 1\n\n{PART}{PART}mass = 1\n",
        4,
        "bodies.a.parts[1].mass: unknown setting; valid settings: mesh, shape, normal",
    ),
    (f"[bodies.a]\n{PART}\n[[bodies.a.parts]]\n", 2, "bodies.a.parts[1].shape or mesh must be"),
    (f"[bodies.a]\nradius = 1\n{PART}", 2, "bodies.a.radius is not a setting of a body of parts"),
    ("[bodies.a]\nparts = [{shape = 'plane'}]\n", 2, "bodies.a.parts[0].shape must not be a plane"),
    (
        "[bodies.a]\nparts = [{mesh = 'm'}]\n",
        2,
        "bodies.a.parts[0].mesh is 'm', but the scene has no",
    ),
    (f"{DOOR}group = -1\n", 4, "bodies.door.group must be at least 0, not -1"),
    (
        f"{DOOR}mask = 0x1_0000_0000\n",
        4,
        "bodies.door.mask must be from 0 to 2147483647, not 42949",
    ),
    (f"{DOOR}\nmask = 0.5\n", 5, "bodies.door.mask must be an integer, not 0.5"),
    (f"{DOOR}linear_damping = 2\n", 4, "bodies.door.linear_damping must be from 0 to 1, not 2"),
    (f"{DOOR}angular_damping = -1\n", 4, "bodies.door.angular_damping must be from 0 to 1, not -1"),
    (f"{DOOR}surface_velocity = [1]\n", 4, "bodies.door.surface_velocity must be 3 finite numbers"),
    (
        f'{DOOR}motion = "static"\nsurface_velocity = [1, 0, 0]\n',
        5,
        "bodies.door.surface_velocity is for bodies with motion = 'kinematic'",
    ),
    (
        f'[scene]\nsolver = "nncg"\n{DOOR}motion = "kinematic"\nsurface_velocity = [1, 0, 0]\n',
        3,
        "bodies.door: surface_velocity needs a world with solver='coulomb'",
    ),
    ('[bodies.a]\nshape = "plane"\ncolor = [300, 0, 0]\n', 3, "bodies.a.color must be three"),
    (
        '[meshes.m]\nfile = "gone.stl"\n[bodies.a]\nmesh = "m"\n',
        2,
        "gone.stl: it does not exist",
    ),
    (
        '[meshes.m]\nfile = "cone.stl"\nvoxel_size = 1e-6\n[bodies.a]\nmesh = "m"\n',
        2,
        "voxel size",
    ),
]


@pytest.fixture(scope="module")
def things(tmp_path_factory, cone_path, cone_model_path):
    """A folder with good and bad files."""
    folder = tmp_path_factory.mktemp("things")
    (folder / "folder").mkdir()
    (folder / "taken" / "index.html").mkdir(parents=True)
    os.mkfifo(folder / "pipe")
    shutil.copy(cone_path, folder / "cone.stl")
    shutil.copy(cone_model_path, folder / "cone.vxs")
    whole = cone_model_path.read_bytes()
    (folder / "torn.vxs").write_bytes(whole[: len(whole) // 2])
    (folder / "false.vxs").write_text("a letter")
    (folder / "noise.stl").write_bytes(np.random.default_rng(1).bytes(500))
    (folder / "empty.stl").write_bytes(b"")
    line = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 1, 2]], process=False)
    line.export(folder / "line.stl")
    box = trimesh.creation.box()
    trimesh.Trimesh(box.vertices, box.faces[:-1]).export(folder / "open.ply")
    (folder / "words.obj").write_text("v a b c\nf 1 2 3\n")
    corners = ["v 0 0 0", "v 1 0 0", "v nan 1 0", "v 0 0 inf"]
    (folder / "nan.obj").write_text("\n".join([*corners, "f 1 2 3", "f 1 2 4", ""]))
    box.export(folder / "beyond.ply", encoding="ascii")
    text = (folder / "beyond.ply").read_text()
    (folder / "beyond.ply").write_text(text.replace("\n3 1 3 0", "\n3 1 999 0"))
    (folder / "poses.csv").write_text("x,y,z\n0,0,1\n0,zero,1\n")
    (folder / "typo.csv").write_text("0,0,O.01\n0,0,0.02\n")
    (folder / "spaces.csv").write_text("0 0 0.01\n")
    for loop in ("loop.csv", "loop.toml"):
        (folder / loop).symlink_to(loop)
    (folder / "short.csv").write_text("0,0,1\n0,1\n")
    (folder / "none.csv").write_text("x,y,z\n")
    np.save(folder / "flat.npy", np.zeros(3))
    np.save(folder / "objects.npy", np.array([{}]), allow_pickle=True)
    (folder / "false.toml").write_text("ball")
    (folder / "scene.toml").write_text('[bodies.ground]\nshape = "plane"\n')
    return folder


def expect_refusal(ended, folder: Path, before: set[Path], part: str) -> None:
    assert ended.code == 2, ended
    assert ended.out == ""
    [said] = [line for line in ended.err.splitlines() if line and "left" not in line]
    assert said.startswith("error: ")
    assert part in said
    assert "Traceback" not in ended.err
    assert set(folder.rglob("*")) == before


@pytest.mark.parametrize(("command", "part"), COMMANDS, ids=[command for command, _ in COMMANDS])
def test_wrong_arguments_and_files(voxshell, things, monkeypatch, command, part):
    monkeypatch.chdir(things)
    before = set(things.rglob("*"))
    expect_refusal(voxshell(*command.split()), things, before, part)


@pytest.mark.parametrize(
    ("text", "line", "part"), SCENES, ids=[part.partition(" must")[0] for _, _, part in SCENES]
)
def test_wrong_scene_files(voxshell, tmp_path, monkeypatch, cone_path, text, line, part):
    monkeypatch.chdir(tmp_path)
    shutil.copy(cone_path, tmp_path)
    (tmp_path / "scene.toml").write_text(text)
    before = set(tmp_path.rglob("*"))
    ended = voxshell("simulate", "scene.toml", "--out", "result")
    expect_refusal(ended, tmp_path, before, part)
    assert f"error: scene.toml:{line}: " in ended.err


def test_table_of_another_command_is_no_wrong_use(tmp_path):
    from voxshell_studies.cli.reproduce import OTHER_TABLES
    from voxshell_studies.report.catalog import EXPERIMENTS
    from voxshell_studies.reproduction import plan_studies

    known = [*(each.name for each in EXPERIMENTS), *OTHER_TABLES]
    [study] = plan_studies(
        EXPERIMENTS[:1], tmp_path, quick=True, overrides={"peers": {"rates": [20]}}, known=known
    )
    assert study.experiment is EXPERIMENTS[0]


def test_memory_that_runs_out_is_said_in_a_line(voxshell, cone_path, monkeypatch):
    """It was a traceback."""

    def fail(*_: object, **__: object) -> None:
        raise MemoryError

    monkeypatch.setattr(vx.Model, "from_mesh", fail)
    ending = voxshell("info", cone_path)
    assert ending.code == 1
    assert ending.err.startswith("error: out of memory; ")
    assert ending.err.count("\n") == 1
