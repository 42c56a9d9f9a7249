#pragma once

#include "voxshell/vector.h"

namespace voxshell {

/// The half-space below a plane: signed distance normal . p - offset, negative inside.
/// `normal` is unit length and points out of the solid; metres, body frame.
struct PlaneField {
  Vec3 normal{0.0, 0.0, 1.0};
  double offset = 0.0;

  float distance(const Vec3f& p) const {
    return dot(static_cast<Vec3f>(normal), p) - static_cast<float>(offset);
  }
  Vec3f gradient(const Vec3f&) const { return static_cast<Vec3f>(normal); }

  /// No point within `radius` of `centre` has a smaller distance.
  float lower_bound(const Vec3f& centre, float radius) const { return distance(centre) - radius; }

  /// The largest coordinate that matters to rounding, metres.
  double reach() const { return offset < 0.0 ? -offset : offset; }
};

}  // namespace voxshell
