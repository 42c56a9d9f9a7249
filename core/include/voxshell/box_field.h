#pragma once

#include "voxshell/vector.h"

namespace voxshell {

namespace simd {
struct BoxView;
}

/// A solid box centered at its origin: exact signed distance, negative inside. Meters, body frame.
struct BoxField {
  Vec3 half_extents{0.5, 0.5, 0.5};

  float distance(const Vec3f& p) const;

  /// Unit length. Inside, it is the nearest face's normal; x before y before z where they tie.
  Vec3f gradient(const Vec3f& p) const;

  /// No point within `radius` of `center` has a smaller distance.
  float lower_bound(const Vec3f& center, float radius) const;

  /// The largest coordinate that matters to rounding, meters.
  double reach() const;

  simd::BoxView view() const;
};

}  // namespace voxshell
