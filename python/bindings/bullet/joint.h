#pragma once

#include <memory>

#include <btBulletDynamicsCommon.h>

#include "voxshell/pose.h"

namespace voxshell::python {

enum class JointKind {
  kFixed,
  kHinge,   ///< turns about the joint's x axis
  kSlider,  ///< moves along the joint's x axis
  kPoint,   ///< turns about the joint's origin
};

/// Metres or radians along or about the joint's x axis; newtons or newton metres.
struct JointSettings {
  JointKind kind = JointKind::kFixed;
  int parent = kWorld;  ///< number of a body
  int child = 0;
  Pose parent_from_joint;  ///< frames of geometries; of the world where that is the parent
  Pose child_from_joint;
  double lower = 1.0;  ///< above `upper`: no limits
  double upper = -1.0;
  double friction = 0.0;  ///< what it withstands where no motor drives it
  double damping = 0.0;   ///< per m/s or rad/s
  bool collides = false;  ///< whether its bodies collide with each other

  static constexpr int kWorld = -1;
};

enum class MotorMode { kNone, kVelocity, kPosition, kFollow };

/// What drives a joint.
struct Motor {
  MotorMode mode = MotorMode::kNone;
  double target = 0.0;  ///< velocity or position; of one that follows, the offset
  double max_force = 0.0;
  double max_speed = 0.0;
  int leader = -1;  ///< number of the joint that is followed,
  double multiplier = 1.0;
};

/// Where a joint stands: along or about its axis, turns counted.
struct JointReading {
  double position = 0.0;
  double velocity = 0.0;
};

/// What a joint did to its child in the last step: newtons and, about the joint's origin, newton
/// metres; world frame.
struct JointReaction {
  Vec3 force;
  Vec3 torque;
};

/// One of Bullet's constraints with what it lacks: turns beyond pi, and motors with a target.
class Joint {
 public:
  /// `parent_from_joint` and `child_from_joint` are in the frames of Bullet's bodies.
  /// `solves_soft_rows` says that the solver is CoulombSolver.
  Joint(const JointSettings& settings, bool solves_soft_rows, btRigidBody& parent,
        btRigidBody& child, const btTransform& parent_from_joint,
        const btTransform& child_from_joint);

  const JointSettings& settings() const { return settings_; }
  btTypedConstraint& constraint() { return *constraint_; }

  Motor motor;

  JointReading read() const;
  JointReaction reaction() const;
  /// Origin and x axis, world frame, as the parent has them.
  btTransform world_from_joint() const;

  /// Sets limits and motor for a step; `leader` is where the joint that this one follows stands.
  void prepare_step(double time_step, const JointReading& leader);
  /// Counts turns.
  void finish_step() { position_ = unwrap(); }

  double counted_position() const { return position_; }
  void set_counted_position(double position) { position_ = position; }

 private:
  bool has_axis() const {
    return settings_.kind == JointKind::kHinge || settings_.kind == JointKind::kSlider;
  }
  bool is_limited() const { return settings_.lower <= settings_.upper; }
  btTransform parent_from_child_joint() const;
  double raw_position() const;
  double unwrap() const;
  void drive(double velocity, double force);

  JointSettings settings_;
  btRigidBody& parent_;
  btRigidBody& child_;
  btTransform parent_from_joint_;
  btTransform child_from_joint_;
  std::unique_ptr<btTypedConstraint> constraint_;
  btGeneric6DofSpring2Constraint* axes_ = nullptr;  ///< of all kinds but kPoint
  btJointFeedback feedback_{};
  double position_ = 0.0;  ///< after the last step
};

}  // namespace voxshell::python
