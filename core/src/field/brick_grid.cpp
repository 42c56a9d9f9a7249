#include "field/brick_grid.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "field/brick_entry.h"

namespace voxshell {
namespace {

using simd::kBrickCells;

/// Cells along one axis beyond which positions would no longer be exact enough in float32.
constexpr double kMostCells = 8192.0;

/// The bricks that a voxel size asks for, counted in float64 as they may be very many.
struct Plan {
  Vec3 origin;
  Vec3 bricks;  ///< along x, y, z

  double bytes() const {
    const double of_brick = 2.0 * sizeof(std::uint32_t) + sizeof(std::int16_t) * (cube(9) + 3);
    return bricks.x * bricks.y * bricks.z * of_brick;
  }
  double longest() const { return kBrickCells * std::max({bricks.x, bricks.y, bricks.z}); }
  bool fits(std::size_t memory_limit) const {
    return bytes() <= static_cast<double>(memory_limit) && longest() <= kMostCells;
  }
};

Plan make_plan(const Bounds& surface_bounds, double padding, double voxel_size) {
  const double brick = kBrickCells * voxel_size;
  const double kept = std::max(padding, brick);
  Plan plan{surface_bounds.lower - Vec3{kept, kept, kept}, {}};
  for (int axis = 0; axis < 3; ++axis) {
    plan.bricks[axis] = std::ceil((surface_bounds.extents()[axis] + 2.0 * kept) / brick);
  }
  return plan;
}

Error too_large(const Plan& plan, const Bounds& surface_bounds, const GridFieldSettings& settings) {
  const double by_memory = std::cbrt(plan.bytes() / static_cast<double>(settings.memory_limit));
  const double by_axis = plan.longest() / kMostCells;
  double advised = settings.voxel_size * std::max(by_memory, by_axis);
  // The outermost bricks do not become fewer with larger voxels.
  const double too_coarse = surface_bounds.extents()[surface_bounds.longest_axis()];
  while (advised < too_coarse &&
         !make_plan(surface_bounds, settings.padding, advised).fits(settings.memory_limit)) {
    advised *= 1.01;
  }
  // The last factor outweighs the rounding of the text.
  return {ErrorCode::kTooLarge,
          format_text("a distance field of voxel size %.3g m would need %.3g GB (%.3g voxels along "
                      "its longest side); use a voxel size of at least %.3g m",
                      settings.voxel_size, plan.bytes() / 1e9, plan.longest(), 1.006 * advised)};
}

}  // namespace

Result<BrickGrid> plan_brick_grid(const Bounds& surface_bounds, const GridFieldSettings& settings) {
  if (!(settings.voxel_size > 0.0) || !std::isfinite(settings.voxel_size)) {
    return Error{ErrorCode::kInvalidArgument,
                 format_text("voxel size must be above 0 m, not %g", settings.voxel_size)};
  }
  if (!(settings.padding >= 0.0) || !std::isfinite(settings.padding)) {
    return Error{ErrorCode::kInvalidArgument,
                 format_text("padding must be at least 0 m, not %g", settings.padding)};
  }
  const Plan plan = make_plan(surface_bounds, settings.padding, settings.voxel_size);
  if (!plan.fits(settings.memory_limit)) return too_large(plan, surface_bounds, settings);
  return BrickGrid{
      plan.origin,
      settings.voxel_size,
      {static_cast<std::size_t>(plan.bricks.x), static_cast<std::size_t>(plan.bricks.y),
       static_cast<std::size_t>(plan.bricks.z)}};
}

}  // namespace voxshell
