#include "field/choose_voxels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "mesh/closest_point.h"
#include "mesh/distance_tree.h"
#include "simd/wide.h"

namespace voxshell {
namespace {

/// Places spread evenly over the surface.
std::vector<Vec3> spread_places(const TriangleMesh& mesh, std::size_t count) {
  const std::size_t triangles = mesh.triangles().size();
  std::vector<double> areas(triangles + 1, 0.0);
  for (std::size_t i = 0; i < triangles; ++i) {
    const auto [a, b, c] = mesh.corners(i);
    areas[i + 1] = areas[i] + 0.5 * length(cross(b - a, c - a));
  }
  std::vector<Vec3> places;
  places.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto spread = [n = static_cast<double>(i) + 1.0](double step) {
      return n * step - std::floor(n * step);
    };
    const double area = (static_cast<double>(i) + 0.5) / static_cast<double>(count) * areas.back();
    const auto triangle = static_cast<std::size_t>(
        std::clamp<std::ptrdiff_t>(std::ranges::upper_bound(areas, area) - areas.begin() - 1, 0,
                                   static_cast<std::ptrdiff_t>(triangles) - 1));
    const auto [a, b, c] = mesh.corners(triangle);
    double u = spread(0.7548776662466927);  // the root of x^3 = x + 1, and its square
    double v = spread(0.5698402909980532);
    if (u + v > 1.0) {
      u = 1.0 - u;
      v = 1.0 - v;
    }
    places.push_back(a + u * (b - a) + v * (c - a));
  }
  return places;
}

/// How cells of one size would do.
struct Trial {
  double fraction_off = 0.0;  ///< of the surface, where samples are off by more than the tolerance
  double blocks = 0.0;        ///< of eight triangles, that are nearest in a cell there, on average
};

/// `unit`: of lengths in the tree, meters.
Trial try_voxels(const TriangleMesh& mesh, const DistanceTree& tree, double unit,
                 const std::vector<Vec3>& places, double h, double tolerance) {
  Trial trial;
  std::vector<std::uint32_t> found;
  std::size_t off = 0;
  double blocks = 0.0;
  std::size_t counted = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    // In a cell that lies about the place anyhow.
    const auto shift = [n = static_cast<double>(i) + 1.0](double step) {
      return n * step - std::floor(n * step);
    };
    const Vec3 t{shift(0.8191725133961645), shift(0.6710436067037893), shift(0.5497004779019703)};
    const Vec3 first = places[i] - h * t;
    double value = 0.0;
    DistanceTree::Nearest nearest{};
    for (int corner = 0; corner < 8; ++corner) {
      const Vec3 offset{1.0 * (corner & 1), 1.0 * (corner >> 1 & 1), 1.0 * (corner >> 2)};
      const Vec3 p = first + h * offset;
      nearest = tree.find_nearest((1.0 / unit) * (p - mesh.bounds().lower), nearest.guess);
      const auto corners = mesh.corners(nearest.triangle);
      const Vec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
      const double side = dot(p - closest_point_on_triangle(p, corners), normal);
      double weight = 1.0;
      for (int axis = 0; axis < 3; ++axis) weight *= offset[axis] != 0.0 ? t[axis] : 1.0 - t[axis];
      value += weight * std::copysign(static_cast<double>(nearest.distance) * unit, side);
    }
    if (std::abs(value) <= tolerance) continue;
    ++off;
    constexpr std::size_t kEvery = 8;
    if (off % kEvery != 1) continue;
    constexpr double kReach = 0.9;  // voxels
    constexpr std::size_t kMost = 512;
    const Vec3 center = first + 0.5 * h * Vec3{1.0, 1.0, 1.0};
    ++counted;
    blocks += tree.find_within((1.0 / unit) * (center - mesh.bounds().lower), kReach * h / unit,
                               kMost, found)
                  ? static_cast<double>(found.size()) / 8.0
                  : static_cast<double>(kMost) / 8.0;
  }
  trial.fraction_off = static_cast<double>(off) / static_cast<double>(places.size());
  trial.blocks = counted == 0 ? 0.0 : blocks / static_cast<double>(counted);
  return trial;
}

}  // namespace

double choose_voxels(const TriangleMesh& mesh, double tolerance, unsigned threads) {
  constexpr std::array kResolutions{24, 32, 48, 64, 96, 128, 192, 256, 320};
  constexpr std::size_t kPlaces = 1024;
  // An exact cell takes so much longer than samples; what fine voxels cost in memory and time to
  // build grows with the square of the resolution.
  constexpr double kExactCost = 12.0;
  constexpr double kDearResolution = 250.0;
  const double longest = mesh.bounds().extents()[mesh.bounds().longest_axis()];
  const std::vector<Vec3> places = spread_places(mesh, kPlaces);
  const double unit = longest / kResolutions.back();
  const DistanceTree tree(mesh, mesh.bounds().lower, unit, threads);
  std::array<double, kResolutions.size()> costs{};
  std::size_t tried = 0;
  while (tried < kResolutions.size()) {
    const Trial trial =
        try_voxels(mesh, tree, unit, places, longest / kResolutions[tried], tolerance);
    const double fineness = kResolutions[tried] / kDearResolution;
    costs[tried++] =
        1.0 + kExactCost * trial.fraction_off * (1.0 + trial.blocks) + fineness * fineness;
    if (trial.fraction_off == 0.0) break;
  }
  // The coarsest that costs little more than the best.
  constexpr double kLittle = 1.15;
  const auto end = costs.begin() + static_cast<std::ptrdiff_t>(tried);
  const double least = *std::min_element(costs.begin(), end);
  const auto chosen =
      std::find_if(costs.begin(), end, [&](double cost) { return cost <= kLittle * least; });
  return longest / kResolutions[static_cast<std::size_t>(chosen - costs.begin())];
}

}  // namespace voxshell
