#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// Shares `count` places out over items by their weights, which are not negative: as evenly as
/// whole numbers allow, ascending. `weight(i)` of item i.
template <class Weight>
std::vector<std::uint32_t> share_out(std::size_t items, std::size_t count, const Weight& weight) {
  double total = 0.0;
  for (std::size_t i = 0; i < items; ++i) total += weight(i);
  std::vector<std::uint32_t> taken;
  if (!(total > 0.0)) return taken;
  taken.reserve(count);
  const double step = total / static_cast<double>(count);
  double sum = 0.0;
  for (std::size_t i = 0; i < items; ++i) {
    sum += weight(i);
    while (taken.size() < count && (static_cast<double>(taken.size()) + 0.5) * step < sum) {
      taken.push_back(static_cast<std::uint32_t>(i));
    }
  }
  return taken;
}

/// The triangles of `count` places that are spread evenly over the mesh's area, ascending.
inline std::vector<std::uint32_t> spread_over_faces(const TriangleMesh& mesh, std::size_t count) {
  std::vector<double> areas(mesh.triangles().size());
  for (std::size_t i = 0; i < areas.size(); ++i) {
    const auto [a, b, c] = mesh.corners(i);
    areas[i] = length(cross(b - a, c - a));
  }
  return share_out(areas.size(), count, [&](std::size_t i) { return areas[i]; });
}

/// Weights of a triangle's corners for the i-th place: the R2 sequence (Roberts 2018), folded into
/// the triangle.
inline std::array<double, 3> spread_weights(std::size_t i) {
  constexpr double kFirst = 0.7548776662466927;
  constexpr double kSecond = 0.5698402909980532;
  const auto fraction = [](double x) { return x - std::floor(x); };
  double u = fraction(0.5 + kFirst * static_cast<double>(i));
  double v = fraction(0.5 + kSecond * static_cast<double>(i));
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  return {1.0 - u - v, u, v};
}

/// The i-th place, on the triangle that was chosen for it.
inline Vec3 place_on_triangle(const std::array<Vec3, 3>& corners, std::size_t i) {
  const auto [a, b, c] = spread_weights(i);
  return a * corners[0] + b * corners[1] + c * corners[2];
}

}  // namespace voxshell
