#include "field/flat_regions.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace voxshell {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

/// For side i of triangle t, at 3 t + i, the other triangle of an edge that has two.
std::vector<std::uint32_t> find_neighbors(const TriangleMesh& mesh) {
  const auto triangles = mesh.triangles();
  std::vector<std::uint32_t> first(mesh.vertices().size() + 1, 0);
  const auto low_end = [&](std::size_t side) {
    const Triangle& t = triangles[side / 3];
    return std::min(t[side % 3], t[(side + 1) % 3]);
  };
  const auto high_end = [&](std::size_t side) {
    const Triangle& t = triangles[side / 3];
    return std::max(t[side % 3], t[(side + 1) % 3]);
  };
  const std::size_t sides = 3 * triangles.size();
  for (std::size_t side = 0; side < sides; ++side) ++first[low_end(side) + 1];
  for (std::size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
  std::vector<std::uint32_t> by_vertex(sides);
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  for (std::size_t side = 0; side < sides; ++side) {
    by_vertex[next[low_end(side)]++] = static_cast<std::uint32_t>(side);
  }
  std::vector<std::uint32_t> neighbors(sides, kNone);
  for (std::size_t v = 0; v + 1 < first.size(); ++v) {
    const auto begin = by_vertex.begin() + first[v];
    const auto end = by_vertex.begin() + first[v + 1];
    std::sort(begin, end, [&](std::uint32_t a, std::uint32_t b) {
      return high_end(a) != high_end(b) ? high_end(a) < high_end(b) : a < b;
    });
    for (auto a = begin; a != end;) {
      auto b = a + 1;
      while (b != end && high_end(*b) == high_end(*a)) ++b;
      if (b - a == 2) {
        neighbors[a[0]] = a[1] / 3;
        neighbors[a[1]] = a[0] / 3;
      }
      a = b;
    }
  }
  return neighbors;
}

}  // namespace

FlatRegions::FlatRegions(const TriangleMesh& mesh, double tolerance)
    : mesh_(mesh), regions_(mesh.triangles().size(), kNone), rims_(mesh.triangles().size(), 0) {
  const std::vector<std::uint32_t> neighbors = find_neighbors(mesh);
  const auto sides_of = [&](std::uint32_t triangle) {
    return neighbors.data() + std::size_t{3} * triangle;
  };
  const auto count = static_cast<std::uint32_t>(mesh.triangles().size());
  std::vector<Vec3> doubled(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto [a, b, c] = mesh.corners(i);
    doubled[i] = cross(b - a, c - a);
  }
  const auto lies_on = [&](std::uint32_t triangle, const Plane& plane) {
    if (dot(doubled[triangle], plane.normal) < 0.0) return false;
    for (const Vec3& corner : mesh.corners(triangle)) {
      if (!(std::abs(dot(plane.normal, corner) - plane.offset) <= tolerance)) return false;
    }
    return true;
  };
  const auto plane_of = [&](std::uint32_t triangle) {
    const Vec3 normal = normalized(doubled[triangle]);
    return Plane{normal, dot(normal, mesh.corners(triangle)[0])};
  };
  // Those with a neighbor in their plane come first, the largest in front: its plane is the most
  // exact.
  std::vector<std::uint32_t> seeds;
  std::vector<std::uint32_t> alone;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Plane plane = plane_of(i);
    const bool has_flat_side = std::any_of(sides_of(i), sides_of(i) + 3, [&](std::uint32_t other) {
      return other != kNone && lies_on(other, plane);
    });
    (has_flat_side ? seeds : alone).push_back(i);
  }
  std::sort(seeds.begin(), seeds.end(), [&](std::uint32_t a, std::uint32_t b) {
    const double area_a = squared_length(doubled[a]);
    const double area_b = squared_length(doubled[b]);
    return area_a != area_b ? area_a > area_b : a < b;
  });
  seeds.insert(seeds.end(), alone.begin(), alone.end());
  std::vector<std::uint32_t> waiting;
  for (const std::uint32_t seed : seeds) {
    if (regions_[seed] != kNone) continue;
    const auto region = static_cast<std::uint32_t>(planes_.size());
    const Plane plane = plane_of(seed);
    planes_.push_back(plane);
    regions_[seed] = region;
    waiting.push_back(seed);
    while (!waiting.empty()) {
      const std::uint32_t triangle = waiting.back();
      waiting.pop_back();
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t other = sides_of(triangle)[i];
        if (other == kNone || regions_[other] != kNone || !lies_on(other, plane)) continue;
        regions_[other] = region;
        waiting.push_back(other);
      }
    }
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    for (std::size_t side = 0; side < 3; ++side) {
      const std::uint32_t other = sides_of(i)[side];
      if (other == kNone || regions_[other] != regions_[i]) {
        rims_[i] = static_cast<std::uint8_t>(rims_[i] | 1u << side);
      }
    }
  }
}

bool FlatRegions::spans_cube(std::span<const std::uint32_t> triangles, const Vec3& center,
                             double half_edge) const {
  if (triangles.empty()) return false;
  const std::uint32_t region = regions_[triangles[0]];
  for (const std::uint32_t triangle : triangles) {
    if (regions_[triangle] != region) return false;
  }
  const Vec3& normal = planes_[region].normal;
  // Separating axes between the shadow of the cube on the plane and a side at the rim.
  std::array<Vec3, 3> shadow_axes;
  for (int i = 0; i < 3; ++i) {
    Vec3 axis{};
    axis[i] = 1.0;
    shadow_axes[static_cast<std::size_t>(i)] = cross(normal, axis);
  }
  const auto is_apart = [&](const Vec3& axis, const Vec3& a, const Vec3& b) {
    const double half = half_edge * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
    const double from_a = dot(axis, a - center);
    const double from_b = dot(axis, b - center);
    return std::min(from_a, from_b) > half || std::max(from_a, from_b) < -half;
  };
  for (const std::uint32_t triangle : triangles) {
    if (rims_[triangle] == 0) continue;
    const auto corners = mesh_.corners(triangle);
    for (std::size_t side = 0; side < 3; ++side) {
      if ((rims_[triangle] >> side & 1) == 0) continue;
      const Vec3& a = corners[side];
      const Vec3& b = corners[(side + 1) % 3];
      const bool apart = is_apart(cross(normal, b - a), a, b) ||
                         std::any_of(shadow_axes.begin(), shadow_axes.end(),
                                     [&](const Vec3& axis) { return is_apart(axis, a, b); });
      if (!apart) return false;
    }
  }
  return true;
}

}  // namespace voxshell
