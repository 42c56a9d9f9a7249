#include "field/brick_plan.h"

#include <algorithm>
#include <cmath>

#include "mesh/closest_point.h"

namespace voxshell {
namespace {

using simd::kBrickCells;

/// How far distances inside may be off, voxels: half of it everywhere would cost 1.5 MB more of a
/// bunny of 300 voxels. Less about peaks, where depths are largest.
constexpr double kToleranceInside = 1.0;
constexpr double kToleranceAtPeaks = 0.5;

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

/// The fewest cells that are likely to be within tolerance, as the error at the brick's center
/// tells. It falls to a quarter with cells half as large where the field is smooth, to a half where
/// it has a ridge.
int choose_cells(const std::array<double, 8>& corners, double at_center) {
  double mean = 0.0;
  for (const double d : corners) mean += d / 8.0;
  const double error = std::abs(at_center - std::abs(mean));
  double tolerance = std::max(at_center / 32.0, 1.0 / 8.0);
  if (corners[0] < 0.0) tolerance = std::min(tolerance, kToleranceInside);
  if (error <= tolerance) return 1;
  return error <= 3.0 * tolerance ? 2 : 4;
}

/// Slopes cancel out about a peak, and where the sides of a ridge face each other.
bool is_peak(const std::array<double, 8>& corners) {
  Vec3 slope{};
  for (std::size_t i = 0; i < 8; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      slope[axis] += ((i >> axis & 1) != 0 ? 0.25 : -0.25) * corners[i] / kBrickCells;
    }
  }
  return length(slope) < 0.5;
}

/// Every second node along each axis of a brick, x fastest.
constexpr int kHalfNodes = kBrickCells / 2 + 1;
using HalfNodes = std::array<double, cube(kHalfNodes)>;

/// Where std::lerp would take special care of its ends.
double mix(double a, double b, double fraction) { return a + fraction * (b - a); }

/// How far trilinear cells, this many along each axis, are off at most.
double find_largest_error(const HalfNodes& nodes, int cells) {
  const int step = (kHalfNodes - 1) / cells;
  const auto at = [&](int x, int y, int z) {
    const int node = x + kHalfNodes * (y + kHalfNodes * z);
    return nodes[static_cast<std::size_t>(node)];
  };
  double largest = 0.0;
  for (int z = 0; z < kHalfNodes; ++z) {
    for (int y = 0; y < kHalfNodes; ++y) {
      for (int x = 0; x < kHalfNodes; ++x) {
        // The two nodes of the cells along each axis, the same where one lies on the place.
        const auto below = [&](int i) { return i / step * step; };
        const auto above = [&](int i) { return (i + step - 1) / step * step; };
        const auto fraction = [&](int i) { return static_cast<double>(i % step) / step; };
        const auto along_x = [&](int j, int k) {
          return mix(at(below(x), j, k), at(above(x), j, k), fraction(x));
        };
        const auto along_y = [&](int k) {
          return mix(along_x(below(y), k), along_x(above(y), k), fraction(y));
        };
        const double mean = mix(along_y(below(z)), along_y(above(z)), fraction(z));
        largest = std::max(largest, std::abs(mean - at(x, y, z)));
      }
    }
  }
  return largest;
}

}  // namespace

BrickPlan BrickPlanner::plan(const std::array<std::size_t, 3>& brick, int least_cells,
                             Work& work) const {
  const auto corners = lattice_.corners_of(brick);
  work.nearest = tree_.find_nearest(center_of(brick), work.nearest.guess);
  BrickPlan plan{.at_center = work.nearest.distance, .guess = work.nearest.guess};
  const auto at_center = static_cast<double>(plan.at_center);
  if (are_affine(corners) && is_plane(brick, corners, at_center, work.nearest.triangle, work)) {
    plan.region = flat_.region_of(work.nearest.triangle);
  } else {
    plan.cells = least_cells;
    if (least_cells < 4) plan.cells = std::max(plan.cells, choose_cells(corners, at_center));
    if (least_cells < kBrickCells && corners[0] < 0.0) {
      plan.cells = std::max(plan.cells, choose_cells_at_ridges(brick, work.nearest.triangle));
    }
  }
  return plan;
}

/// Depths have ridges and peaks inside, where they are largest and where cells cut them. Between
/// the corners of a brick they are told by the points of the surface that are nearest to the
/// corners and the center, some of which are nearest, or nearly so, to any place in the brick.
int BrickPlanner::choose_cells_at_ridges(const std::array<std::size_t, 3>& brick,
                                         std::uint32_t nearest_to_center) const {
  const Vec3 center = center_of(brick);
  const double h = grid_.voxel_size;
  std::array<Vec3, 9> nearest;  // voxels, from the center
  const auto find_nearest = [&](const Vec3& offset, std::uint32_t triangle) {
    const Vec3 from = grid_.origin + h * (center + offset);
    return offset + (closest_point_on_triangle(from, mesh_.corners(triangle)) - from) / h;
  };
  for (std::size_t i = 0; i < 8; ++i) {
    const Vec3 offset{(i & 1) != 0 ? kHalfEdge : -kHalfEdge, (i & 2) != 0 ? kHalfEdge : -kHalfEdge,
                      (i & 4) != 0 ? kHalfEdge : -kHalfEdge};
    nearest[i] = find_nearest(offset, lattice_.triangles[lattice_.corner(brick, i)]);
  }
  nearest[8] = find_nearest({}, nearest_to_center);
  HalfNodes depths;
  std::size_t node = 0;
  for (int k = 0; k < kHalfNodes; ++k) {
    for (int j = 0; j < kHalfNodes; ++j) {
      for (int i = 0; i < kHalfNodes; ++i, ++node) {
        const Vec3 offset{2.0 * i - kHalfEdge, 2.0 * j - kHalfEdge, 2.0 * k - kHalfEdge};
        double least = squared_length(offset - nearest[0]);
        for (const Vec3& point : nearest) least = std::min(least, squared_length(offset - point));
        depths[node] = std::sqrt(least);
      }
    }
  }
  const double tolerance =
      is_peak(lattice_.corners_of(brick)) ? kToleranceAtPeaks : kToleranceInside;
  if (find_largest_error(depths, 1) <= tolerance) return 1;
  const double error = find_largest_error(depths, 2);
  if (error <= tolerance) return 2;
  return error <= 2.0 * tolerance ? 4 : kBrickCells;  // a ridge's halves with the cells
}

bool BrickPlanner::is_plane(const std::array<std::size_t, 3>& brick,
                            const std::array<double, 8>& corners, double at_center,
                            std::uint32_t nearest, Work& work) const {
  constexpr std::size_t kMostTriangles = 2048;
  constexpr std::size_t kMostToMeasure = 64;
  const double h = grid_.voxel_size;
  const std::uint32_t region = flat_.region_of(nearest);
  const auto& plane = flat_.plane(region);
  const Vec3 in_voxels = center_of(brick);
  const Vec3 center = grid_.origin + h * in_voxels;
  const auto above = [&](const Vec3& offset) {
    return (dot(plane.normal, center) - plane.offset) / h + dot(plane.normal, offset);
  };
  const auto is_off = [&](double value, double expected) {
    return !(std::abs(value - expected) <= 1.5 * plane_tolerance_);
  };
  if (is_off(std::abs(above({})), at_center)) return false;
  for (std::size_t i = 0; i < 8; ++i) {
    const Vec3 offset{(i & 1) != 0 ? kHalfEdge : -kHalfEdge, (i & 2) != 0 ? kHalfEdge : -kHalfEdge,
                      (i & 4) != 0 ? kHalfEdge : -kHalfEdge};
    if (is_off(above(offset), corners[i])) return false;
  }
  // Triangles that may be the nearest of any place in the brick.
  const double reach_voxels = at_center + 2.0 * kHalfDiagonal + 1e-3;
  const double reach = h * reach_voxels;
  std::vector<std::uint32_t>& nearby = work.nearby;
  if (!tree_.find_within(in_voxels, reach_voxels, kMostTriangles, nearby)) return false;
  std::erase_if(nearby, [&](std::uint32_t triangle) {
    const Vec3 closest = closest_point_on_triangle(center, mesh_.corners(triangle));
    return squared_length(closest - center) > reach * reach;
  });
  if (flat_.spans_cube(nearby, center, kHalfEdge * h)) return true;
  if (nearby.size() > kMostToMeasure) return false;
  tree_.measure_brick(in_voxels, static_cast<float>(at_center), work.scratch, work.nodes);
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
