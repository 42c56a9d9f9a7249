#include "mesh/ray_winding.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "mesh/closest_point.h"

namespace voxshell {
namespace {

constexpr double kRounding = 1e-9;  // of the longest side

/// Rays run along a direction that edges and faces of meshes hardly ever have. The map need not be
/// a rotation: none that keeps the handedness changes how often a place is enclosed.
Vec3 turn(const Vec3& p) {
  return {0.7123 * p.x + 0.5471 * p.y + 0.4399 * p.z, -0.6084 * p.x + 0.7935 * p.y + 0.0173 * p.z,
          -0.3496 * p.x - 0.2663 * p.y + 0.8983 * p.z};
}

/// How an edge from `a` to `b` counts toward the turns around a place as seen along x: 1 or -1
/// where it passes the half plane of larger y upward or downward, in z. The edge in the other
/// direction counts as the negative of it, whatever the rounding.
int pass(const Vec3& a, const Vec3& b, const Vec3& p) {
  const bool is_above = a.z > p.z;
  if (is_above == (b.z > p.z)) return 0;
  const double side = (b.y - a.y) * (p.z - a.z) - (b.z - a.z) * (p.y - a.y);
  if (is_above) return side < 0.0 ? -1 : 0;
  return side > 0.0 ? 1 : 0;
}

}  // namespace

std::vector<RayWinding::Facet> RayWinding::turn_triangles(const TriangleMesh& mesh) {
  const Vec3 center = mesh.bounds().center();
  std::vector<Facet> facets;
  facets.reserve(mesh.triangles().size());
  for (Triangle t : mesh.triangles()) {
    int sign = 1;
    const auto sort = [&](std::size_t i, std::size_t j) {
      if (t[i] < t[j]) return;
      std::swap(t[i], t[j]);
      sign = -sign;
    };
    sort(0, 1);
    sort(1, 2);
    sort(0, 1);
    const auto at = [&](std::uint32_t v) { return turn(mesh.vertices()[v] - center); };
    const Vec3 a = at(t[0]);
    const Vec3 b = at(t[1]);
    const Vec3 c = at(t[2]);
    facets.push_back({{a, b, c}, normalized(cross(b - a, c - a)), sign});
  }
  return facets;
}

RayWinding::RayWinding(const TriangleMesh& mesh)
    : center_(mesh.bounds().center()), facets_(turn_triangles(mesh)), finder_([&] {
        std::vector<Bounds> boxes;
        boxes.reserve(facets_.size());
        for (const Facet& facet : facets_) boxes.push_back(bound_triangle(facet.corners));
        return boxes;
      }()) {
  for (const Facet& facet : facets_) {
    for (const Vec3& corner : facet.corners) bounds_.extend(corner);
  }
  rounding_ = kRounding * bounds_.extents()[bounds_.longest_axis()];
}

/// How often it runs around a place as seen along x: 1, -1 or 0.
int RayWinding::Facet::encircle(const Vec3& p) const {
  const auto& [a, b, c] = corners;
  return pass(a, b, p) + pass(b, c, p) - pass(a, c, p);
}

std::optional<std::array<int, 2>> RayWinding::compute(const std::array<Vec3, 2>& places,
                                                      std::size_t& steps) const {
  const std::array<Vec3, 2> p{turn(places[0] - center_), turn(places[1] - center_)};
  Bounds box;
  for (const Vec3& place : p) box.extend(place);
  box = widen(box, rounding_);
  // A line leaves a mesh as often as it enters it, so both ways give the same number. This one is
  // shorter.
  const bool is_ahead = box.lower.x + box.upper.x > bounds_.lower.x + bounds_.upper.x;
  if (is_ahead) {
    box.upper.x = std::max(box.upper.x, bounds_.upper.x);
  } else {
    box.lower.x = std::min(box.lower.x, bounds_.lower.x);
  }
  std::array<int, 2> numbers{};
  bool is_on_surface = false;
  finder_.visit(box, [&](std::uint32_t i) {
    const Facet& facet = facets_[i];
    ++steps;
    for (std::size_t k = 0; k < p.size(); ++k) {
      const double height = dot(p[k] - facet.corners[0], facet.normal);
      if (std::abs(height) <= rounding_) {
        const Vec3 closest = closest_point_on_triangle(p[k], facet.corners);
        if (squared_length(closest - p[k]) <= rounding_ * rounding_) is_on_surface = true;
      }
      const int turns = facet.encircle(p[k]);
      // Of what faces along x, the body is on the side of smaller x.
      const double above = turns * height;
      if (is_ahead ? above < 0.0 : above > 0.0) {
        numbers[k] += is_ahead ? facet.sign * turns : -facet.sign * turns;
      }
    }
  });
  if (is_on_surface) return std::nullopt;
  return numbers;
}

}  // namespace voxshell
