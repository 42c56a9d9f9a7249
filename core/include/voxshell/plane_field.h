#pragma once

#include "voxshell/vector.h"

namespace voxshell {

namespace simd {
struct PlaneView;
}

/// The half-space below a plane: signed distance normal . p - offset, negative inside.
/// `normal` is unit length and points out of the solid; meters, body frame.
struct PlaneField {
  Vec3 normal{0.0, 0.0, 1.0};
  double offset = 0.0;

  float distance(const Vec3f& p) const;
  Vec3f gradient(const Vec3f& p) const;

  /// No point within `radius` of `center` has a smaller distance.
  float lower_bound(const Vec3f& center, float radius) const;

  /// The largest coordinate that matters to rounding, meters.
  double reach() const;

  simd::PlaneView view() const;
};

}  // namespace voxshell
