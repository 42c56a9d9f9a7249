#include "voxshell/point_shell.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "base/stage.h"
#include "base/text.h"
#include "mesh/surface_cutter.h"
#include "shell/sample_by_target.h"
#include "shell/sample_by_tolerance.h"
#include "shell/sample_on_grid.h"
#include "shell/surface_voxels.h"
#include "voxshell/parallel.h"

namespace voxshell {

Result<std::monostate> PointShell::check(const TriangleMesh& mesh,
                                         const PointShellSettings& settings) {
  const bool by_spacing = settings.spacing != 0.0;
  if (settings.tolerance != 0.0) {
    if (by_spacing || settings.target_points != 0) {
      return Error{ErrorCode::kInvalidArgument,
                   "give a tolerance, a point spacing or a number of target points, not several"};
    }
    if (settings.tolerance > 0.0 && std::isfinite(settings.tolerance)) return std::monostate{};
    return Error{ErrorCode::kInvalidArgument,
                 format_text("tolerance must be above 0 m, not %g", settings.tolerance)};
  }
  if (by_spacing == (settings.target_points != 0)) {
    return Error{ErrorCode::kInvalidArgument,
                 "give either a point spacing or a number of target points"};
  }
  if (by_spacing && (!(settings.spacing > 0.0) || !std::isfinite(settings.spacing))) {
    return Error{ErrorCode::kInvalidArgument,
                 format_text("point spacing must be above 0 m, not %g", settings.spacing)};
  }
  const double area = compute_passed_area(mesh, {});
  const double longest = mesh.bounds().extents()[mesh.bounds().longest_axis()];
  const std::size_t limit = std::min(settings.point_limit, PointShellSettings::kMostPoints);
  // A wire has no area to speak of, but passes a voxel a spacing.
  const double expected = by_spacing ? std::max(area / (settings.spacing * settings.spacing),
                                                longest / settings.spacing)
                                     : static_cast<double>(settings.target_points);
  if (expected > static_cast<double>(limit)) {
    constexpr double kSafety = 1.2;  // how far the estimate may be below the number found
    const double fits = std::max(std::sqrt(kSafety * area / static_cast<double>(limit)),
                                 kSafety * longest / static_cast<double>(limit));
    return Error{ErrorCode::kTooLarge,
                 format_text("a point shell of about %.3g points is above the limit of %zu; ",
                             expected, limit) +
                     (by_spacing ? format_text("use a point spacing of at least %.3g m", fits)
                                 : "ask for no more points")};
  }
  return std::monostate{};
}

PointShell PointShell::with_points(std::span<const Vec3f> points, std::span<const Vec3f> normals,
                                   unsigned threads) const {
  std::vector<Vec3f> all;
  all.reserve(size() + points.size());
  for (const Vec3f& point : this->points()) all.push_back(point);
  std::vector<Vec3f> normals_of_all = normals_;
  const auto as_array = [](const Vec3f& p) { return std::array{p.x, p.y, p.z}; };
  std::vector<Vec3f> taken = all;
  std::ranges::sort(taken, {}, as_array);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::ranges::binary_search(taken, as_array(points[i]), {}, as_array)) continue;
    all.push_back(points[i]);
    normals_of_all.push_back(normals[i]);
  }
  std::vector<std::uint32_t> order(all.size());
  std::iota(order.begin(), order.end(), 0u);

  PointShell shell;
  shell.spacing_ = spacing_;
  shell.edges_ = edges_;
  shell.tree_ = PointSphereTree::build(all, order, {}, threads, normals_of_all);
  for (const std::uint32_t i : order) {
    shell.normals_.push_back(normals_of_all[i]);
    shell.areas_.push_back(i < size() ? areas_[i] : 0.0f);
  }
  return shell;
}

Result<PointShell> PointShell::build(const TriangleMesh& mesh, const PointShellSettings& settings,
                                     const Progress& progress) {
  return build(mesh, nullptr, settings, progress);
}

Result<PointShell> PointShell::build(const TriangleMesh& mesh, const VisibleSurface* visible,
                                     const PointShellSettings& settings, const Progress& progress) {
  // Creases are those of the whole mesh, whose triangles know their neighbors.
  const bool by_tolerance = settings.tolerance != 0.0;
  const TriangleMesh& surface = visible != nullptr && !by_tolerance ? visible->mesh : mesh;
  if (auto checked = check(surface, settings); !checked) return checked.error();

  Stage stage(progress, "point shell");
  ShellSamples sampling;
  if (by_tolerance) {
    auto sampled = sample_by_tolerance(surface, visible, settings, stage);
    if (!sampled) return sampled.error();
    sampling = *std::move(sampled);
  } else if (settings.target_points == 0) {
    // Voxels of twice the surface's size and above hold all of it; far above, numbers overflow.
    const double size = length(surface.bounds().extents());
    sampling = sample_on_grid(surface, {std::min(settings.spacing, 2.0 * size), {}},
                              settings.threads, stage);
    sampling.spacing = settings.spacing;
  } else {
    auto found = sample_by_target(surface, settings.target_points, settings.threads, stage);
    if (!found) return found.error();
    sampling = *std::move(found);
    stage.set_part(0.0, 1.0);
  }
  stage.report(1.0);
  if (stage.stopped()) return make_stopped_error();

  std::vector<Vec3f> points(sampling.points.size());
  std::vector<Vec3f> normals(sampling.points.size());
  constexpr std::size_t kPointsPerTask = 1 << 14;
  const auto for_points = [&](const auto& visit) {
    const auto visit_range = [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) visit(i);
    };
    parallel_for_ranges(points.size(), kPointsPerTask, settings.threads, "point shell", {},
                        visit_range);
  };
  for_points([&](std::size_t i) {
    points[i] = sampling.points[i].point;
    normals[i] = sampling.normals.empty()
                     ? static_cast<Vec3f>(normal_of_triangle(surface, sampling.points[i].triangle))
                     : sampling.normals[i];
  });
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0u);

  PointShell shell;
  shell.spacing_ = sampling.spacing;
  shell.edges_ = std::move(sampling.edges);
  shell.tree_ = PointSphereTree::build(points, order, progress, settings.threads, normals);
  if (shell.tree_.point_count() == 0) return make_stopped_error();
  shell.normals_.resize(order.size());
  shell.areas_.resize(order.size());
  for_points([&](std::size_t i) {
    shell.normals_[i] = normals[order[i]];
    shell.areas_[i] = static_cast<float>(sampling.points[order[i]].area);
  });
  return shell;
}

}  // namespace voxshell
