#include "field/surface_bricks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "simd/grid_view.h"

namespace voxshell {
namespace {

/// A convex polygon in units of bricks: a triangle cut by up to four planes.
struct Polygon {
  std::array<Vec3, 8> corners;
  std::size_t size = 0;

  double lowest(int axis) const {
    double value = corners[0][axis];
    for (std::size_t i = 1; i < size; ++i) value = std::min(value, corners[i][axis]);
    return value;
  }
  double highest(int axis) const {
    double value = corners[0][axis];
    for (std::size_t i = 1; i < size; ++i) value = std::max(value, corners[i][axis]);
    return value;
  }
};

/// The part where sign * (coordinate - at) >= 0.
Polygon cut(const Polygon& polygon, int axis, double at, double sign) {
  Polygon kept;
  for (std::size_t i = 0; i < polygon.size; ++i) {
    const Vec3& a = polygon.corners[i];
    const Vec3& b = polygon.corners[(i + 1) % polygon.size];
    const double above_a = sign * (a[axis] - at);
    const double above_b = sign * (b[axis] - at);
    if (above_a >= 0.0) kept.corners[kept.size++] = a;
    if ((above_a < 0.0) != (above_b < 0.0)) {
      kept.corners[kept.size++] = a + (above_a / (above_a - above_b)) * (b - a);
    }
  }
  return kept;
}

struct Span {
  std::size_t first;
  std::size_t last;
};

Span bricks_between(double low, double high, std::size_t count) {
  const auto most = static_cast<double>(count - 1);
  return {static_cast<std::size_t>(std::clamp(std::floor(low), 0.0, most)),
          static_cast<std::size_t>(std::clamp(std::floor(high), 0.0, most))};
}

}  // namespace

namespace {

/// `corners_of(i)` gives the triangles.
template <class Corners>
std::vector<char> find_bricks(std::size_t count, const Corners& corners_of, const BrickGrid& grid,
                              double margin) {
  std::vector<char> found(grid.count(), 0);
  const double edge = simd::kBrickCells * grid.voxel_size;
  const double m = margin / simd::kBrickCells;
  const auto slabs = [&](const Polygon& polygon, int axis, const auto& visit) {
    const Span span = bricks_between(polygon.lowest(axis) - m, polygon.highest(axis) + m,
                                     grid.bricks[static_cast<std::size_t>(axis)]);
    for (std::size_t i = span.first; i <= span.last; ++i) {
      if (span.first == span.last) {
        visit(i, polygon);
        continue;
      }
      const auto low = static_cast<double>(i);
      const Polygon part = cut(cut(polygon, axis, low - m, 1.0), axis, low + 1.0 + m, -1.0);
      if (part.size > 0) visit(i, part);
    }
  };
  for (std::size_t t = 0; t < count; ++t) {
    Polygon triangle;
    for (const Vec3& corner : corners_of(t)) {
      triangle.corners[triangle.size++] = (corner - grid.origin) / edge;
    }
    slabs(triangle, 2, [&](std::size_t k, const Polygon& layer) {
      slabs(layer, 1, [&](std::size_t j, const Polygon& row) {
        const Span span = bricks_between(row.lowest(0) - m, row.highest(0) + m, grid.bricks[0]);
        const std::size_t first = grid.bricks[0] * (j + grid.bricks[1] * k);
        for (std::size_t i = span.first; i <= span.last; ++i) found[first + i] = 1;
      });
    });
  }
  return found;
}

}  // namespace

std::vector<char> find_surface_bricks(std::span<const std::array<Vec3, 3>> triangles,
                                      const BrickGrid& grid, double margin) {
  return find_bricks(triangles.size(), [&](std::size_t i) { return triangles[i]; }, grid, margin);
}

std::vector<char> find_surface_bricks(const TriangleMesh& mesh, const BrickGrid& grid,
                                      double margin) {
  return find_bricks(
      mesh.triangles().size(), [&](std::size_t i) { return mesh.corners(i); }, grid, margin);
}

}  // namespace voxshell
