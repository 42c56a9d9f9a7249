from __future__ import annotations

import csv
import json
import math

import numpy as np
import pytest
import toy_peers
import trimesh
import voxshell as vx
from voxshell.errors import MissingExtraError
from voxshell.model.mass_properties import MassProperties
from voxshell.model.meshes import read_mesh
from voxshell_studies.convex_parts import Parts
from voxshell_studies.peers import ours, report, truth
from voxshell_studies.peers.apart import Ending
from voxshell_studies.peers.cases import (
    PAIR_OFFSETS,
    SHIFT,
    TURN,
    PeersSettings,
    load_body,
    make_cases,
    make_job,
    stand,
    vary,
)
from voxshell_studies.peers.comparison import compare, measure_peer
from voxshell_studies.peers.measure import judge_drop, measure_case
from voxshell_studies.peers.parts import fetch_parts
from voxshell_studies.peers.protocol import Case, Job, load_library
from voxshell_studies.peers.roster import PEERS, REFERENCE, Peer

BRIEF = PeersSettings(case_seconds=0.0, rates=(10.0,), drop_seconds=1.0, time_limit=60.0)


def quiet(name, stage, fraction):
    pass


@pytest.fixture(scope="module")
def body():
    return load_body()


@pytest.fixture(scope="module")
def ball_job():
    """A ball of 0.1 m: 2 mm in the plane and the box, 3 mm in another ball; one drop."""
    mesh = read_mesh(trimesh.creation.icosphere(4, radius=0.1))
    below = np.eye(4)
    below[2, 3] = -0.03
    beside = np.eye(4)
    beside[0, 3] = 0.197
    dropped = np.eye(4)
    dropped[2, 3] = 0.6
    standing = stand(mesh, 0.002)
    return Job(
        mesh=mesh,
        mass_properties=MassProperties(1.0, np.zeros(3), np.eye(3) * 0.004),
        box_half_extents=(0.12, 0.12, 0.03),
        cases=(
            Case("plane", "plane", "plane", 0.002, vary(standing), np.eye(4)),
            Case("box", "box", "box", 0.002, vary(standing), below),
            Case("pair", "pair", "body", 0.003, vary(beside), np.eye(4)),
        ),
        case_seconds=0.0,
        drop_pose=dropped,
        rates=(50.0,),
        drop_seconds=2.0,
    )


# ---- the cases -----------------------------------------------------------------------------------


def test_bunny_is_scaled_about_its_center_of_mass(body):
    mesh, matter = body
    solid = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    assert np.ptp(mesh.vertices, axis=0).max() == pytest.approx(0.3)
    np.testing.assert_allclose(solid.center_mass, 0.0, atol=1e-9)
    np.testing.assert_allclose(
        matter.inertia, solid.moment_inertia / solid.volume * matter.mass, rtol=1e-9
    )


def test_bunny_is_as_deep_as_the_cases_say(body):
    mesh, _ = body
    model = vx.Model.from_mesh(mesh, resolution=300, target_points=34_835)
    for case in make_cases(mesh):
        if case.other == "body":
            contacts = vx.contacts(model, model, case.poses[0], case.other_pose, shell="both")
            depth = contacts.depths.max()
        else:
            lowest = (mesh.vertices @ case.poses[0, 2, :3] + case.poses[0, 2, 3]).min()
            depth = -lowest
            assert depth == pytest.approx(case.depth, abs=1e-12)
        assert depth == pytest.approx(case.depth, abs=model.field.voxel_size), case.key
    assert len(PAIR_OFFSETS) == 2


def test_poses_of_a_case_stay_near_the_first_and_are_the_same_every_time(body):
    pose = stand(body[0], 0.001)
    poses = vary(pose)
    np.testing.assert_array_equal(poses, vary(pose))
    np.testing.assert_array_equal(poses[0], pose)
    moved = np.abs(poses[1:, :3, 3] - pose[:3, 3])
    assert 0.5 * SHIFT < moved.max() <= SHIFT
    turned = np.abs(poses[1:, :3, :3] - pose[:3, :3])
    assert 0.5 * TURN < turned.max() <= 2.0 * TURN
    np.testing.assert_allclose(
        poses[:, :3, :3] @ poses[:, :3, :3].transpose(0, 2, 1),
        np.tile(np.eye(3), (len(poses), 1, 1)),
        atol=1e-12,
    )


def test_true_depths_are_those_that_the_poses_were_set_up_for():
    pytest.importorskip("igl", reason="truth needs libigl, of voxshell-studies[peers]")
    job = make_job(BRIEF)
    for case, found in zip(job.cases, truth.find_truths(job), strict=True):
        assert found.case == case.key
        assert found.depth == pytest.approx(case.depth, abs=2e-6)
        assert found.depth == max(found.body_depth, found.other_depth)


# ---- measuring -----------------------------------------------------------------------------------


class Counting:
    """Takes 1 ms at the first pose and 3 ms at the others."""

    def __init__(self, poses):
        self.first = poses[0]
        self.asked = 0

    def ask(self, pose):
        self.asked += 1
        return 0.001 if pose is self.first or np.array_equal(pose, self.first) else 0.003

    def answer(self):
        assert self.asked == 1, "the answer is that at the first pose"
        return 12, 0.005


def test_case_is_answered_at_its_first_pose_and_timed_at_all():
    poses = np.tile(np.eye(4), (5, 1, 1))
    poses[1:, 0, 3] = 1.0
    case = Case("box", "box", "box", 0.001, poses, np.eye(4))
    result = measure_case(Counting(poses), case, 0.0)
    assert (result.contacts, result.depth, result.queries) == (12, 0.005, 5)
    assert result.median == result.least == 0.003
    assert 0.001 < result.p99 <= 0.003


def _poses(steps, height=0.1, slide=0.0, spin=0.0, rate=50.0):
    poses = np.tile(np.eye(4), (steps, 1, 1))
    for step, pose in enumerate(poses):
        angle = spin * step / rate
        pose[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
        pose[:3, 3] = slide * step / rate, 0.0, height
    return poses


@pytest.mark.parametrize(
    ("poses", "other", "outcome"),
    [
        (_poses(100), "plane", "rests"),
        (_poses(100, slide=0.009), "plane", "rests"),
        (_poses(100, slide=0.011), "plane", "moves"),
        (_poses(100, spin=0.09), "box", "rests"),
        (_poses(100, spin=0.11), "box", "moves"),
        (_poses(100, spin=3.0), "box", "moves"),
        (_poses(100, height=0.096), "plane", "rests"),
        (_poses(100, height=0.094), "plane", "sinks"),
        (_poses(100, height=-0.01), "plane", "through"),
        (_poses(100, height=-9.0, slide=1.0), "box", "off"),
        (_poses(100, height=-9.0, slide=1.0), "plane", "through"),
    ],
)
def test_drops_are_judged_by_their_end(ball_job, poses, other, outcome):
    result = judge_drop(poses, ball_job, other, 50.0)
    assert result.outcome == outcome
    assert result.problem == ""


def test_drop_says_how_fast_and_how_deep(ball_job):
    poses = _poses(100, slide=0.3, spin=2.0)
    poses[10, 2, 3] = 0.07
    result = judge_drop(poses, ball_job, "plane", 50.0)
    assert result.speed == pytest.approx(0.3)
    assert result.spin == pytest.approx(2.0)
    assert result.deepest == pytest.approx(0.03, abs=1e-4)
    assert result.rest_height == pytest.approx(0.0, abs=1e-4)


def test_poses_that_are_not_finite_are_unstable(ball_job):
    poses = _poses(100)
    poses[50, 0, 3] = np.nan
    assert judge_drop(poses, ball_job, "plane", 50.0).outcome == "unstable"


# ---- rows, whatever happens ----------------------------------------------------------------------


def toy(variant):
    return Peer(variant, variant.title(), "toy_peers", variant)


VARIANTS = ("working", "missing", "raising", "crashing", "leaving", "stumbling", "hanging")


AGAIN = ("working", "raising")


@pytest.fixture(scope="module")
def toys(tmp_path_factory):
    """All toys compared, some again: both comparisons, the folder, and who was prepared how often."""
    out = tmp_path_factory.mktemp("toys")
    runs = tmp_path_factory.mktemp("runs")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(toy_peers.RUNS, str(runs))
        settings = PeersSettings(case_seconds=0.0, rates=(10.0,), drop_seconds=1.0, time_limit=4.0)
        peers = (*map(toy, VARIANTS), Peer("parted", "Parted", "toy_peers", "working", True))
        comparison = compare(settings, out, peers=peers, skip_slow=True)
        report.write_results(out, comparison, "voxshell reproduce peers --toys")
        again = compare(settings, out, peers=tuple(map(toy, AGAIN)), skip_slow=True)
    return comparison, again, out, [path.name.split("-")[0] for path in runs.iterdir()]


def test_every_peer_is_a_row_that_says_how_it_came_off(toys):
    comparison, _, _, _ = toys
    rows = {row.key: row for row in comparison.peers}
    assert {key: row.status for key, row in rows.items()} == {
        "working": "measured",
        "missing": "missing",
        "raising": "failed",
        "crashing": "failed",
        "leaving": "failed",
        "stumbling": "measured",
        "hanging": "timed out",
        "parted": "skipped",
    }
    assert "pip install no-such-package" in rows["missing"].reason
    assert rows["raising"].reason == "ValueError: no mesh of this kind"
    assert "SIGSEGV" in rows["crashing"].reason
    assert "code 7" in rows["leaving"].reason
    assert rows["hanging"].reason == "killed after 4 s"
    assert "--quick" in rows["parted"].reason


def test_what_was_measured_before_the_end_counts(toys):
    comparison, _, _, _ = toys
    rows = {row.key: row for row in comparison.peers}
    for key in ("crashing", "leaving"):
        assert [case.case for case in rows[key].cases] == ["box", "pair-1.5"]
    assert [case.problem for case in rows["stumbling"].cases] == [
        "",
        "",
        "RuntimeError: too many contacts",
    ]
    assert [case.case for case in rows["hanging"].cases] == ["box", "pair-1.5", "pair-73.6"]
    working = rows["working"]
    assert working.version == "1.2"
    assert working.settings == {"variant": "working", "spacing": 0.25}
    assert [drop.outcome for drop in working.drops] == ["rests", "rests"]


def test_rows_that_are_done_are_not_measured_again(toys):
    first, second, _, runs = toys
    assert runs.count("working") == 1
    assert runs.count("raising") == 2
    assert first.peers[0] == second.peers[0]
    assert second.peers[0].cases[0].depth is not None


def test_results_are_complete(toys):
    comparison, _, out, _ = toys
    data = json.loads((out / "peers.json").read_text(), parse_constant=pytest.fail)
    assert data["command"] == "voxshell reproduce peers --toys"
    assert data["environment"]["cpu"]
    assert len(data["peers"]) == len(VARIANTS) + 1
    assert data["cases"][0]["other"] == "plane"
    with (out / "cases.csv").open() as file:
        rows = list(csv.DictReader(file))
    deep = next(row for row in rows if (row["peer"], row["case"]) == ("working", "pair-73.6"))
    assert float(deep["median"]) == 0.002
    assert float(deep["depth_error"]) == pytest.approx(0.001, abs=1e-5)
    with (out / "drops.csv").open() as file:
        assert {row["outcome"] for row in csv.DictReader(file)} == {"rests"}
    page = (out / "peers.md").read_text()
    for word in (
        "SIGSEGV",
        "killed after 4 s",
        "no-such-package",
        "too many contacts",
        "2.00 ms / 2.00 ms",
    ):
        assert word in page, word
    assert "7: 74.60 (+1.00)" in page
    assert comparison.environment["commit"] in page


def test_ratios_are_to_our_contacts_on_voxels(toys):
    comparison, _, _, _ = toys
    case = comparison.cases[1]
    result = report.find_case(comparison.peers[0], case)
    assert result is not None
    assert math.isnan(report.compute_ratio(comparison, case, result))
    comparison.peers[0].key = REFERENCE
    try:
        assert report.compute_ratio(comparison, case, result) == 1.0
        assert report.format_times(comparison, comparison.peers[0], case) == "2.00 ms 1.0x"
    finally:
        comparison.peers[0].key = "working"


def test_library_that_is_not_there_says_how_to_get_it():
    with pytest.raises(MissingExtraError, match="pip install some-package"):
        load_library("no_library_of_this_name", "some-package")


# ---- parts ---------------------------------------------------------------------------------------


def test_parts_are_kept_and_found_again_by_content(tmp_path, monkeypatch):
    from voxshell_studies import convex_parts
    from voxshell_studies.peers import parts

    monkeypatch.setenv("VOXSHELL_CACHE_DIR", str(tmp_path / "models"))
    monkeypatch.setenv("VOXSHELL_CACHE_SIZE", "1GB")
    monkeypatch.setattr(convex_parts.metadata, "version", lambda package: "9.9")
    made = Parts((np.eye(3), np.arange(12.0).reshape(4, 3)), 2.5, "9.9")
    asked = []

    def run(work, arguments, receive, *, limit, log):
        asked.append(arguments["mesh"])
        receive(made)
        return Ending("done")

    monkeypatch.setattr(parts, "run_apart", run)
    box, ball = (read_mesh(m) for m in (trimesh.creation.box(), trimesh.creation.icosphere(1)))
    options = {"limit": 1.0, "log": tmp_path / "log"}
    none, ending = fetch_parts(box, **options, only_kept=True)
    assert none is None
    assert ending.how == "missing"
    for _ in range(2):
        parts_of_box, ending = fetch_parts(box, **options, only_kept=False)
        assert ending.how == "done"
        assert parts_of_box is not None
        assert (parts_of_box.seconds, parts_of_box.version) == (2.5, "9.9")
        for hull, expected in zip(parts_of_box.hulls, made.hulls, strict=True):
            np.testing.assert_array_equal(hull, expected)
    assert len(asked) == 1
    assert fetch_parts(ball, **options, only_kept=True)[0] is None
    for path in (tmp_path / "parts").iterdir():
        path.write_bytes(path.read_bytes()[:100])
    assert fetch_parts(box, **options, only_kept=True)[0] is None


# ---- real peers ----------------------------------------------------------------------------------


def test_keys_are_unique_and_the_reference_is_there():
    keys = [peer.key for peer in PEERS]
    assert len(set(keys)) == len(keys)
    assert REFERENCE in keys


def real(key):
    return next(peer for peer in PEERS if peer.key == key)


def test_coal_finds_the_depths(ball_job, tmp_path):
    row = measure_peer(real("coal"), ball_job, limit=60.0, log=tmp_path / "log", progress=quiet)
    assert (row.status, row.reason) == ("measured", "")
    assert row.version.startswith("3.")
    depths = {case.case: case.depth for case in row.cases}
    for case in ball_job.cases:
        # Of two meshes it reports how deep triangles are in triangles, not the balls in each other.
        least = 0.3 if case.other == "body" else 0.99
        assert least * case.depth < depths[case.key] < 1.01 * case.depth, case.key
    assert all(case.contacts > 0 and case.median > 0.0 for case in row.cases)
    assert row.drops == []


@pytest.mark.parametrize("variant", ["voxels", "analytic"])
def test_ours_in_bullet_finds_the_depths_and_rests(ball_job, tmp_path, variant):
    peer = Peer(variant, variant, "voxshell_studies.peers.bullet", variant)
    row = measure_peer(peer, ball_job, limit=120.0, log=tmp_path / "log", progress=quiet)
    assert (row.status, row.reason) == ("measured", "")
    assert len(row.cases) == (3 if variant == "voxels" else 2)
    for result in row.cases:
        case = next(case for case in ball_job.cases if case.key == result.case)
        assert result.depth == pytest.approx(case.depth, abs=row.settings["voxel_size"])
    assert len(row.drops) == 2
    for drop in row.drops:  # a ball may roll
        assert drop.outcome in ("rests", "moves")
        assert drop.rest_height == pytest.approx(0.0, abs=row.settings["voxel_size"])


def test_calls_are_answered_as_contacts_answers_them(ball_job):
    contender = ours.set_up(ball_job, "analytic")
    assert contender.meet(ball_job.cases[2]) is None
    for case in ball_job.cases[:2]:
        query = contender.meet(case)
        assert query is not None
        for pose in case.poses[[3, 0]]:
            assert query.ask(pose) > 0.0
        count, depth = query.answer()
        assert count > 0
        assert depth == pytest.approx(case.depth, abs=1e-5)
