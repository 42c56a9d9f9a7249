"""Names of other libraries: an AttributeError that says what to use, and no cost or trace elsewhere."""

from __future__ import annotations

import copy
import pickle
import pydoc
import re
from pathlib import Path
from typing import Any

import pytest
import trimesh
import voxshell as vx
from voxshell.base import name_advice, near_names
from voxshell.base.near_names import Absent, find_closest
from voxshell.base.pybullet_names import PYBULLET
from voxshell.simulation.live_view import LiveView


@pytest.fixture(scope="module")
def things(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    model = vx.Model.from_mesh(trimesh.creation.box(), resolution=10)
    world = vx.World()
    body = world.add(model)
    recorder = world.record()
    view = LiveView(world._simulation, [body], time_step=world.time_step)
    links = tmp_path_factory.mktemp("robot") / "a.urdf"
    links.write_text("<robot name='a'><link name='b'/></robot>")
    return {
        "LiveView": view,
        "Recorder": recorder,
        "Robot": vx.load_urdf(vx.World(), links),
        "Body": body,
        "Contacts": vx.contacts(model, vx.Plane()),
        "Joint": world.add_joint(vx.HingeJoint(), None, body),
        "Model": model,
        "World": world,
    }


ABSENT = [(owner, name) for owner, table in name_advice.ABSENT.items() for name in table]
READ_ONLY = [(owner, name) for owner, table in name_advice.READ_ONLY.items() for name in table]


@pytest.mark.parametrize(("owner", "name"), ABSENT)
def test_an_absent_name_says_what_to_use(things, owner: str, name: str):
    thing = things[owner]
    advice = name_advice.ABSENT[owner][name]
    for use in (lambda: getattr(thing, name), lambda: setattr(thing, name, 1)):
        with pytest.raises(AttributeError) as caught:
            use()
        assert str(caught.value) == f"{owner!r} object has no attribute {name!r}: {advice}"
        assert caught.value.name == name
        assert caught.value.obj is None  # or Python adds a name that merely looks similar
    assert not hasattr(thing, name)
    assert not hasattr(type(thing), name)
    assert name not in dir(thing)
    found = advice.removeprefix("did you mean ").split()[0].rstrip("?,")
    if found != advice.split()[0]:
        assert hasattr(thing, found)


@pytest.mark.parametrize(("owner", "name"), READ_ONLY)
def test_a_property_that_cannot_be_set_says_what_to_do(things, owner: str, name: str):
    thing = things[owner]
    getattr(thing, name)
    with pytest.raises(AttributeError) as caught:
        setattr(thing, name, 1)
    assert str(caught.value).startswith(f"{name} of a {owner.lower()} cannot change: ")
    assert getattr(type(thing), name).__doc__


@pytest.mark.parametrize("owner", ["Body", "Joint", "Model", "World", "Contacts", "Robot"])
def test_other_names_are_refused_as_ever(things, owner: str):
    for use in (getattr, lambda thing, name: setattr(thing, name, 1)):
        with pytest.raises(AttributeError, match="no attribute 'colour'"):
            use(things[owner], "colour")


MISSPELLED = [
    ("LiveView", "sped", "speed"),
    ("Recorder", "stoped", "stopped"),
    ("Robot", "linkes", "links"),
]


@pytest.mark.parametrize(("owner", "name", "meant"), MISSPELLED)
def test_who_sets_a_misspelled_name_is_told_the_right_one(
    things, owner: str, name: str, meant: str
):
    with pytest.raises(AttributeError) as caught:
        setattr(things[owner], name, 3)
    assert str(caught.value) == (
        f"{owner!r} object has no attribute {name!r}: did you mean {meant}?"
    )
    assert (caught.value.name, caught.value.obj) == (name, None)
    assert hasattr(things[owner], meant)


def test_a_class_that_a_user_derives_may_have_other_attributes():
    class Table(vx.World):
        pass

    table = Table()
    table.hight = 3.0
    assert table.hight == 3.0
    with pytest.raises(AttributeError, match="time_step of a world cannot change"):
        table.time_step = 0.01


def test_dir_lists_what_is_there(things):
    assert {"linear_velocity", "apply_force", "mass"} <= set(dir(things["Body"]))
    assert {"add", "step", "gravity"} <= set(dir(things["World"]))
    assert re.search(
        r"run\n +\|? +Absent: did you mean step\?", pydoc.plain(pydoc.render_doc(vx.World))
    )


def test_classes_made_from_ours_may_use_the_names():
    class Lab(vx.World):
        def run(self) -> str:
            return "runs"

    lab = Lab()
    lab.dt = 0.1  # pyright: ignore[reportAttributeAccessIssue]
    assert (lab.dt, lab.run()) == (0.1, "runs")  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(AttributeError, match="did you mean view"):
        lab.show()  # pyright: ignore[reportAttributeAccessIssue]


def test_nothing_delays_the_names_that_are_there():
    for owner in ("Body", "Contacts", "Joint", "Model", "World"):
        cls = getattr(vx, owner)
        assert cls.__getattribute__ is object.__getattribute__
        assert cls.__setattr__ is object.__setattr__
        assert not hasattr(cls, "__getattr__")


def test_models_are_still_copied(things):
    model = things["Model"]
    for other in (copy.deepcopy(model), pickle.loads(pickle.dumps(model))):
        assert other.bounds.tolist() == model.bounds.tolist()


def test_the_tables_name_no_public_attribute():
    for owner, table in name_advice.ABSENT.items():
        for name in table:
            assert isinstance(vars(getattr(vx, owner))[name], Absent)


def test_a_name_that_is_far_from_all_has_no_neighbor():
    assert find_closest("siz", ("size", "pos")) == "size"
    assert find_closest("SIZE", ("size", "pos")) == "size"
    assert find_closest("x" * 100_000, ("size", "pos")) is None


@pytest.mark.parametrize(
    ("name", "advice"),
    [
        ("loadURDF", "did you mean load_urdf?"),
        ("contact", "did you mean contacts?"),
        ("Capsul", "did you mean Capsule?"),
        ("load_model", "call voxshell.Model.load(path)"),
        ("setGravity", "pass gravity=... to voxshell.World(), or set World.gravity"),
    ],
)
def test_a_name_that_the_package_does_not_have_says_what_to_use(name: str, advice: str):
    with pytest.raises(AttributeError) as caught:
        getattr(vx, name)
    assert str(caught.value) == f"module 'voxshell' has no attribute {name!r}: {advice}"
    assert not hasattr(vx, name)


PORTED = Path(__file__).parents[3] / "docs" / "porting-from-pybullet.md"


def test_every_function_of_pybullet_on_its_page_says_what_to_use(things):
    rows = [
        line.split("|")[1] for line in PORTED.read_text().splitlines() if line.startswith("| `")
    ]
    named = {name for row in rows for name in re.findall(r"`(\w+)", row)}
    assert len(named) > 20
    for name in sorted(named | set(PYBULLET)):
        for owner in (vx, things["World"]):
            with pytest.raises(AttributeError) as caught:
                getattr(owner, name)
            assert re.search(
                r": (call|use|pass|set|make|there is|it has|did you mean) ", str(caught.value)
            )
    assert "Cone" not in near_names.advise_on_name("connect", vx.__all__)


def test_what_stands_for_functions_of_pybullet_exists(things):
    owners = things | {"Recorder": vx.Recorder, "Robot": vx.Robot}
    for advice in PYBULLET.values():
        for owner, name in re.findall(r"\b(World|Body|Joint|Robot|Recorder)\.(\w+)", advice):
            made_in_init = owner == "Robot" and name in vx.Robot.__slots__
            assert made_in_init or hasattr(owners[owner], name), advice
        for name in re.findall(r"\bvoxshell\.(\w+)", advice):
            assert hasattr(vx, name), advice


def test_a_name_like_no_other_is_refused_as_ever():
    for name in ("zzz", "__path_of__", "_contact"):
        with pytest.raises(AttributeError) as caught:
            getattr(vx, name)
        assert str(caught.value) == f"module 'voxshell' has no attribute {name!r}"


def test_what_the_package_does_not_have_is_not_public():
    assert not set(name_advice.OF_PACKAGE) & set(vx.__all__)


def test_a_mesh_is_still_a_tuple_of_arrays(things):
    mesh = things["Model"].mesh
    assert pickle.loads(pickle.dumps(mesh))[1].tolist() == mesh.faces.tolist()
    assert vx.Mesh(*mesh)._replace(faces=1).faces == 1


@pytest.mark.parametrize(
    ("name", "advice"),
    [("useFixedBase", "did you mean fixed_base?"), ("basePosition", "did you mean pose?")],
)
def test_arguments_of_pybullet_are_known_in_its_spelling(name: str, advice: str):
    assert near_names.advise_on_argument("load_urdf", name, ["pose", "fixed_base"]) == advice
    with pytest.raises(vx.InputTypeError, match=re.escape(f"{name!r}: {advice}")):
        vx.load_urdf(vx.World(), "a.urdf", **{name: 1})
