#pragma once

#include <LinearMath/btMatrix3x3.h>

namespace voxshell::bullet {

/// Orientation and angular velocity of a rigid body.
struct Rotation {
  btMatrix3x3 world_from_body;  ///< body frame: principal axes
  btVector3 angular_velocity;   ///< rad/s, world frame
};

/// Turns a body without torques for a time. Exact except for rounding: angular momentum and energy
/// do not change.
///
/// @param rotation         At the start.
/// @param inverse_inertia  Principal, 1 / (kg m^2); all above 0.
/// @param time             Seconds.
/// @return False, with `rotation` unchanged, if the body turns by more than a whole turn in the
///         time, or if its numbers are not finite.
bool rotate_freely(Rotation& rotation, const btVector3& inverse_inertia, btScalar time);

}  // namespace voxshell::bullet
