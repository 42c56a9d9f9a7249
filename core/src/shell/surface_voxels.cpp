#include "shell/surface_voxels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "mesh/closest_point.h"

namespace voxshell {
namespace {

/// A convex polygon in a plane: a triangle cut by axis-aligned planes. Each of the six cuts adds at
/// most one corner.
struct Polygon {
  static constexpr std::size_t kMaxCorners = 9;
  std::array<Vec3, kMaxCorners> corners;
  std::size_t count = 0;

  void add(const Vec3& p) { corners[count++] = p; }
};

/// The part of `polygon` on one side of the plane at `position` on `axis`.
enum class Side { kBelow, kAbove };

Polygon cut(const Polygon& polygon, int axis, double position, Side side) {
  const double sign = side == Side::kBelow ? 1.0 : -1.0;
  Polygon kept;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Vec3& a = polygon.corners[i];
    const Vec3& b = polygon.corners[(i + 1) % polygon.count];
    const double beyond_a = sign * (a[axis] - position);
    const double beyond_b = sign * (b[axis] - position);
    if (beyond_a <= 0.0) kept.add(a);
    if ((beyond_a < 0.0 && beyond_b > 0.0) || (beyond_a > 0.0 && beyond_b < 0.0)) {
      Vec3 crossing = a + (beyond_a / (beyond_a - beyond_b)) * (b - a);
      crossing[axis] = position;
      kept.add(crossing);
    }
  }
  return kept;
}

double compute_area(const Polygon& polygon) {
  Vec3 doubled{};
  for (std::size_t i = 2; i < polygon.count; ++i) {
    doubled +=
        cross(polygon.corners[i - 1] - polygon.corners[0], polygon.corners[i] - polygon.corners[0]);
  }
  return length(doubled) / 2.0;
}

Vec3 closest_point_on_polygon(const Vec3& p, const Polygon& polygon) {
  Vec3 best{};
  double best_squared = std::numeric_limits<double>::infinity();
  for (std::size_t i = 2; i < polygon.count; ++i) {
    const Vec3 candidate = closest_point_on_triangle(
        p, {polygon.corners[0], polygon.corners[i - 1], polygon.corners[i]});
    const double squared = squared_length(p - candidate);
    if (squared < best_squared) {
      best = candidate;
      best_squared = squared;
    }
  }
  return best;
}

struct Voxel {
  std::array<std::int64_t, 3> index{};  ///< along x, y, z

  friend bool operator==(const Voxel&, const Voxel&) = default;
  friend bool operator<(const Voxel& a, const Voxel& b) {
    if (a.index[2] != b.index[2]) return a.index[2] < b.index[2];
    if (a.index[1] != b.index[1]) return a.index[1] < b.index[1];
    return a.index[0] < b.index[0];
  }
};

struct Piece {
  Voxel voxel;
  std::uint32_t triangle;
  double squared_distance;  ///< of point to the voxel's centre
  Vec3 point;
  double area;
};

/// Works in the grid's axes.
class Cutter {
 public:
  Cutter(std::span<const Vec3> vertices, const VoxelGrid& grid, Stage& stage)
      : vertices_(vertices), spacing_(grid.spacing), stage_(stage) {
    Bounds bounds;
    for (const Vec3& vertex : vertices) bounds.extend(vertex);
    for (int axis = 0; axis < 3; ++axis) {
      // A whole number of voxels with the mesh in their middle, so that no flat side of it lies on
      // a face between voxels; a side of whole voxels must not end up on either side by rounding.
      constexpr double kRounding = 1e-6;
      const double voxels = std::floor(bounds.extents()[axis] / spacing_ + kRounding) + 1.0;
      origin_[axis] = bounds.centre()[axis] + (grid.shift[axis] - 0.5 * voxels) * spacing_;
    }
  }

  std::vector<Piece> cut_all(std::span<const Triangle> triangles) {
    for (std::uint32_t i = 0; i < triangles.size() && !stage_.stopped(); ++i) {
      begun_ = static_cast<double>(i) / static_cast<double>(triangles.size());
      Polygon triangle;
      for (const std::uint32_t corner : triangles[i]) triangle.add(vertices_[corner]);
      cut_along(triangle, 0, {}, i);
    }
    return std::move(pieces_);
  }

 private:
  void cut_along(const Polygon& polygon, int axis, Voxel voxel, std::uint32_t triangle) {
    if (axis == 3) {
      keep(polygon, voxel, triangle);
      return;
    }
    double low = polygon.corners[0][axis];
    double high = low;
    for (std::size_t i = 1; i < polygon.count; ++i) {
      low = std::min(low, polygon.corners[i][axis]);
      high = std::max(high, polygon.corners[i][axis]);
    }
    // In the plane of a face, corners lie on either side of it by rounding: cutting there would
    // count parts twice.
    constexpr double kFlat = 1e-9;  // spacings
    if (high - low <= kFlat * spacing_) low = high = 0.5 * (low + high);
    const std::int64_t first = slab(low, axis);
    const std::int64_t last = slab(high, axis);
    Polygon rest = polygon;
    for (std::int64_t i = first; i <= last && rest.count >= 3 && !stage_.stopped(); ++i) {
      voxel.index[static_cast<std::size_t>(axis)] = i;
      if (i == last) {
        cut_along(rest, axis + 1, voxel, triangle);
        break;
      }
      const double face = origin_[axis] + static_cast<double>(i + 1) * spacing_;
      const Polygon below = cut(rest, axis, face, Side::kBelow);
      if (below.count >= 3) cut_along(below, axis + 1, voxel, triangle);
      rest = cut(rest, axis, face, Side::kAbove);
    }
  }

  void keep(const Polygon& polygon, const Voxel& voxel, std::uint32_t triangle) {
    const double area = compute_area(polygon);
    if (!(area > 0.0)) return;
    Vec3 centre{};
    for (int axis = 0; axis < 3; ++axis) {
      const auto index = static_cast<double>(voxel.index[static_cast<std::size_t>(axis)]);
      centre[axis] = origin_[axis] + (index + 0.5) * spacing_;
    }
    const Vec3 point = closest_point_on_polygon(centre, polygon);
    pieces_.push_back({voxel, triangle, squared_length(point - centre), point, area});
    constexpr std::size_t kPiecesAReport = 1 << 12;
    if (pieces_.size() % kPiecesAReport == 0) stage_.report(begun_);
  }

  std::int64_t slab(double coordinate, int axis) const {
    return static_cast<std::int64_t>(std::floor((coordinate - origin_[axis]) / spacing_));
  }

  std::span<const Vec3> vertices_;
  double spacing_;
  Vec3 origin_{};
  std::vector<Piece> pieces_;
  Stage& stage_;
  double begun_ = 0.0;  ///< share of the triangles
};

}  // namespace

std::vector<SurfaceSample> sample_surface_voxels(const TriangleMesh& mesh, const VoxelGrid& grid,
                                                 Stage& stage) {
  std::vector<Vec3> vertices;
  vertices.reserve(mesh.vertices().size());
  for (const Vec3& vertex : mesh.vertices()) vertices.push_back(grid.grid_from_mesh * vertex);
  std::vector<Piece> pieces = Cutter(vertices, grid, stage).cut_all(mesh.triangles());
  if (stage.stopped()) return {};
  std::sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) {
    if (!(a.voxel == b.voxel)) return a.voxel < b.voxel;
    if (a.squared_distance != b.squared_distance) return a.squared_distance < b.squared_distance;
    return a.triangle < b.triangle;
  });
  const Matrix3 mesh_from_grid = grid.grid_from_mesh.transposed();
  std::vector<SurfaceSample> samples;
  for (std::size_t i = 0; i < pieces.size();) {
    const Piece& closest = pieces[i];
    SurfaceSample sample{mesh_from_grid * closest.point, closest.triangle, 0.0};
    for (; i < pieces.size() && pieces[i].voxel == closest.voxel; ++i) {
      sample.area += pieces[i].area;
    }
    samples.push_back(sample);
  }
  return samples;
}

}  // namespace voxshell
