"""Held-out everyday scenes: their closed forms, where other engines agree with them, and how bodies begin.

No test here runs models, so that nothing is tuned by these scenes.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from voxshell_studies.everyday.runs import is_installed, run_stage
from voxshell_studies.everyday.study import EverydaySettings, measure_scene
from voxshell_studies.scenes.everyday import SCENES, held_out, impact_laws, laws
from voxshell_studies.scenes.everyday.held_out import bodies
from voxshell_studies.scenes.everyday.scene import Engine, Form, Item
from voxshell_studies.scenes.solids import import_manifold


def errors(name: str, engine: Engine, rates: tuple[float, ...]) -> np.ndarray:
    """The worst error over the bar of each measure in one placement; 0 or infinite where the bar is 0."""
    settings = EverydaySettings(placements=1, rates=rates, longest=3.0)
    runs = measure_scene(settings, name, engine)["runs"]
    return np.array(
        [
            error / measure.bar if measure.bar else (0.0 if error == 0.0 else math.inf)
            for number, measure in enumerate(SCENES[name].measures)
            for error in (runs["error"][runs["measure"] == number].max(),)
        ]
    )


# ---- other engines -------------------------------------------------------------------------------

FINE = (1000.0,)
MIDDLE = (1000.0, 200.0)
EACH = (1000.0, 200.0, 60.0, 30.0)


@pytest.mark.parametrize(
    ("name", "rates"),
    [
        ("container of 1000 kg stops", MIDDLE),
        ("die of 5 mm and 1 g slides down 40 degrees at friction 0.6", MIDDLE),
        ("brick slides off 3 degrees without friction", EACH),
        ("brick holds on 42 degrees at friction 1", FINE),
        ("crate stays below the friction limit", FINE),
        ("crate moves above the friction limit", FINE),
        ("cube pulled across a slope leaves diagonally", FINE),
        ("board is pulled away beneath a box", FINE),
        ("spinning ring slides farther", FINE),
        ("block on its edge slides down a V-groove", EACH),
        ("rod holds in a V-groove", FINE),
        ("hoop, disc and ball race down 10 degrees", FINE),
        ("ball rolls down two rails", EACH),
        ("ball rolls down a V-groove", EACH),
        ("ball rolls up a slope and down", MIDDLE),
        ("ball rolls on a turntable", EACH),
        ("ball rolls off a table", MIDDLE),
        ("can of 32 sides rolls down 10 degrees", MIDDLE),
        ("can of 64 sides rolls down 10 degrees", MIDDLE),
        ("pencil rolls off 34 degrees", EACH),
        ("half a cylinder rocks", MIDDLE),
        ("ring swings on a peg", MIDDLE),
        ("ball bounces obliquely and ends up rolling", EACH),
        ("ball bounces obliquely and slips", EACH),
        ("spinning ball dropped straight leaves sideways", EACH),
        ("disc bounces off a wall at 45 degrees", (200.0, 60.0, 30.0)),
        ("crate trips over a curb", MIDDLE),
        ("crate stops at a curb", EACH),
        ("marble rattles in a closed can", FINE),
        ("hammer of 1000 kg hits a cube of 1 g", EACH),
        ("ball hits a rod near its end", EACH),
        ("ladder holds at 45 degrees", MIDDLE),
        ("ladder slips at 30 degrees", EACH),
        ("table stands below 20 kg on its overhang", MIDDLE),
        ("table tips below 45 kg on its overhang", EACH),
        ("hung plank stays level between 1 kg and 2 kg", EACH),
        ("book holds over a table's edge", MIDDLE),
        ("book falls off a table's edge", EACH),
        ("four books reach over a table's edge", MIDDLE),
        ("rod falls flat on a smooth slab", MIDDLE),
        ("sheet of 1 m and 1 mm lands flat", MIDDLE),
        ("book begins 2 mm inside a table", EACH),
        ("ball comes to rest between two walls", EACH),
        ("brake stops a wheel", MIDDLE),
        ("ratchet holds 50 N", MIDDLE),
        ("cam lifts a follower", MIDDLE),
        ("wedge lifts a roller", MIDDLE),
        ("square key cannot turn in its hole", MIDDLE),
        ("chain of four light rings hangs", EACH),
    ],
)
def test_shapes_of_bullet_do_what_the_truth_says(name, rates):
    assert errors(name, "bullet", rates).max() <= 1.0


@pytest.mark.skipif(not is_installed("mujoco"), reason="needs MuJoCo")
@pytest.mark.parametrize(
    "name",
    [
        # Where the margin of Bullet's hulls spoils the truth.
        "pencil stays on 25 degrees",
        "washer of 5 mm lands flat",
        "mug lands upright",
        "three cups stand in each other",
        "peg falls through a hole with 0.2 mm of play",
        "peg too wide by 0.3 mm stays on a hole",
        "ring thrown around a post stays around it",
        # Where both are right.
        "container of 1000 kg stops",
        "crate moves above the friction limit",
        "board is pulled away beneath a box",
        "ball rolls down two rails",
        "ball rolls up a slope and down",
        "half a cylinder rocks",
        "ring swings on a peg",
        "crate trips over a curb",
        "ladder holds at 45 degrees",
        "square key cannot turn in its hole",
        "wedge lifts a roller",
    ],
)
def test_mujoco_does_what_the_truth_says(name):
    assert errors(name, "mujoco", FINE).max() <= 1.0


@pytest.mark.parametrize(
    "name",
    [
        "ball of 10 mm shot at a plate of 1 mm at 20 m/s",
        "washer thrown at a plate of 1 mm at 20 m/s",
        "ball shot at a free plate of 1 mm",
    ],
)
def test_shots_do_what_the_truth_says_in_steps_shorter_than_the_plate(name):
    scene = SCENES[name]
    track = run_stage(scene.stage(1), "bullet", 40_000.0, 0.06)
    # Something has hit the plate.
    assert np.linalg.norm(track.velocities["body"][-1]) < 15.0
    for measure in scene.measures:
        assert measure.error(measure.value(track), measure.truth(track)) <= measure.bar


@pytest.mark.skipif(not is_installed("mujoco"), reason="needs MuJoCo")
def test_mujoco_starts_hinges_and_sliders_with_their_speed():
    key = run_stage(SCENES["square key cannot turn in its hole"].stage(1), "mujoco", 1e3, 0.001)
    assert key.spins["body"][0] == pytest.approx((0.0, 0.0, -3.0))
    stage = SCENES["cam lifts a follower"].stage(0)
    thrown = replace(stage.items[1], velocity=(0.3, 0.0, 2.0))
    follower = run_stage(replace(stage, items=(thrown,)), "mujoco", 1e3, 0.001)
    assert follower.velocities["body"][0] == pytest.approx((0.0, 0.0, 2.0))


# ---- closed forms --------------------------------------------------------------------------------


def test_ring_without_spin_stops_as_any_body():
    plain = laws.way_to_stop(1.0, 0.3 * laws.G, 0.005)
    assert laws.spinning_ring_way(1.0, 0.0, 0.3, 0.05, 0.045, 0.005) == pytest.approx(plain, 1e-3)


def test_fast_spin_turns_friction_aside():
    # A part of the ring moves almost across the slide, so that friction against that is small.
    way = laws.spinning_ring_way(0.01, 100.0, 0.3, 0.05, 0.05, 1e-3)
    assert way > 10.0 * laws.way_to_stop(0.01, 0.3 * laws.G, 1e-3)


def test_prism_with_many_sides_rolls_as_a_round_body():
    slope, seconds = math.radians(10.0), 0.8
    round_way = 0.5 * laws.roll_acceleration(slope, 0.5) * seconds**2
    ways = [impact_laws.prism_way(slope, n, 0.05, 0.5, seconds) for n in (32, 64, 192, 768)]
    assert ways == sorted(ways)
    assert ways[-1] == pytest.approx(round_way, rel=0.01)


def test_bounce_gains_no_energy_and_keeps_angular_momentum_about_the_contact():
    rng = np.random.default_rng(1)
    ratio, radius = 0.4, 0.02
    stuck = 0
    for _ in range(200):
        along, spin = float(rng.normal()), float(rng.normal(scale=50.0))
        into, friction = float(rng.uniform(0.1, 2.0)), float(rng.uniform(0.0, 1.0))
        after, turned = impact_laws.rough_bounce(along, into, spin, radius, ratio, friction, 0.8)
        before = along + ratio * radius * spin
        assert after + ratio * radius * turned == pytest.approx(before, abs=1e-12)
        energy = along**2 + ratio * (radius * spin) ** 2
        assert after**2 + ratio * (radius * turned) ** 2 <= energy + 1e-12
        stuck += abs(after - radius * turned) < 1e-9
    # Both cases occur.
    assert 20 < stuck < 180


def test_hit_rod_keeps_momentum_and_energy():
    ball, rod, spin = impact_laws.rod_impact(2.0, 0.3, 1.0, 0.15, 0.0134, 1.0)
    assert 0.3 * ball + rod == pytest.approx(0.6)
    assert 0.3 * 0.15 * (2.0 - ball) == pytest.approx(0.0134 * spin)
    energy = 0.5 * (0.3 * ball**2 + rod**2 + 0.0134 * spin**2)
    assert energy == pytest.approx(0.5 * 0.3 * 4.0)


def test_ladder_at_its_limit_is_in_balance():
    slope, mu = laws.ladder_slope(0.5), 0.5
    floor = 1.0 / (1.0 + mu**2)
    wall = mu * floor
    # Moments about the foot of a ladder of length and weight 1.
    turning = 0.5 * math.cos(slope)
    assert turning == pytest.approx(wall * math.sin(slope) + mu * wall * math.cos(slope))


def test_key_at_its_play_touches_the_hole():
    play = laws.key_play(0.01, 0.0104)
    assert 0.01 * (math.cos(play) + math.sin(play)) == pytest.approx(0.0104)


def test_harmonic_books_have_their_centers_over_what_is_below():
    stage = SCENES["four books reach over a table's edge"].stage(0)
    books = [item.pose[0, 3] for item in stage.items[1:]]
    for i in range(len(books)):
        edge = 0.5 if i == 0 else books[i - 1] + 0.1
        assert edge - np.mean(books[i:]) == pytest.approx(0.01, abs=1e-9)


# ---- how bodies begin ----------------------------------------------------------------------------


def place(item: Item):
    """The body where it begins, as a solid."""
    solids = import_manifold()
    assert item.form.mesh is not None
    vertices, faces = (np.array(each) for each in (item.form.mesh.vertices, item.form.mesh.faces))
    return solids.Manifold(solids.Mesh64(vertices, faces.astype(np.uint64))).transform(
        item.pose[:3]
    )


@pytest.mark.parametrize(
    "name",
    [each.name for each in held_out.SCENES if each.name != "book begins 2 mm inside a table"],
)
def test_bodies_begin_apart(name):
    for placement in range(2):
        items = SCENES[name].stage(placement).items
        placed = [(item, place(item)) for item in items if item.form.mesh is not None]
        for (first, a), (second, b) in itertools.combinations(placed, 2):
            if first.moves or second.moves:
                assert (a ^ b).volume() < 1e-12
        for ground in (item for item in items if item.form.is_plane):
            up = ground.pose[:3, 2]
            for item, _ in placed:
                points = item.form.vertices @ item.pose[:3, :3].T + item.pose[:3, 3]
                assert ((points - ground.pose[:3, 3]) @ up).min() > -1e-7


def test_hanging_mug_touches_its_peg_where_the_truth_says():
    peg, mug = SCENES["mug hangs on a peg by its handle"].stage(0).items
    # It begins 0.2 mm over the place where it hangs.
    assert place(peg).min_gap(place(mug), 0.01) == pytest.approx(2e-4, abs=3e-5)


def test_parts_elsewhere_have_the_volume_of_the_mesh():
    solids = import_manifold()
    for form in (
        bodies.groove(1.0, 0.1),
        bodies.cup(),
        bodies.rack(),
        bodies.square_hole(0.01, 0.02),
    ):
        parts = []
        for piece in form.pieces:
            points = piece.points
            if points is None:
                corners = itertools.product((-1.0, 1.0), repeat=3)
                points = np.array(list(corners)) * piece.size
            points = points @ piece.pose[:3, :3].T + piece.pose[:3, 3]
            parts.append(solids.Manifold.hull_points(points))
        whole = solids.Manifold.batch_boolean(parts, solids.OpType.Add)
        assert whole.volume() == pytest.approx(_volume(form), rel=0.03)


def _volume(form: Form) -> float:
    return place(Item("body", form)).volume()
