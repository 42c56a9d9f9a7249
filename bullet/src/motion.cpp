#include "motion.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include "contact_constants.h"
#include "of_this_thread.h"
#include "voxshell/bullet/convert.h"

namespace voxshell::bullet {
namespace {

/// By Rodrigues' formula. The axis has unit length.
Vec3 turned(const Vec3& v, const Vec3& axis, double angle) {
  return std::cos(angle) * v + std::sin(angle) * cross(axis, v) +
         (1.0 - std::cos(angle)) * dot(axis, v) * axis;
}

/// What its own force alone would add to a link's velocity: joints are left out.
Vec3 velocity_of_force(const btMultiBody& body, int link, double time_step) {
  const bool is_base = link < 0;
  if (is_base && body.hasFixedBase()) return {};
  const auto mass = static_cast<double>(is_base ? body.getBaseMass() : body.getLinkMass(link));
  if (!(mass > 0.0)) return {};
  return (time_step / mass) * from_bullet(is_base ? body.getBaseForce() : body.getLinkForce(link));
}

/// Kept from step to step, as settled ones take no memory.
struct LinkVelocities {
  std::vector<btVector3> angular;
  std::vector<btVector3> linear;
};

Motion of_link(const btMultiBodyLinkCollider& collider, double time_step) {
  const btMultiBody& body = *collider.m_multiBody;
  auto& [angular, linear] = of_this_thread<LinkVelocities>();
  const auto count = static_cast<std::size_t>(body.getNumLinks()) + 1;
  angular.resize(count);
  linear.resize(count);
  body.compTreeLinkVelocities(angular.data(), linear.data());
  const btTransform& world_from_link = collider.getWorldTransform();
  const int place = collider.m_link + 1;  // the base is the first
  const auto link = static_cast<std::size_t>(place);
  const Vec3 of_force = velocity_of_force(body, collider.m_link, time_step);
  return {from_bullet(world_from_link.getOrigin()),
          from_bullet(world_from_link.getBasis() * linear[link]),
          from_bullet(world_from_link.getBasis() * angular[link]),
          of_force,
          of_force,
          0.0,
          {{}, {}, {}},
          true};
}

}  // namespace

Motion Motion::of(const btCollisionObject& object, double time_step) {
  if (const auto* collider = btMultiBodyLinkCollider::upcast(&object)) {
    if (collider->m_multiBody != nullptr) return of_link(*collider, time_step);
  }
  const btRigidBody* body = btRigidBody::upcast(&object);
  if (body == nullptr) return {};
  const auto inverse_mass = static_cast<double>(body->getInvMass());
  const btMatrix3x3& inertia = body->getInvInertiaTensorWorld();
  const Vec3 of_forces = time_step * inverse_mass * from_bullet(body->getTotalForce());
  return {from_bullet(body->getCenterOfMassPosition()),
          from_bullet(body->getLinearVelocity()),
          from_bullet(body->getAngularVelocity()),
          of_forces,
          of_forces,
          inverse_mass,
          {from_bullet(inertia[0]), from_bullet(inertia[1]), from_bullet(inertia[2])}};
}

bool Motion::is_supported(const Support::Push& by_contacts, double radius) const {
  if (inverse_mass == 0.0) return velocity_of_forces == Vec3{};
  const Vec3 fall = velocity_of_forces + by_contacts.velocity;
  return length(fall) + radius * length(by_contacts.angular_velocity) +
             kUnsolvedOfLoad * by_contacts.load <=
         kSupportedWithin * length(velocity_of_forces);
}

Pose Motion::moved(const Pose& world_from_x, double fraction, double time_step) const {
  const Vec3 turn = fraction * time_step * angular_velocity;
  const double angle = length(turn);
  const Vec3 axis = normalized(turn);
  const auto after = [&](const Vec3& v) { return turned(v, axis, angle); };
  const Matrix3 columns = world_from_x.rotation.transposed();
  const Matrix3 rotation =
      Matrix3{after(columns.row_x), after(columns.row_y), after(columns.row_z)}.transposed();
  const Vec3 displacement = fraction * time_step * (velocity + velocity_of_fall);
  return {rotation, center + displacement + after(world_from_x.translation - center)};
}

double find_farthest_displacement(const Motion& a, const Motion& b, const Ball& ball,
                                  double time_step) {
  // The relative velocity is affine in the place.
  const Vec3 of_center = a.velocity_at(ball.center) + a.velocity_of_fall -
                         b.velocity_at(ball.center) - b.velocity_of_fall;
  const double of_spin = length(a.angular_velocity - b.angular_velocity) * ball.radius;
  return (length(of_center) + of_spin) * time_step;
}

double find_farthest_if_stopped(const Motion& a, const Motion& b, const Ball& ball,
                                double time_step) {
  return std::max({find_farthest_displacement(a, b, ball, time_step),
                   find_farthest_displacement(a, Motion{}, ball, time_step),
                   find_farthest_displacement(Motion{}, b, ball, time_step)});
}

double find_touch_reach(const Motion& a, const Motion& b, const Ball& ball, double time_step) {
  // Places of the larger body may be as far outside of the ball as this reach, where spin is
  // faster.
  const double spin =
      time_step * std::max({length(a.angular_velocity - b.angular_velocity),
                            length(a.angular_velocity), length(b.angular_velocity)});
  return find_farthest_if_stopped(a, b, ball, time_step) /
         (1.0 - std::min(spin, kMostReachingTurn));
}

RelativeMotion RelativeMotion::of(const Motion& body, const Motion& seen_from,
                                  const Pose& world_from_frame) {
  const Vec3& origin = world_from_frame.translation;
  const Matrix3 frame_from_world = world_from_frame.rotation.transposed();
  const auto spin_of = [&](const Motion& motion) {
    return Spin{frame_from_world * (motion.center - origin),
                frame_from_world * motion.angular_velocity};
  };
  return {frame_from_world * (body.velocity_at(origin) - seen_from.velocity_at(origin)),
          frame_from_world * (body.angular_velocity - seen_from.angular_velocity),
          frame_from_world * (body.velocity_of_forces - seen_from.velocity_of_forces),
          frame_from_world * (body.velocity_of_fall - seen_from.velocity_of_fall),
          spin_of(body),
          spin_of(seen_from)};
}

Path::Path(const RelativeMotion& motion, const Vec3& place, double time_step)
    : place_(place), arm_(place - motion.own.center), seen_center_(motion.seen_from.center) {
  const Spin& own = motion.own;
  const Spin& seen = motion.seen_from;
  // Relative velocities at the origin contain what the spins do there.
  const Vec3 of_centers = motion.velocity + cross(own.angular_velocity, own.center) -
                          cross(seen.angular_velocity, seen.center);
  displacement_ = time_step * (of_centers + motion.velocity_of_fall);
  own_axis_ = normalized(own.angular_velocity);
  seen_axis_ = normalized(seen.angular_velocity);
  own_angle_ = time_step * voxshell::length(own.angular_velocity);
  seen_angle_ = time_step * voxshell::length(seen.angular_velocity);
  const double in_the_world =
      voxshell::length(displacement_) + own_angle_ * voxshell::length(cross(own_axis_, arm_));
  const double farthest = voxshell::length(cross(seen_axis_, place - seen.center)) + in_the_world;
  length_ = in_the_world + seen_angle_ * farthest;
}

Vec3 Path::turned_at(double fraction, const Vec3& direction) const {
  return turned(turned(direction, own_axis_, fraction * own_angle_), seen_axis_,
                -fraction * seen_angle_);
}

Vec3 Path::turned_back(double fraction, const Vec3& direction) const {
  return turned(turned(direction, seen_axis_, fraction * seen_angle_), own_axis_,
                -fraction * own_angle_);
}

Vec3 Path::at(double fraction) const {
  if (own_angle_ == 0.0 && seen_angle_ == 0.0) return place_ + fraction * displacement_;
  const Vec3 from_center = (place_ - arm_) - seen_center_ + fraction * displacement_ +
                           turned(arm_, own_axis_, fraction * own_angle_);
  return seen_center_ + turned(from_center, seen_axis_, -fraction * seen_angle_);
}

}  // namespace voxshell::bullet
