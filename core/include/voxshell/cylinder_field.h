#pragma once

#include "voxshell/vector.h"

namespace voxshell {

namespace simd {
struct CylinderView;
}

/// A solid cylinder along z, centered at its origin: exact signed distance, negative inside.
/// Meters, body frame.
struct CylinderField {
  double radius = 0.5;
  double length = 1.0;

  float distance(const Vec3f& p) const;

  /// Unit length. Inside, it is the nearest face's normal; the side's, and +x on the axis, where
  /// they tie.
  Vec3f gradient(const Vec3f& p) const;

  /// No point within `ball_radius` of `center` has a smaller distance.
  float lower_bound(const Vec3f& center, float ball_radius) const;

  /// The largest coordinate that matters to rounding, meters.
  double reach() const;

  simd::CylinderView view() const;
};

}  // namespace voxshell
