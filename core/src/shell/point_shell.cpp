#include "voxshell/point_shell.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/text.h"
#include "shell/surface_voxels.h"

namespace voxshell {
namespace {

struct ShellPoint {
  Vec3f point;
  Vec3f normal;
  double area;
};

/// Rounds samples to float32 and merges those that then share a place.
std::vector<ShellPoint> compute_shell_points(const TriangleMesh& mesh, double spacing) {
  std::vector<ShellPoint> shell_points;
  for (const SurfaceSample& sample : sample_surface_voxels(mesh, spacing)) {
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
  shell_points.resize(kept);
  return shell_points;
}

/// Surface voxels per spacing^2 of surface, on average over its orientations.
constexpr double kVoxelsPerArea = 1.5;

struct Sampling {
  std::vector<ShellPoint> points;
  double spacing = 0.0;
};

/// Finds the spacing that gives a wanted number of points. The number falls with the spacing, but
/// not smoothly, so after a bisection nearby spacings are tried as well.
Result<Sampling> search_target(const TriangleMesh& mesh, std::size_t target,
                               const Progress& progress) {
  constexpr int kMaxTrials = 64;
  constexpr double kTolerance = 0.01;
  const auto wanted = static_cast<double>(target);
  double spacing = std::sqrt(kVoxelsPerArea * mesh.compute_area() / wanted);
  double too_fine = 0.0;
  double too_coarse = 0.0;
  Sampling best;
  const auto miss = [&](std::size_t points) {
    return std::abs(static_cast<double>(points) - wanted);
  };
  for (int trial = 0; trial < kMaxTrials; ++trial) {
    if (progress && !progress("point shell", static_cast<double>(trial) / kMaxTrials)) {
      return Error{ErrorCode::kCancelled, "sampling the point shell was stopped"};
    }
    std::vector<ShellPoint> points = compute_shell_points(mesh, spacing);
    const std::size_t count = points.size();
    if (best.points.empty() || miss(count) < miss(best.points.size())) {
      best = {std::move(points), spacing};
    }
    // A tenth of the tolerance is soon found on large shells and keeps repeated asks alike.
    const double good_enough = trial < 16 ? 0.1 * kTolerance : kTolerance;
    if (miss(best.points.size()) <= good_enough * wanted) return best;
    (count > target ? too_fine : too_coarse) = spacing;
    if (too_fine == 0.0 || too_coarse == 0.0) {
      spacing *= std::sqrt(static_cast<double>(count) / wanted) * (count > target ? 1.01 : 0.99);
    } else if (std::abs(too_coarse - too_fine) > 1e-6 * too_fine) {
      spacing = std::sqrt(too_fine * too_coarse);
    } else {
      // The count jumps over the target here: widen the bracket and look beside the jump.
      const double widen = 1.0 + 0.002 * static_cast<double>(trial);
      too_fine /= widen;
      too_coarse *= widen;
      spacing = std::sqrt(too_fine * too_coarse) * (trial % 2 == 0 ? widen : 1.0 / widen);
    }
  }
  return Error{ErrorCode::kInvalidArgument,
               format_text("no voxel size gives %zu points within 1 %% on this mesh; the nearest "
                           "count found is %zu: ask for that, or for a spacing",
                           target, best.points.size())};
}

}  // namespace

Result<PointShell> PointShell::build(const TriangleMesh& mesh, const PointShellSettings& settings,
                                     const Progress& progress) {
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
  const double expected = by_spacing ? kVoxelsPerArea * area / (settings.spacing * settings.spacing)
                                     : static_cast<double>(settings.target_points);
  if (expected > static_cast<double>(settings.point_limit)) {
    return Error{ErrorCode::kTooLarge,
                 format_text("a point shell of about %.3g points is above the limit of %zu; use a "
                             "spacing of at least %.2g m",
                             expected, settings.point_limit,
                             std::sqrt(1.1 * kVoxelsPerArea * area /
                                       static_cast<double>(settings.point_limit)))};
  }

  Sampling sampling;
  if (by_spacing) {
    sampling = {compute_shell_points(mesh, settings.spacing), settings.spacing};
  } else {
    auto found = search_target(mesh, settings.target_points, progress);
    if (!found) return found.error();
    sampling = *std::move(found);
  }
  if (progress && !progress("point-sphere tree", 0.0)) {
    return Error{ErrorCode::kCancelled, "building the point-sphere tree was stopped"};
  }

  std::vector<Vec3f> points;
  points.reserve(sampling.points.size());
  for (const ShellPoint& p : sampling.points) points.push_back(p.point);
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);

  PointShell shell;
  shell.spacing_ = sampling.spacing;
  shell.tree_ = PointSphereTree::build(points, order);
  shell.points_.reserve(order.size());
  shell.normals_.reserve(order.size());
  shell.areas_.reserve(order.size());
  for (const std::uint32_t id : order) {
    shell.points_.push_back(sampling.points[id].point);
    shell.normals_.push_back(sampling.points[id].normal);
    shell.areas_.push_back(static_cast<float>(sampling.points[id].area));
  }
  if (progress) progress("point-sphere tree", 1.0);
  return shell;
}

}  // namespace voxshell
