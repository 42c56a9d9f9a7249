"""Timeline, lanes, stage, pins and page: everything that needs no viser."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st
from voxshell.errors import RecordingError, SettingsError
from voxshell.recording import BodyTrack, ContactTrack, Recording
from voxshell.viewer.lanes import Lane, activity_bounds, arrange_lanes, view_axes
from voxshell.viewer.page import add_heading
from voxshell.viewer.pins import DEPTH_COLORS, build_pin_mesh, build_pins, full_depth
from voxshell.viewer.quaternions import normals_as_wxyz, rotations_as_wxyz
from voxshell.viewer.shading import is_faceted
from voxshell.viewer.stage import VIEW_ASPECT, find_paths, find_slabs, place_camera, plan_stage
from voxshell.viewer.timeline import plan_timeline

BALL = trimesh.creation.icosphere(subdivisions=3, radius=0.1)
BLOCK = trimesh.creation.box((2.0, 2.0, 0.5))


def track(name, mesh, path, color=None):
    poses = np.tile(np.eye(4), (len(path), 1, 1))
    poses[:, :3, 3] = path
    return BodyTrack(name, mesh.vertices, mesh.faces, color, poses)


def fall(frames=41, time_step=0.005, contacts=None, end=0.1):
    path = np.zeros((frames, 3))
    path[:, 2] = np.linspace(0.4, end, frames)
    bodies = (
        track("ball", BALL, path),
        track("block", BLOCK, np.tile([0.0, 0.0, -0.25], (frames, 1))),
    )
    return Recording(time_step, bodies, contacts or ContactTrack.empty(frames))


def touches(frames, *at):
    nothing = ([], [], [])
    one = ([[0.0, 0.0, 0.0]], [[0.0, 0.0, 1.0]], [0.001])
    return ContactTrack.from_frames([one if i in at else nothing for i in range(frames)])


class TestTimeline:
    def test_every_nth_step_is_shown_and_the_last_one_always(self):
        recording = fall(frames=43)
        timeline = plan_timeline([recording], frames_per_second=60.0)
        assert timeline.stride == 4
        assert timeline.frames(recording).tolist() == [*range(0, 41, 4), 42]
        np.testing.assert_allclose(timeline.pauses[:-1], 0.02)
        np.testing.assert_allclose(timeline.pauses.sum(), recording.duration)

    @given(
        st.integers(1, 400),
        st.sampled_from([1e-3, 1 / 240, 1 / 200, 1 / 60, 0.1]),
        st.sampled_from([10.0, 30.0, 60.0, 144.0]),
        st.sampled_from([0.1, 1.0, 3.0]),
    )
    def test_time_and_rate_are_kept(self, frames, step, rate, speed):
        recording = fall(frames, step)
        timeline = plan_timeline([recording], frames_per_second=rate, speed=speed)
        shown = timeline.frames(recording)
        assert shown[0] == 0
        assert shown[-1] == frames - 1
        np.testing.assert_allclose(timeline.pauses.sum(), recording.duration / speed)
        # The last pause may be a short one.
        assert (timeline.pauses[:-1] >= 1.0 / rate - 1e-6).all()
        assert (np.diff(shown)[:-1] == timeline.stride).all()

    def test_lanes_of_other_rates_hold_their_latest_step(self):
        quick, slow = fall(41, 0.005), fall(5, 0.05)
        timeline = plan_timeline([quick, slow])
        assert timeline.frames(slow).tolist() == [0, 0, 0, 1, 1, 2, 2, 2, 3, 3, 4]

    def test_a_recording_that_ends_early_stays_at_its_end(self):
        short, long = fall(11), fall(41)
        assert plan_timeline([short, long]).frames(short).tolist() == [0, 4, 8] + [10] * 8

    def test_a_touch_between_pictures_is_shown(self):
        recording = fall(9, contacts=touches(9, 1, 2, 8))
        timeline = plan_timeline([recording])
        assert timeline.frames(recording).tolist() == [0, 4, 8]
        assert timeline.contact_frames(recording).tolist() == [0, 2, 8]

    def test_one_frame_is_a_still(self):
        timeline = plan_timeline([fall(1)])
        assert timeline.times.tolist() == [0.0]
        assert len(timeline.pauses) == 0

    @pytest.mark.parametrize("bad", [0.0, -1.0, np.nan, np.inf])
    def test_bad_rates_are_refused(self, bad):
        with pytest.raises(SettingsError, match="speed must be positive"):
            plan_timeline([fall()], speed=bad)
        with pytest.raises(SettingsError, match="frames_per_second must be positive"):
            plan_timeline([fall()], frames_per_second=bad)


class TestLanes:
    def test_bounds_hold_what_moves_and_no_more(self):
        low, high = activity_bounds(fall())
        np.testing.assert_allclose(low, [-0.1, -0.1, 0.0], atol=2e-3)
        np.testing.assert_allclose(high, [0.1, 0.1, 0.5], atol=2e-3)

    @pytest.mark.parametrize(("bottom", "low_end"), [(-0.2, -0.2), (-20.0, 0.0)])
    def test_a_fixed_body_not_much_larger_is_seen_whole(self, bottom, low_end):
        still = fall()
        post = trimesh.creation.box(bounds=[(-0.05, -0.05, bottom), (0.05, 0.05, 0.3)])
        poses = np.tile(np.eye(4), (still.frame_count, 1, 1))
        track = BodyTrack("post", post.vertices, post.faces, None, poses)
        seen = Recording(still.time_step, (*still.bodies, track), still.contacts)
        assert activity_bounds(seen)[0][2] == pytest.approx(low_end, abs=2e-3)

    def test_a_body_shot_away_does_not_stretch_the_stage(self):
        _, high = activity_bounds(fall(end=-500.0))
        assert np.linalg.norm(high) < 5.0

    @pytest.mark.parametrize("count", [1, 2, 6, 7, 13])
    def test_arranged_lanes_do_not_reach_into_each_other(self, count):
        lanes = arrange_lanes({f"lane {i}": fall() for i in range(count)})
        offsets = np.array([lane.offset for lane in lanes])
        assert [lane.label for lane in lanes] == [f"lane {i}" for i in range(count)]
        apart = np.abs(offsets[:, None] - offsets[None]).max(axis=2)
        assert (apart[~np.eye(count, dtype=bool)] > 0.2).all()
        assert (offsets[:, 2] == 0.0).all()

    def test_reading_order_is_left_to_right_and_back_to_front(self):
        a, b, c = arrange_lanes({"a": fall(), "b": fall(), "c": fall()}, columns=2)
        assert a.offset[0] < b.offset[0]
        assert a.offset[1] == b.offset[1] > c.offset[1]

    @pytest.mark.parametrize("up", ["+x", "-x", "+y", "-y", "+z", "-z"])
    def test_view_axes_are_right_handed(self, up):
        right, forward, upward = view_axes(up)
        np.testing.assert_array_equal(np.cross(right, forward), upward)

    def test_bad_options_are_refused(self):
        with pytest.raises(RecordingError, match="nothing to arrange"):
            arrange_lanes({})
        with pytest.raises(SettingsError, match="columns must be at least 1, got 0"):
            arrange_lanes({"a": fall()}, columns=0)
        with pytest.raises(SettingsError, match="gap must be meters"):
            arrange_lanes({"a": fall()}, gap=-1.0)
        with pytest.raises(SettingsError, match="up must be"):
            arrange_lanes({"a": fall()}, up="z")
        with pytest.raises(RecordingError, match="three finite numbers"):
            Lane("a", fall(), (0.0, 0.0))  # pyright: ignore[reportArgumentType]


class TestStage:
    def test_the_block_is_a_ground_cut_to_the_stage(self):
        lanes = arrange_lanes({"a": fall(), "b": fall()})
        stage = plan_stage(lanes, up="+z")
        slabs = find_slabs(lanes[0].recording, stage, up="+z")
        assert list(slabs) == ["block"]
        low, high = slabs["block"].low, slabs["block"].high
        assert high[2] == pytest.approx(0.0)
        assert -0.05 < low[2] < 0.0
        assert (high - low)[:2].max() < 0.3

    def test_what_is_above_or_tilted_or_moving_or_comes_later_is_no_ground(self):
        stage = plan_stage([Lane("", fall())], up="+z")
        frames = 3
        path = np.zeros((frames, 3))
        path[:, 2] = (0.3, 0.2, 0.1)
        above = track("lid", BLOCK, np.tile([0.0, 0.0, 2.0], (frames, 1)))
        poses = np.tile(trimesh.transformations.rotation_matrix(0.3, [1, 0, 0]), (frames, 1, 1))
        tilted = BodyTrack("ramp", BLOCK.vertices, BLOCK.faces, None, poses)
        lift = track("lift", BLOCK, path - [0.0, 0.0, 1.0])
        ball = track("ball", BALL, path)
        below = np.tile([0.0, 0.0, -2.0], (frames, 1))
        late = BodyTrack("late", BLOCK.vertices, BLOCK.faces, None, below, 1)
        bodies = (above, tilted, lift, ball, late)
        recording = Recording(0.1, bodies, ContactTrack.empty(frames))
        assert find_slabs(recording, stage, up="+z") == {}

    @pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
    def test_size_does_not_change_the_picture(self, scale):
        path = np.zeros((3, 3))
        path[:, 2] = np.array([0.3, 0.2, 0.1]) * scale
        ball = BALL.copy().apply_scale(scale)
        recording = Recording(0.1, (track("ball", ball, path),), ContactTrack.empty(3))
        stage = plan_stage([Lane("", recording)], up="+z")
        assert np.linalg.norm(stage.high - stage.low) * stage.scale == pytest.approx(6.0)

    @pytest.mark.parametrize("up", ["+z", "+y", "-x"])
    @pytest.mark.parametrize("count", [1, 6, 9])
    def test_the_camera_sees_all_boxes_and_wastes_no_room(self, up, count):
        lanes = arrange_lanes({str(i): fall() for i in range(count)}, up=up)
        stage = plan_stage(lanes, up=up)
        boxes = [
            ((stage.low + lane.offset) * stage.scale, (stage.high + lane.offset) * stage.scale)
            for lane in lanes
        ]
        camera = place_camera(boxes, rows=stage.rows, up=up)
        right, _, upward = view_axes(up)
        away = camera.target - camera.position
        away /= np.linalg.norm(away)
        above = np.cross(right, away)
        assert above @ upward > 0.5
        points = np.concatenate([trimesh.bounds.corners(box) for box in boxes])
        seen = points - camera.position
        depth = seen @ away
        assert (depth > 0.0).all()
        tangent = np.tan(0.5 * camera.field_of_view)
        x = seen @ right / (depth * tangent * VIEW_ASPECT)
        y = seen @ above / (depth * tangent)
        assert np.abs(x).max() < 1.0
        assert np.abs(y).max() < 1.0
        assert max(np.ptp(x) / 2.0, np.ptp(y) / 2.0) > 0.6


class TestPins:
    def test_the_pin_is_closed_and_faces_outwards(self):
        vertices, faces = build_pin_mesh(0.5)
        mesh = trimesh.Trimesh(vertices, faces, process=True, merge_norm=True)
        mesh.update_faces(mesh.nondegenerate_faces())
        assert mesh.is_watertight
        assert mesh.volume > 0.0
        np.testing.assert_allclose(mesh.bounds[:, 2], [-0.5, 3.5])

    def test_colors_run_with_depth_and_stop_at_the_ends(self):
        depths = np.array([-0.01, 0.0, 0.002, 0.5])
        contacts = ContactTrack([0, 4], np.zeros((4, 3)), np.tile([0, 0, 1.0], (4, 1)), depths)
        pins = build_pins(contacts, scale=1.0, deepest=0.002, limit=10, grain=2.0**-13)
        # Half of the light is 188 of 255 in a picture.
        shown = np.array([DEPTH_COLORS[i] for i in (0, 0, -1, -1)])
        np.testing.assert_allclose(pins.colors, 255.0 * (shown / 255.0) ** 2.2, atol=2.0)

    def test_positions_are_exact_to_the_grain(self):
        rng = np.random.default_rng(1)
        points = rng.normal(size=(50, 3))
        contacts = ContactTrack([0, 50], points, np.tile([0, 0, 1.0], (50, 1)), np.zeros(50))
        pins = build_pins(contacts, scale=3.0, deepest=0.0, limit=100, grain=2.0**-13)
        np.testing.assert_allclose(pins.positions, 3.0 * points, atol=2.0**-14 * 1.001)
        few = build_pins(contacts, scale=3.0, deepest=0.0, limit=7, grain=2.0**-13)
        assert len(few) == 7
        assert {tuple(p) for p in few.positions} <= {tuple(p) for p in pins.positions}

    def test_one_outlier_does_not_set_the_scale(self):
        n = 1000
        depths = np.full(n, 0.0019)
        depths[0] = 1.0
        contacts = ContactTrack([0, n], np.zeros((n, 3)), np.tile([0, 0, 1.0], (n, 1)), depths)
        assert full_depth([fall(1, contacts=contacts)], 0.1) == pytest.approx(0.002)
        assert full_depth([fall()], 0.1) == 0.0

    def test_depths_of_rounding_do_not_set_the_scale(self):
        depths = np.array([4e-17, 0.0])
        contacts = ContactTrack([0, 2], np.zeros((2, 3)), np.tile([0, 0, 1.0], (2, 1)), depths)
        assert full_depth([fall(1, contacts=contacts)], 0.1) == pytest.approx(1e-5)


class TestQuaternions:
    def test_they_turn_as_the_matrices_do(self):
        rng = np.random.default_rng(2)
        matrices = np.array(
            [trimesh.transformations.random_rotation_matrix(rng.random(3)) for _ in range(200)]
        )
        half_turns = [np.diag([1.0, -1, -1]), np.diag([-1.0, 1, -1]), np.diag([-1.0, -1, 1])]
        rotations = np.concatenate([matrices[:, :3, :3], half_turns, np.eye(3)[None]])
        back = [
            trimesh.transformations.quaternion_matrix(q)[:3, :3]
            for q in rotations_as_wxyz(rotations)
        ]
        np.testing.assert_allclose(back, rotations, atol=1e-12)

    def test_z_is_turned_to_the_normal(self):
        rng = np.random.default_rng(3)
        normals = rng.normal(size=(200, 3))
        normals[:3] = [[0, 0, 1], [0, 0, -1], [1e-9, 0, -1]]
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
        turned = [
            trimesh.transformations.quaternion_matrix(q)[:3, 2] for q in normals_as_wxyz(normals)
        ]
        np.testing.assert_allclose(turned, normals, atol=1e-6)


class TestSurface:
    def test_boxes_have_edges_and_balls_have_none(self):
        assert is_faceted(BLOCK.vertices, BLOCK.faces)
        assert not is_faceted(BALL.vertices, BALL.faces)

    def test_long_edges_count_beside_many_small_faces(self):
        fine = trimesh.creation.icosphere(subdivisions=6, radius=0.2)
        both = trimesh.util.concatenate([BLOCK, fine])
        assert is_faceted(both.vertices, both.faces)


class TestPage:
    PLAYER = "<html><head><title>Viser</title></head><body><div></div></body></html>"

    def test_text_is_escaped(self):
        page = add_heading(
            self.PLAYER,
            title="<b> & co",
            caption="</script>",
            rate="1 < 2",
            deepest=0.002,
            grid=0.02,
        )
        assert "<title>&lt;b&gt; &amp; co</title>" in page
        assert "<h1>&lt;b&gt; &amp; co</h1>" in page
        assert "<p>&lt;/script&gt;</p>" in page
        assert "1 &lt; 2" in page
        assert "2 mm" in page
        assert "grid: 2 cm" in page
        assert "{{" not in page

    def test_the_policy_comes_before_anything_it_governs(self):
        page = add_heading(self.PLAYER, title="t", caption="", rate="r", deepest=None, grid=None)
        assert page.startswith('<html><head><meta http-equiv="Content-Security-Policy"')
        assert "default-src 'none'" in page
        assert "contact" not in page.split("</header>")[0].split("<header")[1]

    def test_an_unknown_player_is_refused(self):
        with pytest.raises(RecordingError, match="no <head>"):
            add_heading("<p>", title="t", caption="", rate="r", deepest=None, grid=None)


def test_a_camera_that_follows_paths_sees_fixed_bodies_of_about_their_size_but_no_wide_ground():
    recording = fall()
    small = trimesh.creation.box((0.3, 0.3, 0.1))
    plate = track("plate", small, np.tile([0.0, 0.0, 0.0], (41, 1)))
    with_plate = Recording(0.005, (*recording.bodies, plate), recording.contacts)
    lows = [low for low, _ in find_paths(recording)]
    assert np.min(lows, axis=0) == pytest.approx((-0.1, -0.1, 0.0))
    lows = [low for low, _ in find_paths(with_plate)]
    assert np.min(lows, axis=0) == pytest.approx((-0.15, -0.15, -0.05))
