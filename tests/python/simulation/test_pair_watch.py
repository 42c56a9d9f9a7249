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
    monkeypatch.setattr(pair_watch, "judge_world", lambda new: pairs.extend(map(frozenset, new)))
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
