#include "field/brick_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <utility>

#include "base/text.h"
#include "field/brick_entry.h"
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
/// Others than fine ones share corners, or have 28 or 128; on average, in the bunny's fields, 4 to
/// 15.
constexpr double kSamplesOfBrick = 16.0;
constexpr double kSamplesOfFineBrick = 732.0;

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

/// The size of a field to build.
struct Demand {
  double bricks = 0.0;
  double fine_bricks = 0.0;
  double longest = 0.0;  ///< cells along the longest side

  double bytes() const { return kBytesOfBrick * bricks + kBytesOfFineBrick * fine_bricks; }
  double samples() const {
    return kSamplesOfBrick * bricks + (kSamplesOfFineBrick - kSamplesOfBrick) * fine_bricks;
  }
  bool fits(std::size_t memory_limit) const {
    constexpr double kMostSamples = static_cast<double>(kMostPayloads * simd::kSampleAlignment);
    return bytes() <= static_cast<double>(memory_limit) && samples() <= kMostSamples &&
           longest <= kMostCells;
  }
};

/// Without fine bricks.
Demand outline_demand(const TriangleMesh& mesh, double padding, double voxel_size) {
  const Outline outline = make_outline(mesh.bounds(), padding, voxel_size);
  return {outline.count(), 0.0, outline.longest()};
}

struct Estimate {
  BrickGridPlan plan;  ///< without its fine bricks where it is too large even without them
  Demand demand;
  bool fits = false;
};

Estimate estimate(const TriangleMesh& mesh, double padding, double voxel_size,
                  std::size_t memory_limit) {
  Estimate estimate;
  estimate.demand = outline_demand(mesh, padding, voxel_size);
  if (!estimate.demand.fits(memory_limit)) return estimate;
  estimate.plan.grid = make_outline(mesh.bounds(), padding, voxel_size).grid(voxel_size);
  estimate.plan.least_cells = find_least_cells(mesh, estimate.plan.grid);
  estimate.demand.fine_bricks =
      static_cast<double>(std::ranges::count(estimate.plan.least_cells, kBrickCells));
  estimate.fits = estimate.demand.fits(memory_limit);
  return estimate;
}

/// The number that a text with three digits says.
double with_three_digits(double value) {
  return std::strtod(format_text("%.3g", value).c_str(), nullptr);
}

/// A voxel size of three digits that fits, or the mesh's longest side. Looks at few grids, as they
/// may be large.
double advise_voxel_size(const TriangleMesh& mesh, const GridFieldSettings& settings) {
  constexpr double kStep = 1.04;
  constexpr double kBricksToProbe = 1e6;
  const double too_coarse = mesh.bounds().extents()[mesh.bounds().longest_axis()];
  const double longest = outline_demand(mesh, settings.padding, settings.voxel_size).longest;
  const double least = settings.voxel_size * std::max(1.0, longest / kMostCells);
  double probed = least;
  while (probed < too_coarse &&
         outline_demand(mesh, settings.padding, probed).bricks > kBricksToProbe) {
    probed *= kStep;
  }
  const auto probe = estimate(mesh, settings.padding, probed, SIZE_MAX);
  // Fine bricks become fewer with the square of their size.
  const auto expect = [&](double voxel_size) {
    Demand demand = outline_demand(mesh, settings.padding, voxel_size);
    const double smaller = probed / voxel_size;
    demand.fine_bricks = std::min(probe.demand.fine_bricks * smaller * smaller, demand.bricks);
    return demand;
  };
  double advised = least;
  while (advised < too_coarse && !expect(advised).fits(settings.memory_limit)) advised *= kStep;
  advised = with_three_digits(advised);
  while (advised < too_coarse &&
         !estimate(mesh, settings.padding, advised, settings.memory_limit).fits) {
    advised = with_three_digits(advised * kStep);
  }
  return advised;
}

/// Settings to use instead of those that are too large, in words.
std::string advise(const TriangleMesh& mesh, GridFieldSettings settings, double longest_side) {
  std::string advice;
  // It is the padding's size then, and no finer voxel's.
  if (settings.padding > longest_side) {
    settings.padding = with_three_digits(longest_side);
    advice = format_text("a padding of at most %.3g m", settings.padding);
    if (estimate(mesh, settings.padding, settings.voxel_size, settings.memory_limit).fits) {
      return advice;
    }
    advice += " and ";
  }
  const double voxel_size = advise_voxel_size(mesh, settings);
  return advice + format_text("a voxel size of at least %.3g m (a resolution of at most %.0f)",
                              voxel_size, std::floor(longest_side / voxel_size));
}

Error too_large(const Demand& refused, const TriangleMesh& mesh,
                const GridFieldSettings& settings) {
  const double longest_side = mesh.bounds().extents()[mesh.bounds().longest_axis()];
  return {ErrorCode::kTooLarge,
          format_text("a distance field of voxel size %.3g m and padding %.3g m, of a mesh whose "
                      "longest side is %.3g m, would need %.3g GB or more to build (%.3g voxels "
                      "along its longest side); use %s",
                      settings.voxel_size, settings.padding, longest_side, refused.bytes() / 1e9,
                      refused.longest, advise(mesh, settings, longest_side).c_str())};
}

}  // namespace

std::vector<std::uint8_t> find_least_cells(const TriangleMesh& mesh, const BrickGrid& grid) {
  std::vector<std::uint8_t> least(grid.count(), 1);
  for (int i = simd::kCoarseSizes - 1; i >= 0; --i) {
    const auto near = find_surface_bricks(mesh, grid, kLeastFloors[static_cast<std::size_t>(i)]);
    for (std::size_t brick = 0; brick < least.size(); ++brick) {
      if (near[brick] != 0) least[brick] = static_cast<std::uint8_t>(kBrickCells >> i);
    }
  }
  return least;
}

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
  if (!planned.fits) return too_large(planned.demand, mesh, settings);
  return std::move(planned.plan);
}

}  // namespace voxshell
