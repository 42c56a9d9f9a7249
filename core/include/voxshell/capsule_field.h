#pragma once

#include "voxshell/vector.h"

namespace voxshell {

namespace simd {
struct CapsuleView;
}

/// A solid cylinder along z with half a sphere on each end, centered at its origin: exact signed
/// distance, negative inside. Meters, body frame.
struct CapsuleField {
  double radius = 0.5;
  double length = 1.0;  ///< without the caps: between the centers of the half-spheres

  float distance(const Vec3f& p) const;

  /// Unit length; +x on the axis, where all directions are equal.
  Vec3f gradient(const Vec3f& p) const;

  /// No point within `ball_radius` of `center` has a smaller distance.
  float lower_bound(const Vec3f& center, float ball_radius) const;

  /// The largest coordinate that matters to rounding, meters.
  double reach() const;

  simd::CapsuleView view() const;
};

}  // namespace voxshell
