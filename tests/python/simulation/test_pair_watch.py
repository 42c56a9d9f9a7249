from __future__ import annotations

from itertools import combinations

import pytest
import trimesh
import voxshell as vx
from voxshell.simulation import pair_watch
from voxshell.simulation.pair_watch import PairWatch


@pytest.fixture
def judged(monkeypatch: pytest.MonkeyPatch) -> list[frozenset[vx.Model]]:
    """Pairs that were judged, in order."""
    pairs: list[frozenset[vx.Model]] = []
    monkeypatch.setattr(
        pair_watch, "judge_world", lambda new: pairs.extend(frozenset((it.a, it.b)) for it in new)
    )
    return pairs


@pytest.fixture(scope="module")
def models() -> list[vx.Model]:
    return [vx.Model.from_mesh(trimesh.creation.box(), resolution=n) for n in (8, 9, 10)]


def put(watch: PairWatch, world: vx.World, *shapes: object, mass: float = 1.0) -> None:
    for shape in shapes:
        watch.note(world.add(shape, mass=mass))  # type: ignore[arg-type]
    watch.judge(world.bodies)


def test_each_pair_is_judged_once(judged, models):
    watch, world = PairWatch(), vx.World()
    put(watch, world, *models)
    assert set(judged) == {frozenset(pair) for pair in combinations(models, 2)}
    assert len(judged) == 3
    watch.judge(world.bodies)
    put(watch, world, vx.Sphere(0.1))
    assert len(judged) == 3


def test_two_bodies_of_one_model_are_a_pair_and_one_is_none(judged, models):
    watch, world = PairWatch(), vx.World()
    put(watch, world, models[0])
    assert judged == []
    put(watch, world, models[0])
    assert judged == [frozenset(models[:1])]
    put(watch, world, models[0])
    assert len(judged) == 1


def test_static_bodies_do_not_meet_each_other(judged, models):
    watch, world = PairWatch(), vx.World()
    put(watch, world, *models[:2], mass=0.0)
    assert judged == []
    put(watch, world, models[2])
    assert set(judged) == {frozenset((models[2], model)) for model in models[:2]}


def test_models_in_compounds_are_met_as_well(judged, models):
    watch, world = PairWatch(), vx.World()
    put(watch, world, vx.Compound([(models[0], (0, 0, 0)), (vx.Sphere(0.1), (1, 0, 0))]), models[1])
    assert judged == [frozenset(models[:2])]


def test_a_body_that_left_before_the_step_is_not_judged(judged, models):
    watch, world = PairWatch(), vx.World()
    body = world.add(models[0])
    watch.note(body)
    world.remove(body)
    put(watch, world, models[1])
    assert judged == []


def test_bodies_that_do_not_collide_are_judged_when_they_do(judged, models):
    world = vx.World(gravity=(0, 0, 0))
    a, b = (world.add(model, pose=(9 * i, 0, 0)) for i, model in enumerate(models[:2]))
    world.set_collision(a, b, False)
    world.step()
    assert judged == []
    world.set_collision(a, b, True)
    world.step()
    assert judged == [frozenset(models[:2])]


def test_bodies_of_groups_that_do_not_meet_are_judged_when_they_do(judged, models):
    world = vx.World(gravity=(0, 0, 0))
    ghosts = [
        world.add(model, pose=(9 * i, 0, 0), group=2, mask=1) for i, model in enumerate(models[:2])
    ]
    world.step()
    assert judged == []
    ghosts[0].mask = 2
    world.step()
    assert judged == []
    ghosts[1].mask = 2
    world.step()
    assert judged == [frozenset(models[:2])]


def test_bodies_that_a_joint_keeps_apart_are_judged_when_it_is_gone(judged, models):
    world = vx.World(gravity=(0, 0, 0))
    a, b = (world.add(model, pose=(9 * i, 0, 0)) for i, model in enumerate(models[:2]))
    joint = world.add_joint(vx.FixedJoint(), a, b)
    world.step()
    assert judged == []
    world.remove(joint)
    world.step()
    assert judged == [frozenset(models[:2])]


def test_bodies_of_a_joint_that_lets_them_collide_are_judged(judged, models):
    world = vx.World(gravity=(0, 0, 0))
    a, b = (world.add(model, pose=(9 * i, 0, 0)) for i, model in enumerate(models[:2]))
    world.add_joint(vx.FixedJoint(), a, b, collide=True)
    world.step()
    assert judged == [frozenset(models[:2])]


def test_a_third_body_may_meet_what_the_first_two_may_not(judged, models):
    world = vx.World(gravity=(0, 0, 0))
    other = world.add(models[1])
    for x in (9, 18):
        world.set_collision(other, world.add(models[0], pose=(x, 0, 0)), False)
    world.step()
    assert judged == [frozenset(models[:1])]
    world.add(models[0], pose=(27, 0, 0))
    world.step()
    assert judged[1:] == [frozenset(models[:2])]


def test_one_body_of_two_models_does_not_meet_itself(judged, models):
    world = vx.World(gravity=(0, 0, 0))
    world.add(vx.Compound([(models[0], (0, 0, 0)), (models[1], (9, 0, 0))]))
    world.step()
    assert judged == []


def test_removed_bodies_leave_nothing_behind(models):
    world, watch = vx.World(), PairWatch()
    a, b = (world.add(model) for model in models[:2])
    watch.set_collision(a, b, False)
    watch.forget(a)
    watch.forget(b)
    assert not watch._apart
