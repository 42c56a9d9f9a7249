#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include "ball.h"
#include "voxshell/pose.h"

namespace voxshell::bullet {

/// How a body moves at the start of a step, as Bullet's solver is about to see it. World frame.
struct Motion {
  Vec3 centre;                ///< a point of the body
  Vec3 velocity;              ///< of that point, m/s
  Vec3 angular_velocity;      ///< rad/s
  Vec3 velocity_of_forces;    ///< what gravity and other forces add to it in the step, m/s
  double inverse_mass = 0.0;  ///< 1/kg; 0 where it does not move, or is a link of a multibody
  Matrix3 inverse_inertia{{}, {}, {}};  ///< about the point, 1/(kg m^2); likewise
  bool is_link = false;  ///< of a multibody, whose solver adds what forces do beforehand

  /// At rest where the object has no velocity of its own.
  static Motion of(const btCollisionObject& object, double time_step);

  Vec3 velocity_at(const Vec3& world_point) const {
    return velocity + cross(angular_velocity, world_point - centre);
  }

  /// After an impulse at a place, N s.
  Motion pushed(const Vec3& impulse, const Vec3& at) const {
    Motion after = *this;
    after.velocity = velocity + inverse_mass * impulse;
    after.angular_velocity = angular_velocity + inverse_inertia * cross(at - centre, impulse);
    return after;
  }

  /// Where something of the body that is at `world_from_x` is after a fraction of the step.
  Pose moved(const Pose& world_from_x, double fraction, double time_step) const;
};

/// No place of a ball that one of the bodies is in moves farther in the step, as the other sees it,
/// metres.
double find_farthest_displacement(const Motion& a, const Motion& b, const Ball& ball,
                                  double time_step);

/// The same, also if something else stops one of the bodies.
double find_farthest_if_stopped(const Motion& a, const Motion& b, const Ball& ball,
                                double time_step);

/// Places of the two bodies that are farther apart do not touch within the step, even if something
/// else stops one of the bodies. Metres.
double find_touch_reach(const Motion& a, const Motion& b, const Ball& ball, double time_step);

/// How one body moves as another sees it. Any frame: its own, that of one of them or the world's.
struct RelativeMotion {
  Vec3 velocity;            ///< at the frame's origin, m/s
  Vec3 angular_velocity;    ///< rad/s
  Vec3 velocity_of_forces;  ///< as of Motion

  static RelativeMotion of(const Motion& body, const Motion& seen_from,
                           const Pose& world_from_frame);

  Vec3 velocity_at(const Vec3& point) const { return velocity + cross(angular_velocity, point); }
};

}  // namespace voxshell::bullet
