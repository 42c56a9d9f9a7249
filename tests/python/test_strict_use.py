"""A user's program under strict types: every public name, as it is used. `./dev lint` checks its types."""

from __future__ import annotations

import pickle
import re
import warnings
from pathlib import Path

import numpy as np
import pytest
import voxshell as vx
from numpy.typing import NDArray

VERTICES = np.array([(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1)], dtype=np.float64)
FACES = np.array([(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)])
URDF = """<robot name="lamp">
  <link name="foot"/>
  <link name="arm"><inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/>
    </inertial><collision><geometry><sphere radius="0.05"/></geometry></collision></link>
  <joint name="turn" type="revolute"><parent link="foot"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="10" velocity="1"/></joint></robot>"""


def make_model() -> vx.Model:
    stages: list[str] = []

    def note(stage: str, fraction: float) -> None:
        stages.append(f"{stage} {fraction:.0%}")

    return vx.Model.from_mesh((VERTICES, FACES), resolution=20, progress=note)


def test_models(tmp_path: Path):
    model = make_model()
    model.save(tmp_path / "model.vxs")
    again: vx.Model = pickle.loads(pickle.dumps(vx.Model.load(tmp_path / "model.vxs")))
    mesh: vx.Mesh = again.mesh
    assert len(mesh.vertices) == len(mesh.faces) == 4
    field: vx.DistanceField = model.field
    values: NDArray[np.float64] = field.sample([[0.02, 0.02, 0.02]])
    assert values[0] < 0.0
    assert field.gradient(VERTICES).shape == (4, 3)
    cells: tuple[int, int, int] = field.shape
    assert min(cells) > 20
    assert field.voxel_size > 0.0
    assert field.nbytes > 0
    assert field.sign_confidence <= 1.0
    assert field.interpolation_error >= 0.0
    assert len(field.sign_method + repr(field.origin)) > 0
    shell: vx.PointShell = model.shell
    points: NDArray[np.float32] = shell.points
    assert points.shape == shell.normals.shape == (len(shell), 3)
    assert float(shell.areas.sum()) > 0.02
    tree: vx.PointSphereTree = shell.tree
    assert tree.spheres(2).shape == (tree.branching, 4)
    assert tree.segments(tree.levels).shape == (len(shell),)
    accuracy: vx.Accuracy = model.accuracy
    errors: vx.ErrorStatistic = accuracy.distance
    assert errors.median <= errors.p99 <= errors.max
    assert accuracy.places > 0
    assert accuracy.is_sharp
    assert model.thickness > 0.0
    matter: vx.MassProperties = model.mass_properties(2.0, kind="surface")
    assert matter.mass == 2.0
    assert matter.center_of_mass.shape == (3,)
    assert matter.inertia.shape == (3, 3)
    assert (model.bounds[1] > model.bounds[0]).all()


def test_shapes():
    shapes: list[vx.Field] = [
        vx.Plane((0, 0, 1), 0.1),
        vx.Box((0.1, 0.1, 0.1)),
        vx.Sphere(0.1),
        vx.Capsule(0.1, 0.2),
        vx.Cylinder(0.1, 0.2),
        vx.Cone(0.1, 0.2),
        vx.ConvexPolyhedron((VERTICES, FACES)),
    ]
    model = make_model()
    bounds: vx.ContactBounds = vx.contact_bounds(model, shapes[0])
    assert bounds.overlap > bounds.clearance == 0.0
    assert bounds.shell == "a"
    assert bounds.miss > 0.0
    for shape in shapes:
        assert vx.collide(model, shape)


def test_queries():
    model, pose = make_model(), np.eye(4)
    pose[:3, 3] = 0.01
    found: vx.Contacts = vx.contacts(
        model, model, None, pose, level=2, budget=10_000, scratch=vx.QueryScratch()
    )
    depths: NDArray[np.float64] = found.depths
    ids: NDArray[np.int64] = found.ids
    assert len(found) == len(depths) == len(ids) == len(found.segments) == len(found.shells)
    assert found.points_a.shape == found.points_b.shape == found.normals.shape
    assert found.shell in ("a", "b", "both")
    assert found.exact
    assert found.depth_bound < 0.0
    first: vx.Contact = found[0]
    depth: float = first.depth
    assert depth == depths[0]
    assert [contact.id for contact in found] == ids.tolist()
    oracle: vx.Contacts = vx.testing.contacts_flat(model, model, None, pose, level=2)
    assert len(oracle) >= len(found) > 4
    assert len(found.manifold(4)) == len(vx.manifold(model, model, None, pose)) == 4
    assert len(found.deepest_per_segment()) > 0
    assert len(vx.deepest_per_segment(model, model, None, pose, level=2)) > 0
    nearest: vx.Distance = vx.distance(model, model, None, pose, max_distance=1.0)
    assert nearest.distance < 0.0
    assert nearest.point_a.shape == nearest.point_b.shape == nearest.normal.shape
    push: vx.Wrench = vx.wrench(model, model, None, pose, stiffness=1e6)
    assert push.force.shape == push.torque.shape == (3,)


def test_many_poses():
    model, poses = make_model(), np.repeat(np.eye(4)[None], 3, axis=0)
    batch: vx.ContactBatch = vx.contacts_batch(model, model, b_poses=poses, threads=1)
    offsets: NDArray[np.int64] = batch.offsets
    assert offsets[-1] == sum(len(one) for one in batch) == len(batch.depths)
    one: vx.Contacts = batch[0]
    assert len(one) > 0
    hits: NDArray[np.bool_] = vx.collide_batch(model, model, b_poses=poses)
    assert hits.all()
    gaps: NDArray[np.float64] = vx.distance_batch(model, model, b_poses=poses, max_distance=1.0)
    assert gaps.shape == (3,)
    motion: vx.Sweep = vx.sweep(model, model, None, poses[0], b_end=np.eye(4), tolerance=1e-4)
    assert 0.0 <= motion.fraction <= 1.0
    motions: vx.SweepBatch = vx.sweep_batch(model, model, b_poses=poses, b_ends=np.eye(4))
    assert motions.fractions.shape == motions.touches.shape
    between: NDArray[np.float64] = vx.interpolate_pose(poses[0], None, 0.5)
    assert between.shape == (4, 4)
    made: NDArray[np.float64] = vx.pose((0, 0, 1), axis_angle=((0, 0, 1), 0.5))
    assert vx.collide(model, model, made, (0, 0, 1))
    assert vx.collide(model, model, made, ((0, 0, 1), (0, 0, 0, 1)))


def test_worlds(tmp_path: Path):
    model = make_model()
    world = vx.World(gravity=(0, 0, -9.81), time_step=1 / 200)
    ground: vx.Body = world.add(vx.Plane(), mass=0, name="ground")
    aside = np.eye(4)
    aside[0, 3] = 1.0
    others = (
        vx.GImpact((VERTICES, FACES)),
        vx.ConvexHull(VERTICES),
        vx.ConvexDecomposition([VERTICES]),
        vx.Compound([(vx.Sphere(0.1), np.eye(4))]),
    )
    for number, shape in enumerate(others):
        world.add(shape, pose=aside + number * (aside - np.eye(4)), mask=0)
    pose = np.eye(4)
    pose[2, 3] = 0.3
    rubber: vx.Material = vx.Material(friction=1.0)
    body = world.add(model, mass=0.2, pose=pose, inertia="solid", motion="dynamic", material=rubber)
    body.material = vx.Material(body.friction, restitution=0.1)
    kinds = (vx.FixedJoint(), vx.PointJoint(), vx.HingeJoint((0, 1, 0), limits=(-1, 1)))
    for kind in kinds:
        joint: vx.Joint = world.add_joint(kind, None, body)
        world.remove(joint)
    slide = world.add_joint(vx.SliderJoint((0, 0, 1)), None, body, world_from_joint=pose)
    slide.set_target_velocity(-0.1, max_force=10.0)
    heights: list[float] = []

    def note(world: vx.World) -> None:
        heights.append(float(body.pose[2, 3]))

    recorder: vx.Recorder = world.record(every=2)
    state: vx.WorldState = world.save_state()
    world.step(10, note, before=lambda world: body.apply_force((0, 0, 0.1)))
    reaction: vx.Reaction = slide.reaction
    assert reaction.force.shape == reaction.torque.shape == (3,)
    assert slide.position < 0.0
    assert heights[-1] < heights[0]
    slide.release()
    world.restore_state(state)
    body.friction, body.linear_velocity = 0.3, (0, 0, 1)
    body.apply_impulse((0, 0, -0.1), at=(0, 0, 0.3))
    assert not body.removed
    assert not body.sleeping
    energy: float = body.kinetic_energy
    assert energy > 0.0
    assert body.inertia.shape == (3, 3)
    assert body.center_of_mass.shape == (3,)
    assert isinstance(body.shape, vx.Model)
    assert world.bodies[0].name == ground.name
    depths: NDArray[np.float64] = world.query_contacts(ground, body, margin=1.0)["depth"]
    assert len(depths) > len(world.contacts()) == 0
    assert len(world.contacts(body)) == len(world.contacts(body, ground)) == 0
    assert not world.overlaps(ground, body)
    assert world.ray_cast((0, 0, 1), (0, 0, -1))["body"][0] >= 0
    assert world.timings["step"].shape == (10,)
    recording: vx.Recording = recorder.recording()
    assert recording.frame_count == 6


def test_live_view():
    world = vx.World()
    view: vx.LiveView = world.view(port=0, paused=True, speed=2.0, wait=0.0)
    with view:
        address: str = view.address
        assert address.startswith("http://")
        view.resume()
        world.step(2)
        speed: float | None = view.speed
        assert speed == 2.0
        assert not view.paused
        assert view.page_count == 0
    assert not view.is_open


def test_robots(tmp_path: Path):
    path = tmp_path / "lamp.urdf"
    path.write_text(URDF)
    robot: vx.Robot = vx.load_urdf(vx.World(), path)
    arm: vx.Link = robot.links["arm"]
    assert arm.pose.shape == (4, 4)
    assert list(robot.joints) == list(robot.positions) == list(robot.velocities) == ["turn"]
    robot.set_targets({"turn": 0.5}, max_speed=1.0)
    robot.release()
    assert robot.name == "lamp"
    assert len(robot.bodies) == 1


def test_models_of_mujoco(tmp_path: Path):
    path = tmp_path / "ball.xml"
    path.write_text(
        "<mujoco><worldbody><body name='ball'><freejoint/><geom size='0.1'/></body></worldbody></mujoco>"
    )
    robot: vx.Robot = vx.load_mjcf(vx.World(), path, pose=np.eye(4), friction=0.4)
    ball: vx.Link = robot.links["ball"]
    assert ball.body is not None
    assert ball.body.friction == 0.4


def test_errors_and_warnings(tmp_path: Path):
    kinds: list[type[vx.VoxshellError]] = [
        vx.FileAccessError,
        vx.InputTypeError,
        vx.MemoryLimitError,
        vx.MeshError,
        vx.MissingExtraError,
        vx.MissingFileError,
        vx.ModelFileError,
        vx.PoseError,
        vx.RecordingError,
        vx.RobotError,
        vx.SettingsError,
        vx.SimulationError,
        vx.StateError,
    ]
    assert all(issubclass(kind, vx.VoxshellError) for kind in kinds)
    with pytest.raises(vx.FileAccessError):
        vx.Model.load(tmp_path / "missing.vxs")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", vx.CacheWarning)
        warnings.simplefilter("ignore", vx.MeshWarning)
        warnings.simplefilter("ignore", vx.AccuracyWarning)
        warnings.simplefilter("ignore", vx.RobotWarning)
        warnings.simplefilter("ignore", vx.UnitWarning)
        box = vx.ConvexHull([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]).mesh
        model = vx.Model.from_mesh((box.vertices, box.faces[1:]), resolution=20)
        assert len(model.shell) > 0


def test_no_public_name_is_left_out():
    used = set(re.findall(r"\bvx\.(\w+)", Path(__file__).read_text()))
    assert set(vx.__all__) - used == set()
    assert vx.__version__.count(".") == 2
