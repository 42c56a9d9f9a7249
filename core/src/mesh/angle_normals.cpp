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

}  // namespace

double measure_height(const std::array<Vec3, 3>& corners) {
  double longest = 0.0;
  for (std::size_t i = 0; i < kCorners; ++i) {
    longest = std::max(longest, length(corners[next(i)] - corners[i]));
  }
  const double doubled = length(cross(corners[1] - corners[0], corners[2] - corners[0]));
  return doubled > 0.0 ? doubled / longest : 0.0;
}

AngleNormals::AngleNormals(const TriangleMesh& mesh, double rounding)
    : rounding_(rounding), finder_(bound_triangles(mesh)) {
  facets_.reserve(mesh.triangles().size());
  for (std::size_t triangle = 0; triangle < mesh.triangles().size(); ++triangle) {
    Facet facet{.corners = mesh.corners(triangle), .normal{}, .weight = 0.0, .inwards{}, .angles{}};
    const auto& corners = facet.corners;
    facet.normal = normalized(cross(corners[1] - corners[0], corners[2] - corners[0]));
    // As little as it covers of what is within the rounding.
    facet.weight = std::min(1.0, measure_height(corners) / rounding);
    for (std::size_t i = 0; i < kCorners; ++i) {
      const Vec3 u = corners[next(i)] - corners[i];
      const Vec3 v = corners[next(next(i))] - corners[i];
      facet.inwards[i] = normalized(cross(facet.normal, u));
      facet.angles[i] = portable_atan2(length(cross(u, v)), dot(u, v));
    }
    facets_.push_back(facet);
  }
}

/// How much of the directions around a place of its plane it takes up; 0 where it does not reach
/// the place.
double AngleNormals::Facet::measure_angle(const Vec3& place, double rounding) const {
  if (std::abs(dot(place - corners[0], normal)) > rounding) return 0.0;
  for (std::size_t i = 0; i < kCorners; ++i) {
    if (squared_length(place - corners[i]) <= rounding * rounding) return angles[i];
  }
  double angle = 2.0 * std::numbers::pi;
  for (std::size_t i = 0; i < kCorners; ++i) {
    const double height = dot(place - corners[i], inwards[i]);
    if (height < -rounding) return 0.0;
    if (height <= rounding) angle = std::numbers::pi;
  }
  return angle;
}

/// Its part in the normal of a place.
Vec3 AngleNormals::Facet::weigh(const Vec3& place, double rounding) const {
  return weight * measure_angle(place, rounding) * normal;
}

Vec3 AngleNormals::compute(const Vec3& place) const {
  Vec3 sum{};
  finder_.visit(widen({place, place}, rounding_),
                [&](std::uint32_t triangle) { sum += facets_[triangle].weigh(place, rounding_); });
  return sum;
}

void AngleNormals::compute(std::span<const Vec3> places, std::size_t group,
                           std::span<Vec3> normals) const {
  if (compute_together(places, normals)) return;
  const bool is_group = places.size() <= group;
  const std::size_t each = is_group ? 1 : group;
  for (std::size_t first = 0; first < places.size(); first += each) {
    if (is_group) {
      normals[first] = compute(places[first]);
    } else {
      const std::size_t count = std::min(each, places.size() - first);
      compute(places.subspan(first, count), group, normals.subspan(first, count));
    }
  }
}

/// With one search for all of them. False where the places are so far apart that what is between
/// them is more than what is around each.
bool AngleNormals::compute_together(std::span<const Vec3> places, std::span<Vec3> normals) const {
  Bounds around;
  for (const Vec3& place : places) around.extend(place);
  constexpr std::size_t kMost = 512;
  std::vector<std::uint32_t> near;
  if (!finder_.find(widen(around, rounding_), kMost, near)) return false;
  std::vector<Bounds> boxes(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    boxes[i] = widen({places[i], places[i]}, rounding_);
    normals[i] = {};
  }
  // Each place adds up triangles in the order in which it would find them alone.
  for (const std::uint32_t triangle : near) {
    const Facet& facet = facets_[triangle];
    const Bounds& box = finder_.box(triangle);
    for (std::size_t i = 0; i < places.size(); ++i) {
      if (do_meet(boxes[i], box)) normals[i] += facet.weigh(places[i], rounding_);
    }
  }
  return true;
}

}  // namespace voxshell
