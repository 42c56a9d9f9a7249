#pragma once

#include "voxshell/pose.h"

namespace voxshell {

/// A body's motion from fraction 0 to fraction 1: the origin of its frame moves at a constant
/// velocity, and the body turns about it at a constant angular velocity.
struct RigidMotion {
  Pose start;         ///< world_from_body
  Vec3 displacement;  ///< of the frame's origin, metres, the world's frame
  Vec3 turn;          ///< along the axis, radians, the world's frame

  /// The motion that turns least: by at most half a turn. Of exactly half a turn either direction
  /// is as short; it is the one whose axis has a positive first component that is not zero.
  static RigidMotion between(const Pose& start, const Pose& end);

  /// Where it is at a fraction: the same bits on every processor. Turns up to 1e5 radians.
  Pose at(double fraction) const;
};

}  // namespace voxshell
