#pragma once

#include <cmath>

#include "motion.h"
#include "voxshell/pose.h"

namespace voxshell::bullet {

/// No place within a radius of `middle` moves farther from one pose to the other, meters.
inline double bound_displacement(const Pose& from, const Pose& to, const Vec3& middle,
                                 double radius) {
  const double turn = std::sqrt(squared_length(to.rotation.row_x - from.rotation.row_x) +
                                squared_length(to.rotation.row_y - from.rotation.row_y) +
                                squared_length(to.rotation.row_z - from.rotation.row_z));
  // The Frobenius norm is at least the spectral one.
  return length(to.transform_point(middle) - from.transform_point(middle)) + turn * radius;
}

/// No velocity within a radius of `middle` differs by more between two motions, m/s.
inline double bound_difference(const RelativeMotion& from, const RelativeMotion& to,
                               const Vec3& middle, double radius) {
  return length(to.velocity_at(middle) - from.velocity_at(middle)) +
         length(to.angular_velocity - from.angular_velocity) * radius +
         length(to.velocity_of_fall - from.velocity_of_fall);
}

}  // namespace voxshell::bullet
