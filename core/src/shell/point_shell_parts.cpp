#include <cmath>
#include <span>
#include <utility>

#include "base/finite.h"
#include "base/text.h"
#include "voxshell/point_shell.h"

namespace voxshell {
namespace {

constexpr float kLargestCoordinate = 1.001e9f;  // metres: a mesh's, rounded
constexpr float kLargestArea = 1e20f;           // m2

Error invalid(std::string message) { return {ErrorCode::kInvalidArgument, std::move(message)}; }

bool is_place(const Vec3f& p) {
  return are_within(coordinates(std::span(&p, 1)), kLargestCoordinate);
}

/// Zero where a surface faces nowhere.
bool is_direction(const Vec3f& normal) {
  constexpr float kTolerance = 1e-3f;
  return std::abs(squared_length(normal) - 1.0f) <= kTolerance || normal == Vec3f{};
}

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
  return shell;
}

}  // namespace voxshell
