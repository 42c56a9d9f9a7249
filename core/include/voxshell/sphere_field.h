#pragma once

#include "voxshell/vector.h"

namespace voxshell {

/// A solid sphere centred at its origin: exact signed distance, negative inside. Metres, body
/// frame.
struct SphereField {
  double radius = 0.5;

  float distance(const Vec3f& p) const { return length(p) - static_cast<float>(radius); }

  /// Unit length; +z at the centre, where no direction is better than another.
  Vec3f gradient(const Vec3f& p) const {
    const Vec3f outwards = normalized(p);
    return outwards == Vec3f{} ? Vec3f{0.0f, 0.0f, 1.0f} : outwards;
  }

  /// No point within `radius` of `centre` has a smaller distance.
  float lower_bound(const Vec3f& centre, float ball_radius) const {
    return distance(centre) - ball_radius;
  }

  /// The largest coordinate that matters to rounding, metres.
  double reach() const { return radius; }
};

}  // namespace voxshell
