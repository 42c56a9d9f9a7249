#pragma once

#include "voxshell/vector.h"

namespace voxshell {

namespace simd {
struct ConeView;
}

/// A solid cone about z, its base at z = -height / 2 and its apex at height / 2: exact signed
/// distance, negative inside. Meters, body frame.
struct ConeField {
  double radius = 0.5;  ///< of the base
  double height = 1.0;

  float distance(const Vec3f& p) const;

  /// Unit length. Inside, it is the nearest face's normal; the slant's, and that toward +x on the
  /// axis, where they tie.
  Vec3f gradient(const Vec3f& p) const;

  /// No point within `ball_radius` of `center` has a smaller distance.
  float lower_bound(const Vec3f& center, float ball_radius) const;

  /// The largest coordinate that matters to rounding, meters.
  double reach() const;

  simd::ConeView view() const;
};

}  // namespace voxshell
