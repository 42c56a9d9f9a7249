#include "motion.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include "contact_constants.h"
#include "voxshell/bullet/convert.h"

namespace voxshell::bullet {
namespace {

/// What its own force alone would add to a link's velocity: joints are left out.
Vec3 velocity_of_force(const btMultiBody& body, int link, double time_step) {
  const bool is_base = link < 0;
  if (is_base && body.hasFixedBase()) return {};
  const auto mass = static_cast<double>(is_base ? body.getBaseMass() : body.getLinkMass(link));
  if (!(mass > 0.0)) return {};
  return (time_step / mass) * from_bullet(is_base ? body.getBaseForce() : body.getLinkForce(link));
}

Motion of_link(const btMultiBodyLinkCollider& collider, double time_step) {
  const btMultiBody& body = *collider.m_multiBody;
  // Kept from step to step, as settled ones take no memory.
  thread_local std::vector<btVector3> angular;
  thread_local std::vector<btVector3> linear;
  const auto count = static_cast<std::size_t>(body.getNumLinks()) + 1;
  angular.resize(count);
  linear.resize(count);
  body.compTreeLinkVelocities(angular.data(), linear.data());
  const btTransform& world_from_link = collider.getWorldTransform();
  const int place = collider.m_link + 1;  // the base is the first
  const auto link = static_cast<std::size_t>(place);
  return {from_bullet(world_from_link.getOrigin()),
          from_bullet(world_from_link.getBasis() * linear[link]),
          from_bullet(world_from_link.getBasis() * angular[link]),
          velocity_of_force(body, collider.m_link, time_step),
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
  return {from_bullet(body->getCenterOfMassPosition()),
          from_bullet(body->getLinearVelocity()),
          from_bullet(body->getAngularVelocity()),
          time_step * inverse_mass * from_bullet(body->getTotalForce()),
          inverse_mass,
          {from_bullet(inertia[0]), from_bullet(inertia[1]), from_bullet(inertia[2])}};
}

Pose Motion::moved(const Pose& world_from_x, double fraction, double time_step) const {
  const Vec3 turn = fraction * time_step * angular_velocity;
  const double angle = length(turn);
  const Vec3 axis = normalized(turn);
  const auto turned = [&](const Vec3& v) {  // Rodrigues' formula
    return std::cos(angle) * v + std::sin(angle) * cross(axis, v) +
           (1.0 - std::cos(angle)) * dot(axis, v) * axis;
  };
  const Matrix3 columns = world_from_x.rotation.transposed();
  const Matrix3 rotation =
      Matrix3{turned(columns.row_x), turned(columns.row_y), turned(columns.row_z)}.transposed();
  const Vec3 displacement = fraction * time_step * (velocity + velocity_of_forces);
  return {rotation, centre + displacement + turned(world_from_x.translation - centre)};
}

double find_farthest_displacement(const Motion& a, const Motion& b, const Ball& ball,
                                  double time_step) {
  // The relative velocity is affine in the place.
  const Vec3 of_centre = a.velocity_at(ball.centre) + a.velocity_of_forces -
                         b.velocity_at(ball.centre) - b.velocity_of_forces;
  const double of_spin = length(a.angular_velocity - b.angular_velocity) * ball.radius;
  return (length(of_centre) + of_spin) * time_step;
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
  return {frame_from_world * (body.velocity_at(origin) - seen_from.velocity_at(origin)),
          frame_from_world * (body.angular_velocity - seen_from.angular_velocity),
          frame_from_world * (body.velocity_of_forces - seen_from.velocity_of_forces)};
}

}  // namespace voxshell::bullet
