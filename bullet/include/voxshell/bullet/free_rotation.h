#pragma once

#include <LinearMath/btMatrix3x3.h>

namespace voxshell::bullet {

/// How a rigid body is turned, and how it turns.
struct Rotation {
  btMatrix3x3 world_from_body;  ///< body frame: principal axes
  btVector3 angular_velocity;   ///< rad/s, world frame
};

/// Turns a body without torques for a time, exactly but for rounding: angular momentum and energy
/// stay as they are.
///
/// @param rotation         At the start.
/// @param inverse_inertia  Principal, 1 / (kg m^2); all above 0.
/// @param time             Seconds.
/// @return False, and `rotation` as it was, where the body turns by more than a whole turn in the
///         time, or its numbers are not finite.
bool rotate_freely(Rotation& rotation, const btVector3& inverse_inertia, btScalar time);

}  // namespace voxshell::bullet
