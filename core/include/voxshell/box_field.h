#pragma once

#include <algorithm>
#include <cmath>

#include "voxshell/vector.h"

namespace voxshell {

/// A solid box centred at its origin: exact signed distance, negative inside. Metres, body frame.
struct BoxField {
  Vec3 half_extents{0.5, 0.5, 0.5};

  float distance(const Vec3f& p) const {
    const Vec3f q = beyond_faces(p);
    const Vec3f outside{std::max(q.x, 0.0f), std::max(q.y, 0.0f), std::max(q.z, 0.0f)};
    return length(outside) + std::min(std::max({q.x, q.y, q.z}), 0.0f);
  }

  /// Unit length. Inside, it is the nearest face's normal; x before y before z where they tie.
  Vec3f gradient(const Vec3f& p) const {
    const Vec3f q = beyond_faces(p);
    if (std::max({q.x, q.y, q.z}) > 0.0f) {
      return normalized(Vec3f{std::copysign(std::max(q.x, 0.0f), p.x),
                              std::copysign(std::max(q.y, 0.0f), p.y),
                              std::copysign(std::max(q.z, 0.0f), p.z)});
    }
    if (q.x >= q.y && q.x >= q.z) return {std::copysign(1.0f, p.x), 0.0f, 0.0f};
    if (q.y >= q.z) return {0.0f, std::copysign(1.0f, p.y), 0.0f};
    return {0.0f, 0.0f, std::copysign(1.0f, p.z)};
  }

  /// No point within `radius` of `centre` has a smaller distance.
  float lower_bound(const Vec3f& centre, float radius) const { return distance(centre) - radius; }

  /// The largest coordinate that matters to rounding, metres.
  double reach() const { return length(half_extents); }

 private:
  Vec3f beyond_faces(const Vec3f& p) const {
    const auto h = static_cast<Vec3f>(half_extents);
    return {std::abs(p.x) - h.x, std::abs(p.y) - h.y, std::abs(p.z) - h.z};
  }
};

}  // namespace voxshell
