"""Functions of pybullet, and what to use instead."""

from __future__ import annotations

PYBULLET = {
    "addUserDebugLine": "it has no counterpart; World.view() and recordings show contacts as arrows",
    "applyExternalForce": "call Body.apply_force(force, at=point), in the world frame",
    "applyExternalTorque": "call Body.apply_torque(torque), in the world frame",
    "calculateInverseDynamics": "it has no counterpart",
    "calculateInverseKinematics": "it has no counterpart; use a library for kinematics, and Robot.set_targets()",
    "calculateJacobian": "it has no counterpart; use a library for kinematics",
    "changeDynamics": (
        "set the body's properties, such as body.friction, or pass them to World.add(); its mass cannot change"
    ),
    "changeVisualShape": "pass colors={body: (255, 0, 0)} to World.view() or Recorder.recording()",
    "connect": "there is no client: make a World(), and call World.view() to watch it in a browser",
    "createCollisionShape": (
        "pass a shape to World.add(): Model.from_mesh(path), Box(half_extents), Sphere(radius), Plane(), ..."
    ),
    "createConstraint": "call World.add_joint(kind, parent, child)",
    "createMultiBody": "call World.add(shape, mass=..., pose=...)",
    "createVisualShape": "it has no counterpart; World.view() draws the shape that collides",
    "disconnect": "there is no client; a World ends when nothing refers to it",
    "getAABB": "use Body.bounds",
    "getBasePositionAndOrientation": (
        "use Body.center_of_mass, or Body.position for the origin of the mesh, and Body.orientation_xyzw"
    ),
    "getBaseVelocity": "use Body.linear_velocity and Body.angular_velocity",
    "getClosestPoints": "call World.query_contacts(a, b, margin=distance), or voxshell.distance(a, b)",
    "getContactPoints": "call World.contacts(), or voxshell.contacts(a, b) for two bodies without a world",
    "getDynamicsInfo": "use Body.mass, Body.inertia, Body.friction and Body.restitution",
    "getEulerFromQuaternion": "use scipy's Rotation.from_quat(xyzw).as_euler('xyz')",
    "getJointInfo": "use Robot.joints[name].kind",
    "getJointState": "use Joint.position, Joint.velocity and Joint.reaction",
    "getJointStates": "use Robot.positions and Robot.velocities",
    "getLinkState": "use Robot.links[name].pose",
    "getMatrixFromQuaternion": "call voxshell.pose(xyzw=...), and take [:3, :3] of it",
    "getNumBodies": "use len(World.bodies)",
    "getNumJoints": "use len(Robot.joints)",
    "getQuaternionFromEuler": "call voxshell.pose(position, euler=...), and pass the matrix as a pose",
    "performCollisionDetection": "call World.query_contacts(a, b) or World.overlaps(a, b), which need no step",
    "rayTest": "call World.ray_cast(starts, ends)",
    "rayTestBatch": "call World.ray_cast(starts, ends)",
    "removeBody": "call World.remove(body)",
    "removeConstraint": "call World.remove(joint)",
    "resetBasePositionAndOrientation": "call Body.place(pose)",
    "resetBaseVelocity": "set Body.linear_velocity and Body.angular_velocity",
    "resetJointState": "call Robot.set_positions({name: position}), and then set_velocities({name: velocity})",
    "resetSimulation": "make another World()",
    "restoreState": "call World.restore_state(state)",
    "saveBullet": "call World.save_state().save(path)",
    "saveState": "call World.save_state()",
    "setCollisionFilterGroupMask": "set Body.group and Body.mask",
    "setCollisionFilterPair": "call World.set_collision(a, b, False)",
    "setGravity": "pass gravity=... to voxshell.World(), or set World.gravity",
    "setJointMotorControl2": "call Robot.set_targets({name: position}), or set_target_velocity() of a joint",
    "setJointMotorControlArray": "call Robot.set_targets({name: position}) or set_target_velocities()",
    "setRealTimeSimulation": "call World.view(speed=1), and World.step() in a loop",
    "setTimeStep": "pass time_step=... to voxshell.World()",
    "startStateLogging": "call World.record()",
    "stepSimulation": "call World.step()",
}
"""Functions of pybullet that neither the package nor a world has, and what to use instead."""
