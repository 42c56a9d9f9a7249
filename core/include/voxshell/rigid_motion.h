#pragma once

#include "voxshell/pose.h"

namespace voxshell {

/// A body's motion from fraction 0 to fraction 1: the origin of its frame moves at a constant
/// velocity, and the body turns about it at a constant angular velocity.
struct RigidMotion {
  Pose start;         ///< world_from_body
  Vec3 displacement;  ///< of the frame's origin, meters, the world's frame
  Vec3 turn;          ///< along the axis, radians, the world's frame

  /// The motion that turns least: by at most half a turn. For exactly half a turn, both directions
  /// are equally short; the result has the axis whose first nonzero component is positive.
  static RigidMotion between(const Pose& start, const Pose& end);

  /// The pose at a fraction, with the same bits on every processor. Turns may be up to 1e5 radians.
  Pose at(double fraction) const;
};

}  // namespace voxshell
