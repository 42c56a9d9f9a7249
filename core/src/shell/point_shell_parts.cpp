#include <cmath>
#include <utility>

#include "base/text.h"
#include "shell/point_checks.h"
#include "voxshell/point_shell.h"

namespace voxshell {
namespace {

constexpr float kLargestArea = 1e20f;  // m2

Error invalid(std::string message) { return {ErrorCode::kInvalidArgument, std::move(message)}; }

}  // namespace

Result<PointShell> PointShell::from_parts(Parts parts) {
  const BucketPoints points = parts.tree.points();
  const std::size_t count = points.size();
  if (count == 0 || parts.normals.size() != count || parts.areas.size() != count) {
    return invalid(format_text("there are %zu points, %zu normals and %zu areas", count,
                               parts.normals.size(), parts.areas.size()));
  }
  if (!(parts.spacing > 0.0) || !std::isfinite(parts.spacing)) {
    return invalid(format_text("the spacing is %g m", parts.spacing));
  }
  for (std::size_t i = 0; i < count; ++i) {
    if (!is_place(points[i])) {
      return invalid(format_text("point %zu is not finite, or too far away", i));
    }
    if (!is_direction(parts.normals[i])) {
      return invalid(format_text("the normal of point %zu is not of unit length", i));
    }
    if (!(parts.areas[i] >= 0.0f && parts.areas[i] <= kLargestArea)) {
      return invalid(
          format_text("the area of point %zu is %g m2", i, static_cast<double>(parts.areas[i])));
    }
  }
  PointShell shell;
  shell.normals_ = std::move(parts.normals);
  shell.areas_ = std::move(parts.areas);
  shell.spacing_ = parts.spacing;
  shell.tree_ = std::move(parts.tree);
  shell.edges_ = std::move(parts.edges);
  return shell;
}

std::uint32_t PointShell::segment_of(std::uint32_t id, int level) const {
  if (is_point(id)) return tree_.segment(id, level);
  const auto clusters = static_cast<std::uint32_t>(PointSphereTree::cluster_count(level));
  return clusters + edges()->tree().segment(id - tree_.point_count(), level);
}

PointRange PointShell::segment_elements(int level, std::uint32_t segment) const {
  const auto clusters = static_cast<std::uint32_t>(PointSphereTree::cluster_count(level));
  if (segment < clusters) return tree_.cluster_points(level, segment);
  const PointRange range = edges()->tree().cluster_points(level, segment - clusters);
  return {tree_.point_count() + range.begin, tree_.point_count() + range.end};
}

}  // namespace voxshell
