#include "voxshell/grid_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "base/text.h"
#include "mesh/closest_point.h"
#include "mesh/row_winding.h"

namespace voxshell {
namespace {

/// Grid nodes along one axis beyond which indices would no longer be exact in float32 arithmetic.
constexpr double kMaxNodesPerAxis = 8192.0;

/// The nodes that a voxel size asks for, counted in float64 as they may be very many.
struct GridPlan {
  Bounds bounds;
  Vec3 nodes;  ///< along x, y, z

  double bytes() const { return nodes.x * nodes.y * nodes.z * sizeof(float); }
  double longest() const { return std::max({nodes.x, nodes.y, nodes.z}); }
  bool fits(std::size_t memory_limit) const {
    return bytes() <= static_cast<double>(memory_limit) && longest() <= kMaxNodesPerAxis;
  }
};

GridPlan plan_grid(const Bounds& surface_bounds, double padding, double voxel_size) {
  const double kept = std::max(padding, voxel_size);
  const Vec3 pad{kept, kept, kept};
  GridPlan plan{{surface_bounds.lower - pad, surface_bounds.upper + pad}, {}};
  for (int axis = 0; axis < 3; ++axis) {
    plan.nodes[axis] = std::ceil(plan.bounds.extents()[axis] / voxel_size) + 1.0;
  }
  return plan;
}

Error too_large(const GridPlan& plan, const Bounds& surface_bounds,
                const GridFieldSettings& settings) {
  const double by_memory = std::cbrt(plan.bytes() / static_cast<double>(settings.memory_limit));
  const double by_axis = plan.longest() / kMaxNodesPerAxis;
  double advised = settings.voxel_size * std::max(by_memory, by_axis);
  // The outermost nodes do not become fewer with larger voxels.
  const double too_coarse = surface_bounds.extents()[surface_bounds.longest_axis()];
  while (advised < too_coarse &&
         !plan_grid(surface_bounds, settings.padding, advised).fits(settings.memory_limit)) {
    advised *= 1.01;
  }
  // The last factor outweighs the rounding of the text.
  return {ErrorCode::kTooLarge,
          format_text("a distance field of voxel size %.3g m would need %.3g GB (%.3g voxels along "
                      "its longest side); use a voxel size of at least %.3g m",
                      settings.voxel_size, plan.bytes() / 1e9, plan.longest(), 1.006 * advised)};
}

/// Nodes that lie in several layers of the mesh, or in one that is inside out.
struct OverlapCount {
  std::size_t nodes = 0;
  Vec3 first{};

  void add(const Vec3& node) { add(OverlapCount{1, node}); }
  void add(const OverlapCount& other) {
    if (nodes == 0) first = other.first;
    nodes += other.nodes;
  }
};

}  // namespace

/// Where a point falls: its cell, the position within it, and how far it lies outside the grid.
struct GridField::Cell {
  std::size_t first;  ///< index of the cell's lowest node
  float u, v, w;      ///< position within the cell, 0 to 1
  Vec3f outside;      ///< from the nearest point of the grid to the point, metres
};

Result<GridField> GridField::build(const TriangleMesh& mesh, const GridFieldSettings& settings,
                                   const Progress& progress) {
  if (!(settings.voxel_size > 0.0) || !std::isfinite(settings.voxel_size)) {
    return Error{ErrorCode::kInvalidArgument,
                 format_text("voxel size must be above 0 m, not %g", settings.voxel_size)};
  }
  if (!(settings.padding >= 0.0) || !std::isfinite(settings.padding)) {
    return Error{ErrorCode::kInvalidArgument,
                 format_text("padding must be at least 0 m, not %g", settings.padding)};
  }
  if (auto closed = check_encloses_volume(mesh); !closed) return closed.error();

  const GridPlan plan = plan_grid(mesh.bounds(), settings.padding, settings.voxel_size);
  if (!plan.fits(settings.memory_limit)) return too_large(plan, mesh.bounds(), settings);

  GridField field;
  field.voxel_size_ = settings.voxel_size;
  field.origin_ = plan.bounds.lower;
  field.shape_ = {static_cast<int>(plan.nodes.x), static_cast<int>(plan.nodes.y),
                  static_cast<int>(plan.nodes.z)};
  field.surface_bounds_ = mesh.bounds();
  const auto nx = static_cast<std::size_t>(field.shape_[0]);
  const auto ny = static_cast<std::size_t>(field.shape_[1]);
  const auto nz = static_cast<std::size_t>(field.shape_[2]);
  field.samples_.resize(nx * ny * nz);

  const auto winding = RowWinding::build(
      mesh, {.origin = field.origin_, .step = field.voxel_size_, .rows_y = ny, .rows_z = nz});
  if (!winding) return winding.error();
  const ClosestPointTree tree(mesh);
  std::vector<double> row_x(nx);
  for (std::size_t i = 0; i < nx; ++i) {
    row_x[i] = field.origin_.x + static_cast<double>(i) * field.voxel_size_;
  }
  std::vector<OverlapCount> overlaps(ny * nz);
  const auto fill_row = [&](std::size_t row) {
    const double h = field.voxel_size_;
    const std::size_t j = row % ny;
    const std::size_t k = row / ny;
    Vec3 p = field.origin_ + Vec3{0.0, static_cast<double>(j) * h, static_cast<double>(k) * h};
    std::vector<int> layers(nx);
    winding->compute(row, row_x, layers);
    ClosestPoint closest{};
    for (std::size_t i = 0; i < nx; ++i) {
      p.x = row_x[i];
      closest = tree.find_closest(p, closest.triangle);
      const double distance = std::sqrt(closest.squared_distance);
      field.samples_[row * nx + i] = static_cast<float>(layers[i] > 0 ? -distance : distance);
      if (layers[i] != 0 && layers[i] != 1 && distance > h) overlaps[row].add(p);
    }
  };
  if (!parallel_for(ny * nz, settings.threads, "distance field", progress, fill_row)) {
    return Error{ErrorCode::kCancelled, "building the distance field was stopped"};
  }
  OverlapCount overlap;
  for (const OverlapCount& of_row : overlaps) overlap.add(of_row);
  if (overlap.nodes > 0) {
    return Error{
        ErrorCode::kInvalidMesh,
        format_text("mesh overlaps itself by more than a voxel: %zu of %zu grid nodes are "
                    "enclosed more than once or inside out (first near %s metres); unite "
                    "its parts before building a signed field",
                    overlap.nodes, field.samples_.size(), format_point(overlap.first).c_str())};
  }
  field.lipschitz_constant_ = field.compute_lipschitz_constant();
  return field;
}

double GridField::compute_lipschitz_constant() const {
  const auto nx = static_cast<std::size_t>(shape_[0]);
  const auto ny = static_cast<std::size_t>(shape_[1]);
  const auto nz = static_cast<std::size_t>(shape_[2]);
  const std::array<std::size_t, 3> stride{1, nx, nx * ny};
  // Along an axis the derivative of a trilinear cell is a mean of its four edges' slopes.
  float largest = 0.0f;
  for (std::size_t k = 0; k + 1 < nz; ++k) {
    for (std::size_t j = 0; j + 1 < ny; ++j) {
      for (std::size_t i = 0; i + 1 < nx; ++i) {
        const float* cell = &samples_[i + j * stride[1] + k * stride[2]];
        float squared = 0.0f;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const std::size_t along = stride[axis];
          const std::size_t side = stride[(axis + 1) % 3];
          const std::size_t up = stride[(axis + 2) % 3];
          float slope = 0.0f;
          for (const std::size_t corner : {std::size_t{0}, side, up, side + up}) {
            slope = std::max(slope, std::abs(cell[corner + along] - cell[corner]));
          }
          squared += slope * slope;
        }
        largest = std::max(largest, squared);
      }
    }
  }
  return 1.000001 * std::sqrt(static_cast<double>(largest)) / voxel_size_;
}

GridField::Cell GridField::locate(const Vec3f& p) const {
  const auto h = static_cast<float>(voxel_size_);
  const auto inverse_h = static_cast<float>(1.0 / voxel_size_);
  Vec3f within{};
  Vec3f outside{};
  std::array<std::size_t, 3> lowest{};
  for (int axis = 0; axis < 3; ++axis) {
    const int nodes = shape_[static_cast<std::size_t>(axis)];
    const float unclamped = (p[axis] - static_cast<float>(origin_[axis])) * inverse_h;
    // In this order, not-a-number becomes 0 here and stays what it is in `outside`.
    const float clamped = std::min(std::max(0.0f, unclamped), static_cast<float>(nodes - 1));
    outside[axis] = (unclamped - clamped) * h;
    const int cell = std::min(static_cast<int>(clamped), nodes - 2);
    lowest[static_cast<std::size_t>(axis)] = static_cast<std::size_t>(cell);
    within[axis] = clamped - static_cast<float>(cell);
  }
  const auto nx = static_cast<std::size_t>(shape_[0]);
  const auto ny = static_cast<std::size_t>(shape_[1]);
  return {lowest[0] + nx * (lowest[1] + ny * lowest[2]), within.x, within.y, within.z, outside};
}

namespace {

float lerp(float a, float b, float t) { return a + t * (b - a); }

}  // namespace

float GridField::distance(const Vec3f& p) const {
  const Cell cell = locate(p);
  const auto nx = static_cast<std::size_t>(shape_[0]);
  const auto layer = nx * static_cast<std::size_t>(shape_[1]);
  const float* c = &samples_[cell.first];
  const float low = lerp(lerp(c[0], c[1], cell.u), lerp(c[nx], c[nx + 1], cell.u), cell.v);
  c += layer;
  const float high = lerp(lerp(c[0], c[1], cell.u), lerp(c[nx], c[nx + 1], cell.u), cell.v);
  const float inside_grid = lerp(low, high, cell.w);
  if (cell.outside == Vec3f{}) return inside_grid;
  return inside_grid + length(cell.outside);
}

Vec3f GridField::gradient(const Vec3f& p) const {
  const Cell cell = locate(p);
  const auto nx = static_cast<std::size_t>(shape_[0]);
  const auto layer = nx * static_cast<std::size_t>(shape_[1]);
  const auto inverse_h = static_cast<float>(1.0 / voxel_size_);
  const float* c = &samples_[cell.first];
  const float* d = c + layer;
  const auto [u, v, w] = std::array{cell.u, cell.v, cell.w};

  const float dx_low = lerp(c[1] - c[0], c[nx + 1] - c[nx], v);
  const float dx_high = lerp(d[1] - d[0], d[nx + 1] - d[nx], v);
  const float dy_low = lerp(c[nx] - c[0], c[nx + 1] - c[1], u);
  const float dy_high = lerp(d[nx] - d[0], d[nx + 1] - d[1], u);
  const float dz_low = lerp(d[0] - c[0], d[1] - c[1], u);
  const float dz_high = lerp(d[nx] - c[nx], d[nx + 1] - c[nx + 1], u);
  Vec3f gradient{lerp(dx_low, dx_high, w), lerp(dy_low, dy_high, w), lerp(dz_low, dz_high, v)};
  gradient = gradient * inverse_h;
  if (cell.outside == Vec3f{}) return gradient;
  // The nearest point of the grid does not move along the axes on which p is outside.
  for (int axis = 0; axis < 3; ++axis) {
    if (cell.outside[axis] != 0.0f) gradient[axis] = 0.0f;
  }
  return gradient + normalized(cell.outside);
}

double GridField::interpolation_error() const { return std::sqrt(0.75) * voxel_size_; }

double GridField::reach() const {
  const Vec3 far =
      origin_ + voxel_size_ * Vec3{static_cast<double>(shape_[0]), static_cast<double>(shape_[1]),
                                   static_cast<double>(shape_[2])};
  return length(origin_) + length(far);
}

float GridField::lower_bound(const Vec3f& centre, float radius) const {
  const auto error = static_cast<float>(interpolation_error());
  // From outside its bounds the surface is at least as far as they are.
  const auto to_bounds =
      static_cast<float>(std::sqrt(squared_distance(surface_bounds_, static_cast<Vec3>(centre))));
  const float bound =
      to_bounds > 0.0f ? to_bounds - radius - error : -std::numeric_limits<float>::infinity();

  float inside_by = std::numeric_limits<float>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const auto low = static_cast<float>(origin_[axis]);
    const float high = low + static_cast<float>(voxel_size_) *
                                 static_cast<float>(shape_[static_cast<std::size_t>(axis)] - 1);
    inside_by = std::min({inside_by, centre[axis] - low, high - centre[axis]});
  }
  if (inside_by < 0.0f) return bound;
  // Either the true distance changes by the radius and both ends are off by the error, or, while
  // the ball stays in the grid, the interpolant changes by its own Lipschitz constant.
  float slack = radius + 2.0f * error;
  if (inside_by >= radius) {
    slack = std::min(slack, static_cast<float>(lipschitz_constant_) * radius);
  }
  return std::max(bound, distance(centre) - slack);
}

}  // namespace voxshell
