"""Tables of names that users of other libraries try first, and what to use instead."""

from __future__ import annotations

from voxshell.base.pybullet_names import PYBULLET

_COLORS = "pass colors={body: (255, 0, 0)} to World.view() or Recorder.recording()"
_AXIS_ANGLE = "pass axis_angle=(axis, angle), with the angle in radians"
_QUATERNION = "pass xyzw=... (real part last) or wxyz=... (real part first)"
_JOINT_TORQUE = (
    "call apply_torque() of its child, and of its parent with the opposite sign, or set_target_velocity() of a motor "
    "with max_force"
)
_JOINT_TORQUES = (
    "call apply_torque() on the two bodies of a joint, with opposite signs, or set_target_velocities() of motors with "
    "max_force"
)
_FIXED = "World.add() fixes it; remove the body, and add another"

ABSENT = {
    "Body": {
        "color": _COLORS,
        "orientation": "did you mean orientation_xyzw?",
        "quat": "did you mean orientation_xyzw?",
        "quaternion": "did you mean orientation_xyzw?",
        "rotation": "did you mean orientation_xyzw, or pose[:3, :3]?",
        "set_pose": "call place(pose), or set pose",
        "set_velocity": "set linear_velocity and angular_velocity",
        "velocity": "did you mean linear_velocity?",
    },
    "Contacts": {
        "depth": "did you mean depths?",
        "normal": "did you mean normals?",
        "points": "did you mean points_a or points_b?",
    },
    "Joint": {
        "apply_torque": _JOINT_TORQUE,
        "limits": "its kind has them: joint.kind.limits",
        "set_position": "call set_positions({name: position}) of a robot, or place its bodies",
        "set_target": "call set_target_position() or set_target_velocity()",
        "set_torque": _JOINT_TORQUE,
        "set_velocity": "call set_velocities({name: velocity}) of a robot, or set those of its bodies",
        "torque": "did you mean reaction?",
    },
    "Model": {
        "mass": "a model has none; pass mass=... to World.add() or Model.mass_properties()",
        "scale": "pass scale=... to Model.from_mesh()",
        "show": "call trimesh.Trimesh(*model.mesh).show(), or add it to a World and call World.view()",
        "view": "add it to a World, and call World.view()",
        "volume": "take that of its mesh: trimesh.Trimesh(*model.mesh).volume",
    },
    "Robot": {
        "apply_torque": _JOINT_TORQUES,
        "joint_positions": "did you mean positions?",
        "joint_velocities": "did you mean velocities?",
        "mass": "sum those of its bodies: sum(body.mass for body in robot.bodies)",
        "move_to": "call set_targets({name: position})",
        "pose": "take that of a link: robot.links[name].pose",
        "qpos": "did you mean positions?",
        "qvel": "did you mean velocities?",
        "reset": "call set_positions({name: position}) and set_velocities({name: velocity})",
        "set_joint_positions": "call set_positions() to put joints there, or set_targets() to drive them there",
        "set_joint_velocities": "call set_velocities() to set them at once, or set_target_velocities() for motors",
        "set_target_positions": "did you mean set_targets?",
        "set_target_velocity": "did you mean set_target_velocities?",
        "set_forces": _JOINT_TORQUES,
        "set_torques": _JOINT_TORQUES,
    },
    "World": PYBULLET
    | {
        "loadMJCF": "call voxshell.load_mjcf(world, path)",
        "loadURDF": "call voxshell.load_urdf(world, path)",
        "add_body": "did you mean add?",
        "add_plane": "call add(voxshell.Plane())",
        "body": "keep what add() returns, or look in bodies, a tuple",
        "dt": "did you mean time_step?",
        "load_mjcf": "call voxshell.load_mjcf(world, path)",
        "load_urdf": "call voxshell.load_urdf(world, path)",
        "raycast": "did you mean ray_cast?",
        "render": "did you mean view?",
        "run": "did you mean step?",
        "save_html": "record first: recorder = world.record(), and after the steps recorder.save_html(path)",
        "save_video": (
            "record first: recorder = world.record(), and after the steps recorder.recording().save_video(path)"
        ),
        "set_gravity": "set World.gravity, as in world.gravity = (0, 0, -9.81)",
        "show": "did you mean view?",
        "simulate": "did you mean step?",
        "timestep": "did you mean time_step?",
    },
}
"""Names that a class does not have, and what to do instead."""

OF_PACKAGE = PYBULLET | {
    "closest_points": "call voxshell.distance(a, b), or World.query_contacts(a, b, margin=distance)",
    "contact": "did you mean contacts?",
    "load": "call voxshell.Model.load(path) or voxshell.Recording.load(path)",
    "load_mesh": "call voxshell.Model.from_mesh(path)",
    "load_model": "call voxshell.Model.load(path)",
    "raycast": "call World.ray_cast(starts, ends)",
}
"""Names that the package does not have, and what to do instead."""

READ_ONLY = {
    "Body": {"mass": _FIXED, "motion": _FIXED, "shape": _FIXED},
    "Joint": {
        "position": "drive the joint with set_target_position()",
        "velocity": "drive the joint with set_target_velocity()",
    },
    "Model": {"tolerance": "pass tolerance=... to Model.from_mesh()"},
    "World": {
        "time": "it counts the steps; restore_state() returns to an earlier time",
        "time_step": "pass time_step=... to voxshell.World()",
    },
}
"""Properties of a class that cannot be set, and what to do instead."""

ARGUMENTS = {
    "Box": {"size": "pass half_extents, half of each edge length"},
    "World.add": {
        "color": _COLORS,
        "scale": "build the model first: Model.from_mesh(mesh, scale=0.001)",
        "velocity": "set the body's linear_velocity after it was added",
    },
    "World.step": {"dt": "it belongs to the world: World(time_step=...)"},
    "pose": {
        "angle": _AXIS_ANGLE,
        "axis": _AXIS_ANGLE,
        "degrees": "angles are radians; pass euler=numpy.radians((...))",
        "matrix": "a (4, 4) matrix is a pose by itself; pass a (3, 3) one as rotation=...",
        "quat": _QUATERNION,
        "quaternion": _QUATERNION,
    },
}
"""Arguments that a call does not have, and what to do instead."""

UNNAMED = {
    "Box": "pass half of each edge length as one argument: Box((0.5, 0.5, 0.5))",
    "Compound": "pass one list of pairs of a shape and its pose: Compound([(shape, pose), ...])",
    "Model.from_mesh": (
        "name the factor that converts lengths to meters, as in scale=0.001; pass vertices and faces as one argument: "
        "Model.from_mesh((vertices, faces))"
    ),
    "World.add": "name the others, as in add(shape, mass=1.0, pose=(0, 0, 1))",
    "pose": "name the order of a quaternion, xyzw=... or wxyz=...; for a matrix, pass rotation=...",
}
"""What to do about too many arguments without names."""

MISSING = {
    "load_mjcf": "the world comes first, as in load_mjcf(world, path)",
    "load_urdf": "the world comes first, as in load_urdf(world, path)",
    "Mesh": "a Mesh holds the arrays of model.mesh; for a model of a file, call Model.from_mesh(path)",
    "wrench": (
        "stiffness is the pressure per depth in newtons per cubic meter: the force, divided by the area in contact and "
        "the depth; stiffness=1e8 presses with 10 N where 1 cm2 is 1 mm deep"
    ),
}
"""What to do about arguments that are missing in a call."""

SYNONYMS = {
    "base_orientation": ("pose",),
    "base_position": ("pose",),
    "dt": ("time_step",),
    "extents": ("half_extents",),
    "force": ("max_force",),
    "fps": ("frames_per_second",),
    "height": ("length",),
    "length": ("height",),
    "orientation": ("xyzw", "pose"),
    "pose_a": ("a_pose", "a_poses"),
    "pose_b": ("b_pose", "b_poses"),
    "position": ("pose",),
    "rotation": ("pose",),
    "rpy": ("euler",),
    "torque": ("max_force",),
    "velocity": ("surface_velocity", "linear_velocity"),
}
"""Arguments of other libraries, each with those of ours that it may stand for, best first."""
