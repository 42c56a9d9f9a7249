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

/// Meters or radians along or about the joint's x axis; newtons or newton meters.
struct JointSettings {
  JointKind kind = JointKind::kFixed;
  int parent = kWorld;  ///< number of a body
  int child = 0;
  Pose parent_from_joint;  ///< frames of geometries, or of the world without a parent
  Pose child_from_joint;
  double lower = 1.0;  ///< above `upper`: no limits
  double upper = -1.0;
  double friction = 0.0;         ///< while no motor drives the joint
  double damping = 0.0;          ///< per m/s or rad/s
  double stiffness = 0.0;        ///< of a spring: per meter or radian
  double spring_position = 0.0;  ///< where the spring is relaxed
  double armature = 0.0;         ///< inertia along or about the axis, kg or kg m2
  bool collides = false;         ///< true if its bodies collide with each other

  static constexpr int kWorld = -1;
};

enum class MotorMode { kNone, kVelocity, kPosition, kFollow };

/// The motor of a joint.
struct Motor {
  MotorMode mode = MotorMode::kNone;
  double target = 0.0;  ///< velocity or position; of a follower, the offset
  double max_force = 0.0;
  double max_speed = 0.0;
  int leader = -1;  ///< number of the joint to follow
  double multiplier = 1.0;
  double velocity = 0.0;  ///< with which a target position moves on, m/s or rad/s
};

/// Position and velocity of a joint, along or about its axis; turns count.
struct JointReading {
  double position = 0.0;
  double velocity = 0.0;
};

/// Force and torque of a joint on its child in the last step: newtons and, about the joint's
/// origin, newton meters; world frame.
struct JointReaction {
  Vec3 force;
  Vec3 torque;
};

class AxesConstraint;

/// One of Bullet's constraints with additions: turns beyond pi, springs, and motors with a target.
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
  /// Origin and x axis, world frame, from the parent.
  btTransform world_from_joint() const;

  /// Sets limits and motor for a step; `leader` is the position of the joint that this one follows.
  void prepare_step(double time_step, const JointReading& leader);
  /// Counts turns.
  void finish_step() { position_ = unwrap(); }
  /// Counts turns such that the present position is the nearest to this one.
  void count_turns_from(double position) {
    position_ = position;
    finish_step();
  }

  /// What it knows of the last step.
  struct LastStep {
    double position;  ///< turns counted
    btJointFeedback feedback;
  };
  LastStep last_step() const { return {position_, feedback_}; }
  void set_last_step(const LastStep& last) {
    position_ = last.position;
    feedback_ = last.feedback;
  }

 private:
  bool has_axis() const {
    return settings_.kind == JointKind::kHinge || settings_.kind == JointKind::kSlider;
  }
  bool is_limited() const { return settings_.lower <= settings_.upper; }
  btTransform parent_from_child_joint() const;
  double raw_position() const;
  double unwrap() const;
  void limit_closing(double time_step);
  void set_limits(double position, double time_step);
  void drive(double velocity, double force);

  JointSettings settings_;
  btRigidBody& parent_;
  btRigidBody& child_;
  btTransform parent_from_joint_;
  btTransform child_from_joint_;
  std::unique_ptr<btTypedConstraint> constraint_;
  AxesConstraint* axes_ = nullptr;  ///< for all kinds but kPoint
  btJointFeedback feedback_;
  double position_ = 0.0;  ///< after the last step
};

}  // namespace voxshell::python
