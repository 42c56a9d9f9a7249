#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "simd/grid_view.h"
#include "voxshell/grid_field.h"
#include "voxshell/result.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// Where the bricks of a grid lie.
struct BrickGrid {
  Vec3 origin;
  double voxel_size;
  std::array<std::size_t, 3> bricks;  ///< along x, y, z

  std::size_t count() const { return bricks[0] * bricks[1] * bricks[2]; }
  std::array<std::size_t, 3> place(std::size_t brick) const {
    return {brick % bricks[0], brick / bricks[0] % bricks[1], brick / (bricks[0] * bricks[1])};
  }
  Vec3 node(std::size_t x, std::size_t y, std::size_t z) const {
    return origin + voxel_size * Vec3{static_cast<double>(x), static_cast<double>(y),
                                      static_cast<double>(z)};
  }
};

struct BrickGridPlan {
  BrickGrid grid;
  std::vector<std::uint8_t> least_cells;  ///< one a brick: along each axis
};

/// The grid that settings ask for. Errors: kInvalidArgument, kTooLarge.
Result<BrickGridPlan> plan_brick_grid(const TriangleMesh& mesh, const GridFieldSettings& settings);

/// Bricks with cells of 2, 4 and 8 voxels, or larger, stay this far away from the surface along
/// some axis, voxels: queries at a margin below need not reckon with such cells.
inline constexpr std::array<double, simd::kCoarseSizes> kLeastFloors{0.5, 1.0, 4.0};
/// The least cells of bricks about a surface.
std::vector<std::uint8_t> find_least_cells(const TriangleMesh& mesh, const BrickGrid& grid);

}  // namespace voxshell
