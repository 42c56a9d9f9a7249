#include "voxshell/point_shell.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/text.h"
#include "shell/surface_voxels.h"

namespace voxshell {
namespace {

struct ShellPoint {
  Vec3f point;
  Vec3f normal;
  double area;
};

struct Sampling {
  std::vector<ShellPoint> points;
  double spacing = 0.0;
  std::size_t voxels = 0;  ///< more than points where float32 cannot tell some apart
};

/// Rounds samples to float32 and merges those that then share a place.
Sampling compute_shell_points(const TriangleMesh& mesh, const VoxelGrid& grid, Stage& stage) {
  std::vector<ShellPoint> shell_points;
  for (const SurfaceSample& sample : sample_surface_voxels(mesh, grid, stage)) {
    const auto [a, b, c] = mesh.corners(sample.triangle);
    shell_points.push_back({static_cast<Vec3f>(sample.point),
                            static_cast<Vec3f>(normalized(cross(b - a, c - a))), sample.area});
  }
  const auto before = [](const ShellPoint& a, const ShellPoint& b) {
    if (a.point.z != b.point.z) return a.point.z < b.point.z;
    if (a.point.y != b.point.y) return a.point.y < b.point.y;
    return a.point.x < b.point.x;
  };
  std::stable_sort(shell_points.begin(), shell_points.end(), before);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < shell_points.size(); ++i) {
    if (kept > 0 && shell_points[kept - 1].point == shell_points[i].point) {
      shell_points[kept - 1].area += shell_points[i].area;
    } else {
      shell_points[kept++] = shell_points[i];
    }
  }
  const std::size_t voxels = shell_points.size();
  shell_points.resize(kept);
  return {std::move(shell_points), grid.spacing, voxels};
}

/// Surface voxels per spacing^2 of surface, on average over its orientations.
constexpr double kVoxelsPerArea = 1.5;

/// A grid that shares no symmetry with the mesh; another for each index. Rotation and shift are
/// multiples of powers of the root of x^4 = x + 1, which spread evenly.
VoxelGrid make_odd_grid(double spacing, int index) {
  const auto spread = [n = index + 1.0](double step) { return n * step - std::floor(n * step); };
  const Vec3 shift{spread(0.8191725133961645), spread(0.6710436067037893),
                   spread(0.5497004779019703)};
  // From the quaternion (1, v): the last bits of sines and cosines differ by machine.
  const Vec3 v = 2.0 * shift - Vec3{1.0, 1.0, 1.0};
  const double s = 2.0 / (1.0 + squared_length(v));
  return {spacing,
          {{1.0 - s * (v.y * v.y + v.z * v.z), s * (v.x * v.y - v.z), s * (v.x * v.z + v.y)},
           {s * (v.x * v.y + v.z), 1.0 - s * (v.x * v.x + v.z * v.z), s * (v.y * v.z - v.x)},
           {s * (v.x * v.z - v.y), s * (v.y * v.z + v.x), 1.0 - s * (v.x * v.x + v.y * v.y)}},
          shift};
}

Error stopped() { return {ErrorCode::kCancelled, "building the point shell was stopped"}; }

/// Finds the spacing that gives a wanted number of points. The number falls with the spacing, but
/// on regular meshes in steps, as many voxels appear at once. Where a bisection ends at such a
/// step, the search goes on with odd grids.
Result<Sampling> search_target(const TriangleMesh& mesh, std::size_t target, Stage& stage) {
  constexpr int kMaxTrials = 64;
  constexpr double kTolerance = 0.01;
  const auto wanted = static_cast<double>(target);
  const double longest = mesh.bounds().extents()[mesh.bounds().longest_axis()];
  VoxelGrid grid{
      std::max(std::sqrt(kVoxelsPerArea * mesh.compute_area() / wanted), longest / wanted), {}};
  int odd_grids = 0;
  double too_fine = 0.0;
  double too_coarse = 0.0;
  Sampling best;
  const auto miss = [&](std::size_t points) {
    return std::abs(static_cast<double>(points) - wanted);
  };
  for (int trial = 0; trial < kMaxTrials; ++trial) {
    stage.set_part(static_cast<double>(trial) / kMaxTrials,
                   static_cast<double>(trial + 1) / kMaxTrials);
    stage.report(0.0);
    Sampling sampling = compute_shell_points(mesh, grid, stage);
    if (stage.stopped()) return stopped();
    const std::size_t count = sampling.points.size();
    const std::size_t voxels = sampling.voxels;
    if (best.points.empty() || miss(count) < miss(best.points.size())) best = std::move(sampling);
    // A tenth of the tolerance is soon found on large shells and keeps repeated asks alike.
    const double good_enough = trial < 16 ? 0.1 * kTolerance : kTolerance;
    if (miss(best.points.size()) <= good_enough * wanted) return best;

    // Finer voxels would only give more points that float32 cannot tell apart.
    constexpr std::size_t kMostVoxelsAPoint = 4;
    if (count < target && voxels > kMostVoxelsAPoint * target) break;

    const double ratio = static_cast<double>(count) / wanted;
    if (odd_grids > 0) {
      grid = make_odd_grid(grid.spacing * std::sqrt(std::sqrt(ratio)), odd_grids++);
      continue;
    }
    (count > target ? too_fine : too_coarse) = grid.spacing;
    if (too_fine == 0.0 || too_coarse == 0.0) {
      grid.spacing *= std::max(0.5, std::sqrt(ratio)) * (count > target ? 1.01 : 0.99);
      continue;
    }
    grid.spacing = std::sqrt(too_fine * too_coarse);
    constexpr double kStepWidth = 1e-4;
    if (std::abs(too_coarse - too_fine) < kStepWidth * too_fine) {
      grid = make_odd_grid(grid.spacing, odd_grids++);
    }
  }
  return Error{ErrorCode::kInvalidArgument,
               format_text("no voxel size gives %zu points within 1 %% on this mesh; the nearest "
                           "count found is %zu: ask for that, or for a spacing",
                           target, best.points.size())};
}

}  // namespace

Result<std::monostate> PointShell::check(const TriangleMesh& mesh,
                                         const PointShellSettings& settings) {
  const bool by_spacing = settings.spacing != 0.0;
  if (by_spacing == (settings.target_points != 0)) {
    return Error{ErrorCode::kInvalidArgument,
                 "give either a point spacing or a number of target points"};
  }
  if (by_spacing && (!(settings.spacing > 0.0) || !std::isfinite(settings.spacing))) {
    return Error{ErrorCode::kInvalidArgument,
                 format_text("point spacing must be above 0 m, not %g", settings.spacing)};
  }
  const double area = mesh.compute_area();
  const double longest = mesh.bounds().extents()[mesh.bounds().longest_axis()];
  const auto limit = static_cast<double>(settings.point_limit);
  // A wire has no area to speak of, but passes a voxel a spacing.
  const double expected =
      by_spacing ? std::max(kVoxelsPerArea * area / (settings.spacing * settings.spacing),
                            longest / settings.spacing)
                 : static_cast<double>(settings.target_points);
  if (expected > limit) {
    constexpr double kSafety = 1.2;  // how far the estimate may be below the number found
    return Error{ErrorCode::kTooLarge,
                 format_text("a point shell of about %.3g points is above the limit of %zu; use a "
                             "spacing of at least %.3g m",
                             expected, settings.point_limit,
                             std::max(std::sqrt(kSafety * kVoxelsPerArea * area / limit),
                                      kSafety * longest / limit))};
  }
  return std::monostate{};
}

Result<PointShell> PointShell::build(const TriangleMesh& mesh, const PointShellSettings& settings,
                                     const Progress& progress) {
  if (auto checked = check(mesh, settings); !checked) return checked.error();

  Stage stage(progress, "point shell");
  Sampling sampling;
  if (settings.target_points == 0) {
    sampling = compute_shell_points(mesh, {settings.spacing, {}}, stage);
  } else {
    auto found = search_target(mesh, settings.target_points, stage);
    if (!found) return found.error();
    sampling = *std::move(found);
    stage.set_part(0.0, 1.0);
  }
  stage.report(1.0);
  if (stage.stopped()) return stopped();

  std::vector<Vec3f> points;
  points.reserve(sampling.points.size());
  for (const ShellPoint& p : sampling.points) points.push_back(p.point);
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);

  PointShell shell;
  shell.spacing_ = sampling.spacing;
  shell.tree_ = PointSphereTree::build(points, order, progress);
  if (shell.tree_.point_count() == 0) return stopped();
  shell.points_.reserve(order.size());
  shell.normals_.reserve(order.size());
  shell.areas_.reserve(order.size());
  for (const std::uint32_t id : order) {
    shell.points_.push_back(sampling.points[id].point);
    shell.normals_.push_back(sampling.points[id].normal);
    shell.areas_.push_back(static_cast<float>(sampling.points[id].area));
  }
  return shell;
}

}  // namespace voxshell
