#pragma once

#include <algorithm>
#include <limits>

#include "voxshell/vector.h"

namespace voxshell {

/// An axis-aligned box, both corners included. Empty (lower > upper) until extended.
struct Bounds {
  Vec3 lower{kInfinity, kInfinity, kInfinity};
  Vec3 upper{-kInfinity, -kInfinity, -kInfinity};

  void extend(const Vec3& p) {
    lower = {std::min(lower.x, p.x), std::min(lower.y, p.y), std::min(lower.z, p.z)};
    upper = {std::max(upper.x, p.x), std::max(upper.y, p.y), std::max(upper.z, p.z)};
  }
  void extend(const Bounds& b) {
    extend(b.lower);
    extend(b.upper);
  }
  Vec3 extents() const { return upper - lower; }
  Vec3 center() const { return 0.5 * (lower + upper); }
  int longest_axis() const {
    const Vec3 e = extents();
    return e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
  }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
};

/// Squared distance from `p` to the box, 0 inside it.
inline double squared_distance(const Bounds& box, const Vec3& p) {
  const Vec3 outside{std::max({box.lower.x - p.x, 0.0, p.x - box.upper.x}),
                     std::max({box.lower.y - p.y, 0.0, p.y - box.upper.y}),
                     std::max({box.lower.z - p.z, 0.0, p.z - box.upper.z})};
  return squared_length(outside);
}

}  // namespace voxshell
