#include "field/brick_plan.h"

#include <algorithm>
#include <cmath>

#include "mesh/closest_point.h"

namespace voxshell {
namespace {

using simd::kBrickCells;

/// True where a field may be linear between distances at a brick's corners.
bool are_affine(const std::array<double, 8>& d) {
  constexpr double kTolerance = 1.0 / 128.0;  // voxels
  const double x = d[1] - d[0];
  const double y = d[2] - d[0];
  const double z = d[4] - d[0];
  return std::abs(d[3] - d[0] - x - y) <= kTolerance &&
         std::abs(d[5] - d[0] - x - z) <= kTolerance &&
         std::abs(d[6] - d[0] - y - z) <= kTolerance &&
         std::abs(d[7] - d[0] - x - y - z) <= kTolerance;
}

/// The fewest cells that are likely to be within tolerance, as the error at the brick's centre
/// tells. It falls to a quarter with cells half as large where the field is smooth, to a half where
/// it has a ridge.
int choose_cells(const std::array<double, 8>& corners, double at_centre) {
  double mean = 0.0;
  for (const double d : corners) mean += d / 8.0;
  const bool is_inside = corners[0] < 0.0;
  const double depth = std::abs(at_centre);
  const double error = std::abs(depth - std::abs(mean));
  double tolerance = std::max(depth / 32.0, 1.0 / 8.0);
  if (is_inside) tolerance = std::min(tolerance, 1.0);
  if (is_inside) {
    // Deep inside a slope well below one tells of a ridge or peak, where depths are largest.
    Vec3 slope{};
    for (std::size_t i = 0; i < 8; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        slope[axis] += ((i >> axis & 1) != 0 ? 0.25 : -0.25) * corners[i] / kBrickCells;
      }
    }
    const double steepness = length(slope);
    if (steepness < 0.5) return kBrickCells;
    if (steepness < 0.85) return 4;
  }
  if (error <= tolerance) return 1;
  return error <= 3.0 * tolerance ? 2 : 4;
}

}  // namespace

BrickPlan BrickPlanner::plan(const std::array<std::size_t, 3>& brick,
                             const std::array<double, 8>& corners, bool is_fine, Work& work) const {
  work.nearest = tree_.find_nearest(centre_of(brick), work.nearest.guess);
  BrickPlan plan{.at_centre = work.nearest.distance};
  const auto at_centre = static_cast<double>(plan.at_centre);
  if (are_affine(corners) && is_plane(brick, corners, at_centre, work.nearest.triangle, work)) {
    plan.region = flat_.region_of(work.nearest.triangle);
  } else if (is_fine) {
    plan.cells = kBrickCells;
  } else {
    plan.cells = choose_cells(corners, at_centre);
  }
  return plan;
}

/// Whether the distances at a brick's nodes are those to the plane that triangle `nearest`, the
/// one nearest to its centre, lies in.
bool BrickPlanner::is_plane(const std::array<std::size_t, 3>& brick,
                            const std::array<double, 8>& corners, double at_centre,
                            std::uint32_t nearest, Work& work) const {
  constexpr std::size_t kMostTriangles = 2048;
  constexpr std::size_t kMostToMeasure = 64;
  const double h = grid_.voxel_size;
  const std::uint32_t region = flat_.region_of(nearest);
  const auto& plane = flat_.plane(region);
  const Vec3 in_voxels = centre_of(brick);
  const Vec3 centre = grid_.origin + h * in_voxels;
  const auto above = [&](const Vec3& offset) {
    return (dot(plane.normal, centre) - plane.offset) / h + dot(plane.normal, offset);
  };
  const auto is_off = [&](double value, double expected) {
    return !(std::abs(value - expected) <= 1.5 * kPlaneTolerance);
  };
  if (is_off(std::abs(above({})), at_centre)) return false;
  for (std::size_t i = 0; i < 8; ++i) {
    const Vec3 offset{(i & 1) != 0 ? kHalfEdge : -kHalfEdge, (i & 2) != 0 ? kHalfEdge : -kHalfEdge,
                      (i & 4) != 0 ? kHalfEdge : -kHalfEdge};
    if (is_off(above(offset), corners[i])) return false;
  }
  // Triangles that may be the nearest of any place in the brick.
  const double reach_voxels = at_centre + 2.0 * kHalfDiagonal + 1e-3;
  const double reach = h * reach_voxels;
  std::vector<std::uint32_t>& nearby = work.nearby;
  if (!tree_.find_within(in_voxels, reach_voxels, kMostTriangles, nearby)) return false;
  std::erase_if(nearby, [&](std::uint32_t triangle) {
    const Vec3 closest = closest_point_on_triangle(centre, mesh_.corners(triangle));
    return squared_length(closest - centre) > reach * reach;
  });
  if (flat_.spans_cube(nearby, centre, kHalfEdge * h)) return true;
  if (nearby.size() > kMostToMeasure) return false;
  tree_.measure_brick(in_voxels, static_cast<float>(at_centre), work.scratch, work.nodes);
  std::size_t node = 0;
  for (int k = 0; k <= kBrickCells; ++k) {
    for (int j = 0; j <= kBrickCells; ++j) {
      for (int i = 0; i <= kBrickCells; ++i, ++node) {
        const Vec3 offset{i - kHalfEdge, j - kHalfEdge, k - kHalfEdge};
        if (is_off(static_cast<double>(work.nodes[node]), std::abs(above(offset)))) return false;
      }
    }
  }
  return true;
}

}  // namespace voxshell
