#include "bullet/joint.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <optional>

#include "voxshell/bullet/convert.h"

namespace voxshell::python {
using bullet::from_bullet;

namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;
/// Fraction of an error that a motor with a target closes in a step.
constexpr double kServoGain = 0.2;
/// Fraction of an error, at limits and along the other axes, that Bullet closes in a step. Bullet's
/// own default of 0.2 lets arms sag.
constexpr double kErrorReduction = 0.8;
/// Fastest closing of joints that have come apart. Larger: links that are much lighter than what
/// they carry gain energy without end.
constexpr double kClosingSpeed = 1.0;  // m/s, rad/s
constexpr double kStill = 1e-6;        // m/s, rad/s
/// Fastest return of a joint that is beyond a limit, where it began or was thrown. Larger: joints
/// are shot in, and through the other limit.
constexpr double kSlideBackSpeed = 0.1;  // m/s
constexpr double kTurnBackSpeed = 1.0;   // rad/s
/// Limits farther away than this are not reached within a step. Less than half a turn: Bullet takes
/// angles for others that are whole turns away.
constexpr double kFarLimit = 3.0;  // rad
/// Fraction of what a spring gives way by within a step that it takes into account at least. More
/// than 0: otherwise its force would not depend on the velocity, and its row would have no target.
constexpr double kLeastForesight = 1e-5;

}  // namespace

/// Six axes and, where the joint has a spring, damping or armature, a row for these along its axis.
class AxesConstraint : public btGeneric6DofSpring2Constraint {
 public:
  AxesConstraint(const JointSettings& settings, bool solves_soft_rows, btRigidBody& parent,
                 btRigidBody& child, const btTransform& parent_from_joint,
                 const btTransform& child_from_joint)
      : btGeneric6DofSpring2Constraint(parent, child, parent_from_joint, child_from_joint),
        slides_(settings.kind == JointKind::kSlider),
        damping_(static_cast<btScalar>(settings.damping)),
        stiffness_(static_cast<btScalar>(settings.stiffness)),
        armature_(static_cast<btScalar>(settings.armature)),
        solves_soft_rows_(solves_soft_rows) {}

  void getInfo1(btConstraintInfo1* info) override {
    btGeneric6DofSpring2Constraint::getInfo1(info);
    rows_ = info->m_numConstraintRows;
    if (is_soft()) ++info->m_numConstraintRows;
  }

  void getInfo2(btConstraintInfo2* info) override {
    btGeneric6DofSpring2Constraint::getInfo2(info);
    if (slides_ && !m_hasStaticBody) move_to_child(*info);
    if (is_soft()) add_soft_row(*info, rows_ * info->rowskip);
  }

  /// @param stretch  Position at the start of the step, from where the spring is relaxed.
  void begin_step(double stretch) {
    stretch_ = static_cast<btScalar>(stretch);
    velocity_before_.reset();
  }

 private:
  bool is_soft() const { return damping_ > 0 || stiffness_ > 0 || armature_ > 0; }

  /// Bullet's constraint pushes across the axis at the parent's frame on the parent, and at the
  /// child's frame on the child. The farther these are apart, the larger the spurious torque: two
  /// freely rotating boxes flew apart within a second. Here both forces act at the child's frame.
  /// Bullet omits the torque if one of the bodies is static.
  void move_to_child(btConstraintInfo2& info) const {
    const btVector3 lever = m_calculatedTransformB.getOrigin() - m_rbA.getCenterOfMassPosition();
    for (int row = 0; row < rows_; ++row) {
      const btScalar* axis = info.m_J1linearAxis + row * info.rowskip;
      const btVector3 direction(axis[0], axis[1], axis[2]);
      if (direction.fuzzyZero()) continue;  // a rotation row
      const btVector3 torque = lever.cross(direction);
      btScalar* angular = info.m_J1angularAxis + row * info.rowskip;
      for (int i = 0; i < 3; ++i) angular[i] = torque[i];
    }
  }

  /// A row whose impulse is -time step * (stiffness * (stretch + foresight * time step * v) +
  /// damping * v) - armature * (v - v0), with the velocities v0 before and v after the step. The
  /// springs and dampers of Bullet's constraint use v0: dampers do nothing while another force
  /// slows the joint by more.
  void add_soft_row(btConstraintInfo2& info, int row) {
    const btVector3 axis = m_calculatedTransformA.getBasis().getColumn(0);
    const btVector3 place = m_calculatedTransformB.getOrigin();
    const btVector3 none(0, 0, 0);
    const btVector3 linear = slides_ ? axis : none;
    const auto angular_of = [&](const btRigidBody& body) {
      return slides_ ? (place - body.getCenterOfMassPosition()).cross(axis) : axis;
    };
    const btVector3 angular_a = angular_of(m_rbA);
    const btVector3 angular_b = angular_of(m_rbB);
    for (int i = 0; i < 3; ++i) {
      info.m_J1linearAxis[row + i] = -linear[i];
      info.m_J1angularAxis[row + i] = -angular_a[i];
      info.m_J2linearAxis[row + i] = linear[i];
      info.m_J2angularAxis[row + i] = angular_b[i];
    }
    const btScalar h = 1 / info.fps;
    // Velocity that a unit impulse changes.
    const btScalar change = (m_rbA.getInvMass() + m_rbB.getInvMass()) * linear.length2() +
                            angular_a.dot(m_rbA.getInvInertiaTensorWorld() * angular_a) +
                            angular_b.dot(m_rbB.getInvInertiaTensorWorld() * angular_b);
    const btScalar velocity =
        linear.dot(m_rbB.getVelocityInLocalPoint(place - m_rbB.getCenterOfMassPosition()) -
                   m_rbA.getVelocityInLocalPoint(place - m_rbA.getCenterOfMassPosition())) +
        (slides_ ? btScalar(0) : axis.dot(m_rbB.getAngularVelocity() - m_rbA.getAngularVelocity()));
    // A step may be solved several times, and bodies begin the later ones with other velocities.
    if (!velocity_before_) velocity_before_ = velocity;
    // Squared phase of the spring's oscillation per step. Without foresight oscillations keep their
    // energy, and diverge from 2 radians on; with full foresight they die away.
    const btScalar phase2 = h * h * stiffness_ * change / (1 + armature_ * change);
    const btScalar foresight = btMax(btScalar(kLeastForesight), 1 - 1 / btMax(phase2, btScalar(1)));
    const btScalar per_velocity =
        armature_ + h * (damping_ + foresight * h * stiffness_);  // impulse
    // Where the impulse is 0.
    const btScalar target =
        (armature_ * *velocity_before_ - h * stiffness_ * stretch_) / per_velocity;
    info.m_constraintError[row] = target;
    if (solves_soft_rows_) {
      // Relative to `change`.
      if (change > 0) info.cfm[row] = 1 / (per_velocity * change);
      return;
    }
    // Other solvers' impulses diverge on soft rows. This one is off by what the velocity changes
    // by within the step.
    info.m_upperLimit[row] = per_velocity * btFabs(velocity - target);
    info.m_lowerLimit[row] = -info.m_upperLimit[row];
  }

  bool slides_;
  btScalar damping_;
  btScalar stiffness_;
  btScalar armature_;
  btScalar stretch_ = 0;
  std::optional<btScalar> velocity_before_;  ///< the step, along the axis
  bool solves_soft_rows_;
  int rows_ = 0;
};

Joint::Joint(const JointSettings& settings, bool solves_soft_rows, btRigidBody& parent,
             btRigidBody& child, const btTransform& parent_from_joint,
             const btTransform& child_from_joint)
    : settings_(settings),
      parent_(parent),
      child_(child),
      parent_from_joint_(parent_from_joint),
      child_from_joint_(child_from_joint) {
  if (settings.kind == JointKind::kPoint) {
    constraint_ = std::make_unique<btPoint2PointConstraint>(
        parent, child, parent_from_joint.getOrigin(), child_from_joint.getOrigin());
    constraint_->setParam(BT_CONSTRAINT_ERP, kErrorReduction);
  } else {
    auto axes = std::make_unique<AxesConstraint>(settings, solves_soft_rows, parent, child,
                                                 parent_from_joint, child_from_joint);
    axes_ = axes.get();
    constexpr int kAxes = 6;
    for (int axis = 0; axis < kAxes; ++axis) {
      axes_->setLimit(axis, 0.0, 0.0);
      axes_->setParam(BT_CONSTRAINT_STOP_ERP, kErrorReduction, axis);
    }
    constraint_ = std::move(axes);
  }
  // Bullet's constructor does not, and the first step reads it before it is solved.
  for (btVector3* const each : {&feedback_.m_appliedForceBodyA, &feedback_.m_appliedTorqueBodyA,
                                &feedback_.m_appliedForceBodyB, &feedback_.m_appliedTorqueBodyB}) {
    each->setZero();
  }
  constraint_->setJointFeedback(&feedback_);
  position_ = has_axis() ? raw_position() : 0.0;
}

btTransform Joint::world_from_joint() const {
  return parent_.getCenterOfMassTransform() * parent_from_joint_;
}

btTransform Joint::parent_from_child_joint() const {
  return world_from_joint().inverse() * child_.getCenterOfMassTransform() * child_from_joint_;
}

/// For hinges, within half a turn.
double Joint::raw_position() const {
  const btTransform offset = parent_from_child_joint();
  if (settings_.kind == JointKind::kSlider) return offset.getOrigin().x();
  const btQuaternion turn = offset.getRotation();
  return std::remainder(2.0 * std::atan2(turn.x(), turn.w()), kTurn);
}

double Joint::unwrap() const {
  if (!has_axis()) return 0.0;
  const double raw = raw_position();
  if (settings_.kind == JointKind::kSlider) return raw;
  return position_ + std::remainder(raw - position_, kTurn);
}

JointReading Joint::read() const {
  if (!has_axis()) return {};
  const btTransform joint = world_from_joint();
  const btVector3 axis = joint.getBasis().getColumn(0);
  if (settings_.kind == JointKind::kHinge) {
    return {unwrap(), axis.dot(child_.getAngularVelocity() - parent_.getAngularVelocity())};
  }
  const btVector3 place = child_.getCenterOfMassTransform() * child_from_joint_.getOrigin();
  const btVector3 speed =
      child_.getVelocityInLocalPoint(place - child_.getCenterOfMassPosition()) -
      parent_.getVelocityInLocalPoint(place - parent_.getCenterOfMassPosition());
  return {unwrap(), axis.dot(speed)};
}

JointReaction Joint::reaction() const {
  const btVector3 place = child_.getCenterOfMassTransform() * child_from_joint_.getOrigin();
  const btVector3 lever = child_.getCenterOfMassPosition() - place;
  return {from_bullet(feedback_.m_appliedForceBodyB),
          from_bullet(feedback_.m_appliedTorqueBodyB + lever.cross(feedback_.m_appliedForceBodyB))};
}

/// Bullet's motors have the opposite sign.
void Joint::drive(double velocity, double force) {
  const bool drives = force > 0.0;
  if (settings_.kind == JointKind::kSlider) {
    btTranslationalLimitMotor2& motor_of_axes = *axes_->getTranslationalLimitMotor();
    motor_of_axes.m_enableMotor[0] = drives;
    motor_of_axes.m_targetVelocity[0] = -velocity;
    motor_of_axes.m_maxMotorForce[0] = force;
    return;
  }
  btRotationalLimitMotor2& motor_of_axis = *axes_->getRotationalLimitMotor(0);
  motor_of_axis.m_enableMotor = drives;
  motor_of_axis.m_targetVelocity = -velocity;
  motor_of_axis.m_maxMotorForce = force;
}

void Joint::set_limits(double position, double time_step) {
  const bool slides = settings_.kind == JointKind::kSlider;
  const double back = (slides ? kSlideBackSpeed : kTurnBackSpeed) * time_step / kErrorReduction;
  const double lower = is_limited() ? std::min(settings_.lower, position + back) : 1.0;
  const double upper = is_limited() ? std::max(settings_.upper, position - back) : -1.0;
  if (slides) {
    axes_->setLimit(0, lower, upper);
    return;
  }
  // Bullet's angles have the opposite sign.
  btRotationalLimitMotor2& axis = *axes_->getRotationalLimitMotor(0);
  axis.m_loLimit = -upper;
  axis.m_hiLimit = -lower;
  if (!is_limited()) return;
  // They do not count turns either, so they begin where the joint is now.
  const btTransform turned(btQuaternion(btVector3(1, 0, 0), raw_position()));
  axes_->getFrameOffsetA() = parent_from_joint_ * turned;
  axis.m_loLimit = -std::min(upper - position, kFarLimit);
  axis.m_hiLimit = -std::max(lower - position, -kFarLimit);
}

/// Lets the joint close within what it has come apart by.
void Joint::limit_closing(double time_step) {
  const auto reduction = [&](double error) {
    return std::min(kErrorReduction, kClosingSpeed * time_step / std::max(error, 1e-300));
  };
  const btTransform offset = parent_from_child_joint();
  btVector3 gap = offset.getOrigin();
  if (settings_.kind == JointKind::kPoint) {
    constraint_->setParam(BT_CONSTRAINT_ERP, reduction(gap.length()));
    return;
  }
  if (settings_.kind == JointKind::kSlider) gap.setX(0);
  const bool turns = settings_.kind == JointKind::kHinge;
  const double tilt = turns ? offset.getBasis().getColumn(0).angle({1, 0, 0})
                            : offset.getRotation().getAngleShortestPath();
  constexpr int kAxes = 6;
  constexpr int kLinear = 3;
  for (int axis = 0; axis < kAxes; ++axis) {
    if (axis == (turns ? kLinear : 0) && has_axis()) continue;
    axes_->setParam(BT_CONSTRAINT_STOP_ERP, reduction(axis < kLinear ? gap.length() : tilt), axis);
  }
}

void Joint::prepare_step(double time_step, const JointReading& leader) {
  limit_closing(time_step);
  if (!has_axis()) return;
  const double position = unwrap();
  set_limits(position, time_step);
  axes_->begin_step(position - settings_.spring_position);

  double velocity = 0.0;
  const auto toward = [&](double target, double speed) {
    const double closing = kServoGain * (target - position) / time_step + speed;
    return std::clamp(closing, -motor.max_speed, motor.max_speed);
  };
  switch (motor.mode) {
    case MotorMode::kNone:
      drive(0.0, settings_.friction);
      return;
    case MotorMode::kVelocity:
      velocity = motor.target;
      break;
    case MotorMode::kPosition:
      velocity = toward(motor.target, motor.velocity);
      break;
    case MotorMode::kFollow:
      velocity = toward(motor.multiplier * leader.position + motor.target,
                        motor.multiplier * leader.velocity);
      break;
  }
  drive(velocity, motor.max_force);
  if (std::abs(velocity) > kStill) {
    parent_.activate();
    child_.activate();
  }
}

}  // namespace voxshell::python
