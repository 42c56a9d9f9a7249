"""Scene files, and files of settings, in TOML."""

from __future__ import annotations

from collections.abc import Iterator

from .bodies import stl, triangles
from .case import Case, Content, Wants, of_files

SCENE = """[scene]
duration = 0.01
rate = 200
[outputs]
replay = false
plot = false
poses = "csv"
contacts = "none"
[meshes.part]
file = "part.stl"
resolution = 12
[bodies.ground]
shape = "plane"
[bodies.part]
mesh = "part"
mass = 0.2
position = [0, 0, 0.3]
[bodies.ball]
shape = "sphere"
radius = 0.1
mass = 1
position = [1, 0, 0.3]
[joints.hinge]
kind = "hinge"
child = "ball"
axis = [0, 0, 1]
limits = [-1, 1]
"""

LINES: tuple[tuple[str, str, str, Wants], ...] = (
    ("a duration of NaN", "duration = 0.01", "duration = nan", "refused"),
    ("a duration of infinity", "duration = 0.01", "duration = inf", "refused"),
    ("a negative duration", "duration = 0.01", "duration = -1", "refused"),
    ("a duration of 1e300", "duration = 0.01", "duration = 1e300", "refused"),
    ("a duration of a word", "duration = 0.01", 'duration = "long"', "refused"),
    ("a duration of true", "duration = 0.01", "duration = true", "refused"),
    ("a duration of a date", "duration = 0.01", "duration = 1979-05-27", "refused"),
    ("a rate of 0", "rate = 200", "rate = 0", "refused"),
    ("a rate of -1", "rate = 200", "rate = -1", "refused"),
    ("a rate of 2**70", "rate = 200", f"rate = {2**70}", "refused"),
    ("a rate of 1e-300", "rate = 200", "rate = 1e-300", "refused"),
    ("an integer of 5000 digits", "rate = 200", "rate = " + "9" * 5000, "refused"),
    ("gravity of two numbers", "rate = 200", "gravity = [0, 1]", "refused"),
    ("gravity of NaN", "rate = 200", "gravity = [0, nan, 0]", "refused"),
    ("gravity of 1e300", "rate = 200", "gravity = [0, 0, 1e300]", "refused"),
    ("gravity of words", "rate = 200", 'gravity = ["a", "b", "c"]', "refused"),
    ("an unknown contact", "rate = 200", 'contact = "telepathic"', "refused"),
    ("level 0", "rate = 200", 'contact = "segmented"\nlevel = 0', "refused"),
    ("level 13", "rate = 200", 'contact = "segmented"\nlevel = 13', "refused"),
    ("level 2**70", "rate = 200", f'contact = "segmented"\nlevel = {2**70}', "refused"),
    ("no iterations", "rate = 200", "iterations = 0", "refused"),
    ("1e12 iterations", "rate = 200", f"iterations = {10**12}", "refused"),
    ("an unknown solver", "rate = 200", 'solver = "oracle"', "refused"),
    ("sleeping of a word", "rate = 200", 'sleeping = "yes"', "refused"),
    ("a threshold of NaN", "rate = 200", "ccd_motion_threshold = nan", "refused"),
    ("a negative threshold", "rate = 200", "ccd_motion_threshold = -1", "refused"),
    ("a title of a number", "rate = 200", "title = 5", "refused"),
    ("a title of a script", "rate = 200", 'title = "</script><script>alert(1)</script>"', "loaded"),
    ("a title of a megabyte", "rate = 200", f'title = "{"a" * 1_000_000}"', "either"),
    ("control characters in the title", "rate = 200", 'title = "\\u001b[31m\\u0000"', "either"),
    ("an unknown key", "rate = 200", "evil = 1", "refused"),
    ("a key twice", "rate = 200", "rate = 200\nrate = 200", "refused"),
    ("a table twice", "[outputs]", "[scene]\n[outputs]", "refused"),
    ("an unknown table", "[outputs]", "[evil]\na = 1\n[outputs]", "refused"),
    ("tables as a list", "[outputs]", "[[outputs]]", "refused"),
    ("an unknown kind of poses", 'poses = "csv"', 'poses = "xml"', "refused"),
    ("a path as kind of poses", 'poses = "csv"', 'poses = "../../poses"', "refused"),
    ("every 0 steps", 'poses = "csv"', "every = 0", "refused"),
    ("every -1 steps", 'poses = "csv"', "every = -1", "refused"),
    ("every 2**70 steps", 'poses = "csv"', f"every = {2**70}", "either"),
    ("no file of a mesh", 'file = "part.stl"', "", "refused"),
    ("a missing file", 'file = "part.stl"', 'file = "missing.stl"', "refused"),
    ("a damaged mesh", 'file = "part.stl"', 'file = "damaged.stl"', "refused"),
    ("the scene as mesh", 'file = "part.stl"', 'file = "scene.toml"', "refused"),
    ("a folder as mesh", 'file = "part.stl"', 'file = "."', "refused"),
    ("a device as mesh", 'file = "part.stl"', 'file = "/dev/zero"', "refused"),
    ("a file of the system as mesh", 'file = "part.stl"', 'file = "../../../../etc/passwd"',
     "refused"),
    ("NUL in a file's name", 'file = "part.stl"', 'file = "a\\u0000b.stl"', "refused"),
    ("the network as mesh", 'file = "part.stl"', 'file = "http://127.0.0.1:9/a.stl"', "refused"),
    ("a number as file", 'file = "part.stl"', "file = 5", "refused"),
    ("a file's name of 300 letters", 'file = "part.stl"', f'file = "{"a" * 300}.stl"', "refused"),
    ("resolution 0", "resolution = 12", "resolution = 0", "refused"),
    ("resolution 10**9", "resolution = 12", f"resolution = {10**9}", "refused"),
    ("voxels of 1e-12 m", "resolution = 12", "voxel_size = 1e-12", "refused"),
    ("voxels of NaN", "resolution = 12", "voxel_size = nan", "refused"),
    ("10**15 points", "resolution = 12", f"target_points = {10**15}", "refused"),
    ("a scale of 0", "resolution = 12", "scale = 0", "refused"),
    ("a scale of -1", "resolution = 12", "scale = -1", "refused"),
    ("a scale of 1e300", "resolution = 12", "resolution = 12\nscale = 1e300", "refused"),
    ("a scale of 1e-300", "resolution = 12", "resolution = 12\nscale = 1e-300", "refused"),
    ("an unknown sign", "resolution = 12", 'sign = "zodiac"', "refused"),
    ("no shape", 'shape = "sphere"', "", "refused"),
    ("an unknown shape", 'shape = "sphere"', 'shape = "torus"', "refused"),
    ("a shape of a list", 'shape = "sphere"', 'shape = ["sphere"]', "refused"),
    ("a shape and a mesh", 'shape = "sphere"', 'shape = "sphere"\nmesh = "part"', "refused"),
    ("an unknown mesh", 'mesh = "part"', 'mesh = "missing"', "refused"),
    ("a radius of 0", "radius = 0.1", "radius = 0", "refused"),
    ("a radius of NaN", "radius = 0.1", "radius = nan", "refused"),
    ("a radius of 1e300", "radius = 0.1", "radius = 1e300", "refused"),
    ("a radius of 1e-300", "radius = 0.1", "radius = 1e-300", "either"),
    ("no radius", "radius = 0.1", "", "refused"),
    ("half extents of a sphere", "radius = 0.1", "half_extents = [1, 1, 1]", "refused"),
    ("a mass of NaN", "mass = 1\n", "mass = nan\n", "refused"),
    ("a negative mass", "mass = 1\n", "mass = -1\n", "refused"),
    ("a mass of 1e300", "mass = 1\n", "mass = 1e300\n", "refused"),
    ("a mass of 1e-320", "mass = 1\n", "mass = 1e-320\n", "either"),
    ("a mass of infinity", "mass = 1\n", "mass = inf\n", "refused"),
    ("a position of two numbers", "position = [1, 0, 0.3]", "position = [1, 0]", "refused"),
    ("a position of a number", "position = [1, 0, 0.3]", "position = 1", "refused"),
    ("a position of lists", "position = [1, 0, 0.3]", "position = [[1], [0], [0.3]]", "refused"),
    ("a position of NaN", "position = [1, 0, 0.3]", "position = [nan, 0, 0]", "refused"),
    ("a position of 1e300", "position = [1, 0, 0.3]", "position = [1e300, 0, 0]", "refused"),
    ("a turn of zeros", "radius = 0.1", "radius = 0.1\nquaternion_xyzw = [0, 0, 0, 0]", "refused"),
    ("two turns", "radius = 0.1",
     "radius = 0.1\nquaternion_xyzw = [0, 0, 0, 1]\nrotation_vector = [0, 0, 0]", "refused"),
    ("a turn of 1e300", "radius = 0.1", "radius = 0.1\nrotation_vector = [1e300, 0, 0]", "either"),
    ("a speed of 1e300", "radius = 0.1", "radius = 0.1\nlinear_velocity = [1e300, 0, 0]",
     "either"),
    ("a color of 256", "radius = 0.1", "radius = 0.1\ncolor = [256, 0, 0]", "refused"),
    ("a color of fractions", "radius = 0.1", "radius = 0.1\ncolor = [0.5, 0, 0]", "refused"),
    ("a friction of -1", "radius = 0.1", "radius = 0.1\nfriction = -1", "refused"),
    ("a restitution of 5", "radius = 0.1", "radius = 0.1\nrestitution = 5", "refused"),
    ("an unknown kind of a joint", 'kind = "hinge"', 'kind = "glue"', "refused"),
    ("a joint without a child", 'child = "ball"', "", "refused"),
    ("a joint of a missing body", 'child = "ball"', 'child = "missing"', "refused"),
    ("a joint of a body with itself", 'child = "ball"', 'child = "ball"\nparent = "ball"', "refused"),
    ("a joint of a plane", 'child = "ball"', 'child = "ground"', "refused"),
    ("an axis of zeros", "axis = [0, 0, 1]", "axis = [0, 0, 0]", "refused"),
    ("an axis of NaN", "axis = [0, 0, 1]", "axis = [0, 0, nan]", "refused"),
    ("limits the wrong way round", "limits = [-1, 1]", "limits = [1, -1]", "refused"),
    ("limits of NaN", "limits = [-1, 1]", "limits = [nan, 1]", "refused"),
    ("three limits", "limits = [-1, 1]", "limits = [-1, 0, 1]", "refused"),
    ("a negative damping", "limits = [-1, 1]", "damping = -1", "refused"),
    ("a force of infinity", "limits = [-1, 1]", "target_velocity = 1\nmax_force = inf", "either"),
)  # fmt: skip


def list_texts() -> Iterator[tuple[str, Content, Wants]]:
    yield "empty", "", "refused"
    yield "not TOML", "solid", "refused"
    yield "cut", SCENE[:-4], "refused"
    yield "cut in a table's name", SCENE[: SCENE.index("[joints") + 5], "refused"
    yield "UTF-16", SCENE.encode("utf-16"), "refused"
    yield "a byte order mark", b"\xef\xbb\xbf" + SCENE.encode(), "either"
    yield "Latin-1", b"# \xf6\n" + SCENE.encode(), "refused"
    yield "NUL", SCENE.replace("rate", "\0rate"), "refused"
    yield "carriage returns alone", SCENE.replace("\n", "\r"), "either"
    yield "carriage returns and line feeds", SCENE.replace("\n", "\r\n"), "loaded"
    yield "noise", bytes(range(256)) * 10, "refused"
    yield "100000 brackets", "a = " + "[" * 100_000, "refused"
    yield "10000 brackets that are closed", "a = " + "[" * 10_000 + "]" * 10_000, "refused"
    yield "a key of 10000 parts", ".".join("a" * 10_000) + " = 1", "refused"
    yield "1000 nested tables", "a = " + "{a = " * 1000 + "1" + "}" * 1000, "refused"
    yield "a line of five megabytes", lambda: b'a = "' + b"a" * 5_000_000 + b'"', "refused"
    yield "a list in place of a table", 'scene = []\nbodies = "none"\n', "refused"
    yield "a number in place of a body", SCENE + "[bodies]\nx = 5\n", "refused"
    yield "no bodies", "[scene]\nduration = 0.01\n", "refused"
    yield "an empty name", SCENE + '[bodies.""]\nshape = "plane"\n', "either"
    yield (
        "a path as name",
        (
            SCENE
            + '[bodies."../../etc/passwd"]\nshape = "sphere"\nradius = 1\nposition = [9, 0, 9]\n'
        ),
        "either",
    )
    yield (
        "line feeds in a name",
        (SCENE + '[bodies."a\\nb,c"]\nshape = "sphere"\nradius = 1\nposition = [9, 0, 9]\n'),
        "either",
    )
    yield (
        "2000 joints of one body",
        (SCENE + "".join(f'[joints.j{i}]\nkind = "point"\nchild = "ball"\n' for i in range(2000))),
        "either",
    )
    yield (
        "40 balls in one place",
        (
            SCENE
            + "".join(
                f'[bodies.b{i}]\nshape = "sphere"\nradius = 0.1\nposition = [5, 0, 5]\n'
                for i in range(40)
            )
        ),
        "either",
    )
    yield (
        "joints in a circle",
        (
            SCENE
            + "".join(
                f'[bodies.b{i}]\nshape = "sphere"\nradius = 0.1\nposition = [{3 + i}, 0, 5]\n'
                f'[joints.k{i}]\nkind = "fixed"\nchild = "b{i}"\nparent = "b{(i + 1) % 3}"\n'
                for i in range(3)
            )
        ),
        "either",
    )


SETTINGS: tuple[tuple[str, Content, Wants], ...] = (
    ("not TOML", "solid", "refused"),
    ("an unknown experiment", "[evil]\na = 1\n", "refused"),
    ("an unknown setting", "[slope]\nevil = 1\n", "refused"),
    ("a number in place of a table", "slope = 1\n", "refused"),
    ("a list of tables", "[[slope]]\n", "refused"),
    ("UTF-16", "[slope]\n".encode("utf-16"), "refused"),
    ("NUL", "[slope]\n\0", "refused"),
    ("a key twice", "[slope]\n[slope]\n", "refused"),
    ("100000 brackets", "a = " + "[" * 100_000, "refused"),
    ("a key of 10000 parts", ".".join("a" * 10_000) + " = 1", "refused"),
    ("an integer of 5000 digits", "[slope]\nseconds = " + "9" * 5000, "refused"),
)


def list_cases() -> Iterator[Case]:
    part = stl(triangles() * 0.1)
    others = {"part.stl": part, "damaged.stl": part[:100]}
    for name, line, other, wants in LINES:
        assert line in SCENE, line
        text = SCENE.replace(line, other, 1)
        yield of_files("scene", name, "scene.toml", text, wants, others)
    for name, content, wants in list_texts():
        yield of_files("scene", name, "scene.toml", content, wants, others)
    for name, content, wants in SETTINGS:
        yield of_files("settings", name, "settings.toml", content, wants)
