#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include "ball.h"
#include "support.h"
#include "voxshell/pose.h"

namespace voxshell::bullet {

/// How a body moves at the start of a step, as Bullet's solver is about to see it. World frame.
struct Motion {
  Vec3 center;                ///< a point of the body
  Vec3 velocity;              ///< of that point, m/s
  Vec3 angular_velocity;      ///< rad/s
  Vec3 velocity_of_forces;    ///< what gravity and other forces add to it in the step, m/s
  Vec3 velocity_of_fall;      ///< the same, or 0 where contacts support the body, m/s
  double inverse_mass = 0.0;  ///< 1/kg; 0 where it does not move, or is a link of a multibody
  Matrix3 inverse_inertia{{}, {}, {}};  ///< about the point, 1/(kg m^2); likewise
  bool is_link = false;  ///< of a multibody, whose solver adds what forces do beforehand

  /// At rest where the object has no velocity of its own. Nothing supports it.
  static Motion of(const btCollisionObject& object, double time_step);

  /// Whether contacts support the body: forces do not move it if contacts do what they did in the
  /// last step.
  /// @param radius  Of the body, meters.
  bool is_supported(const Support::Push& by_contacts, double radius) const;

  Vec3 velocity_at(const Vec3& world_point) const {
    return velocity + cross(angular_velocity, world_point - center);
  }

  /// After an impulse at a place, N s.
  Motion pushed(const Vec3& impulse, const Vec3& at) const {
    Motion after = *this;
    after.velocity = velocity + inverse_mass * impulse;
    after.angular_velocity = angular_velocity + inverse_inertia * cross(at - center, impulse);
    return after;
  }

  /// Where something of the body that is at `world_from_x` is after a fraction of the step.
  Pose moved(const Pose& world_from_x, double fraction, double time_step) const;
};

/// No place of a ball that one of the bodies is in moves farther in the step, as the other sees it,
/// meters.
double find_farthest_displacement(const Motion& a, const Motion& b, const Ball& ball,
                                  double time_step);

/// The same, also if something else stops one of the bodies.
double find_farthest_if_stopped(const Motion& a, const Motion& b, const Ball& ball,
                                double time_step);

/// Places of the two bodies that are farther apart do not touch within the step, even if something
/// else stops one of the bodies. Meters.
double find_touch_reach(const Motion& a, const Motion& b, const Ball& ball, double time_step);

/// The point that a body turns about, and how fast.
struct Spin {
  Vec3 center;
  Vec3 angular_velocity;  ///< rad/s
};

/// How one body moves as another sees it. Any frame: its own, that of one of them or the world's.
struct RelativeMotion {
  Vec3 velocity;            ///< at the frame's origin, m/s
  Vec3 angular_velocity;    ///< rad/s
  Vec3 velocity_of_forces;  ///< as of Motion
  Vec3 velocity_of_fall;    ///< likewise
  Spin own;                 ///< of the body
  Spin seen_from;           ///< of the other one

  static RelativeMotion of(const Motion& body, const Motion& seen_from,
                           const Pose& world_from_frame);

  Vec3 velocity_at(const Vec3& point) const { return velocity + cross(angular_velocity, point); }
  /// How the other body moves as this one sees it.
  RelativeMotion reversed() const {
    return {-velocity, -angular_velocity, -velocity_of_forces, -velocity_of_fall, seen_from, own};
  }
  /// The same if the body did not turn: how the place of a ball moves that faces something.
  RelativeMotion unspun() const {
    return {velocity + cross(own.angular_velocity, own.center),
            angular_velocity - own.angular_velocity,
            velocity_of_forces,
            velocity_of_fall,
            {own.center, {}},
            seen_from};
  }
};

/// The path of a place of a body, as another one sees it, if nothing stops them: each body turns
/// about its own center. The place of a ball that will touch the ground as it rolls comes down on
/// an arc; straight on, it would be below the ground.
class Path {
 public:
  Path(const RelativeMotion& motion, const Vec3& place, double time_step);

  /// After a fraction of the step, in the frame that the other body has at the start.
  Vec3 at(double fraction) const;
  /// Where a direction of the body points then.
  Vec3 turned_at(double fraction, const Vec3& direction) const;
  /// Which direction of the body will point in a direction then.
  Vec3 turned_back(double fraction, const Vec3& direction) const;
  /// The path is not longer than that, meters.
  double length() const { return length_; }

 private:
  Vec3 place_;
  Vec3 displacement_;  ///< of one center as the other sees it
  Vec3 arm_;           ///< from the center to the place
  Vec3 seen_center_;
  Vec3 own_axis_;
  Vec3 seen_axis_;
  double own_angle_;  ///< radians
  double seen_angle_;
  double length_;
};

}  // namespace voxshell::bullet
