#pragma once

#include "voxshell/vector.h"

namespace voxshell {

namespace simd {
struct SphereView;
}

/// A solid sphere centered at its origin: exact signed distance, negative inside. Meters, body
/// frame.
struct SphereField {
  double radius = 0.5;

  float distance(const Vec3f& p) const;

  /// Unit length; +z at the center, where all directions are equal.
  Vec3f gradient(const Vec3f& p) const;

  /// No point within `ball_radius` of `center` has a smaller distance.
  float lower_bound(const Vec3f& center, float ball_radius) const;

  /// The largest coordinate that matters to rounding, meters.
  double reach() const;

  simd::SphereView view() const;
};

}  // namespace voxshell
