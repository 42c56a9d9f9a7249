#include "field/brick_grid.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/text.h"
#include "field/surface_bricks.h"
#include "simd/grid_view.h"

namespace voxshell {
namespace {

using simd::kBrickCells;

/// Cells along one axis beyond which positions would no longer be exact enough in float32.
constexpr double kMostCells = 8192.0;

/// Bytes while building: entries, bounds and a few samples of each brick, and what decides on them;
/// the samples of a fine one. Builds of hundreds of megabytes have needed three quarters of this.
constexpr double kBytesOfBrick = 128.0;
constexpr double kBytesOfFineBrick = 1500.0;
/// As many samples as entries can number, in fine bricks.
constexpr double kMostFineBricks = 150'000.0;

/// The bricks that a voxel size asks for, counted in float64 as they may be very many.
struct Outline {
  Vec3 origin;
  Vec3 bricks;  ///< along x, y, z

  double count() const { return bricks.x * bricks.y * bricks.z; }
  double longest() const { return kBrickCells * std::max({bricks.x, bricks.y, bricks.z}); }
  BrickGrid grid(double voxel_size) const {
    return {origin,
            voxel_size,
            {static_cast<std::size_t>(bricks.x), static_cast<std::size_t>(bricks.y),
             static_cast<std::size_t>(bricks.z)}};
  }
};

Outline make_outline(const Bounds& surface_bounds, double padding, double voxel_size) {
  const double brick = kBrickCells * voxel_size;
  const double kept = std::max(padding, brick);
  Outline outline{surface_bounds.lower - Vec3{kept, kept, kept}, {}};
  for (int axis = 0; axis < 3; ++axis) {
    outline.bricks[axis] = std::ceil((surface_bounds.extents()[axis] + 2.0 * kept) / brick);
  }
  return outline;
}

/// A plan, and what it will take to build it. Without its fine bricks, where it is too large even
/// without them.
struct Estimate {
  BrickGridPlan plan;
  double fine_bricks = 0.0;
  double bytes = 0.0;
  bool fits = false;
};

Estimate estimate(const TriangleMesh& mesh, double padding, double voxel_size,
                  std::size_t memory_limit) {
  const Outline outline = make_outline(mesh.bounds(), padding, voxel_size);
  const auto limit = static_cast<double>(memory_limit);
  Estimate estimate;
  estimate.bytes = kBytesOfBrick * outline.count();
  if (!(estimate.bytes <= limit) || !(outline.longest() <= kMostCells)) return estimate;
  estimate.plan.grid = outline.grid(voxel_size);
  estimate.plan.is_fine = find_surface_bricks(mesh, estimate.plan.grid, kFineMargin);
  estimate.fine_bricks = static_cast<double>(
      std::count(estimate.plan.is_fine.begin(), estimate.plan.is_fine.end(), char{1}));
  estimate.bytes += kBytesOfFineBrick * estimate.fine_bricks;
  estimate.fits = estimate.bytes <= limit && estimate.fine_bricks <= kMostFineBricks;
  return estimate;
}

Error too_large(const Estimate& refused, const TriangleMesh& mesh,
                const GridFieldSettings& settings) {
  const double longest =
      make_outline(mesh.bounds(), settings.padding, settings.voxel_size).longest();
  const double by_memory = std::sqrt(refused.bytes / static_cast<double>(settings.memory_limit));
  double advised =
      settings.voxel_size * std::max({1.0, std::cbrt(by_memory), longest / kMostCells});
  // The outermost bricks do not become fewer with larger voxels.
  const double too_coarse = mesh.bounds().extents()[mesh.bounds().longest_axis()];
  while (advised < too_coarse &&
         !estimate(mesh, settings.padding, advised, settings.memory_limit).fits) {
    advised *= 1.04;
  }
  // The last factor outweighs the rounding of the text.
  return {ErrorCode::kTooLarge,
          format_text("a distance field of voxel size %.3g m would need %.3g GB or more to build "
                      "(%.3g voxels along its longest side); use a voxel size of at least %.3g m",
                      settings.voxel_size, refused.bytes / 1e9, longest, 1.006 * advised)};
}

}  // namespace

Result<BrickGridPlan> plan_brick_grid(const TriangleMesh& mesh, const GridFieldSettings& settings) {
  if (!(settings.voxel_size > 0.0) || !std::isfinite(settings.voxel_size)) {
    return Error{ErrorCode::kInvalidArgument,
                 format_text("voxel size must be above 0 m, not %g", settings.voxel_size)};
  }
  if (!(settings.padding >= 0.0) || !std::isfinite(settings.padding)) {
    return Error{ErrorCode::kInvalidArgument,
                 format_text("padding must be at least 0 m, not %g", settings.padding)};
  }
  Estimate planned = estimate(mesh, settings.padding, settings.voxel_size, settings.memory_limit);
  if (!planned.fits) return too_large(planned, mesh, settings);
  return std::move(planned.plan);
}

}  // namespace voxshell
