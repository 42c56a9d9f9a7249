#include "mesh/angle_normals.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

#include "base/portable_math.h"

namespace voxshell {
namespace {

constexpr std::size_t kCorners = 3;
std::size_t next(std::size_t corner) { return corner + 1 == kCorners ? 0 : corner + 1; }

/// How much of the directions around a place of its plane a triangle takes up; 0 where it does not
/// reach the place.
double measure_angle(const std::array<Vec3, 3>& corners, const Vec3& normal, const Vec3& place,
                     double rounding) {
  if (std::abs(dot(place - corners[0], normal)) > rounding) return 0.0;
  for (std::size_t i = 0; i < kCorners; ++i) {
    if (squared_length(place - corners[i]) > rounding * rounding) continue;
    const Vec3 u = corners[next(i)] - corners[i];
    const Vec3 v = corners[next(next(i))] - corners[i];
    return portable_atan2(length(cross(u, v)), dot(u, v));
  }
  double angle = 2.0 * std::numbers::pi;
  for (std::size_t i = 0; i < kCorners; ++i) {
    const Vec3 inward = normalized(cross(normal, corners[next(i)] - corners[i]));
    const double height = dot(place - corners[i], inward);
    if (height < -rounding) return 0.0;
    if (height <= rounding) angle = std::numbers::pi;
  }
  return angle;
}

}  // namespace

double measure_height(const std::array<Vec3, 3>& corners) {
  double longest = 0.0;
  for (std::size_t i = 0; i < kCorners; ++i) {
    longest = std::max(longest, length(corners[next(i)] - corners[i]));
  }
  const double doubled = length(cross(corners[1] - corners[0], corners[2] - corners[0]));
  return doubled > 0.0 ? doubled / longest : 0.0;
}

Vec3 AngleNormals::compute(const Vec3& place) const {
  Bounds box;
  box.extend(place);
  Vec3 sum{};
  finder_.visit(widen(box, rounding_), [&](std::uint32_t triangle) {
    const std::array<Vec3, 3> corners = mesh_.corners(triangle);
    const Vec3 normal = normalized(cross(corners[1] - corners[0], corners[2] - corners[0]));
    // Needles face anywhere, and count as little as they cover of what is within the rounding.
    const double weight = std::min(1.0, measure_height(corners) / rounding_);
    sum += weight * measure_angle(corners, normal, place, rounding_) * normal;
  });
  return sum;
}

}  // namespace voxshell
