#pragma once

#include <array>
#include <cstddef>
#include <vector>

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
  std::vector<char> is_fine;  ///< one a brick: whether it has a node a voxel
};

/// The grid that settings ask for. Errors: kInvalidArgument, kTooLarge.
Result<BrickGridPlan> plan_brick_grid(const TriangleMesh& mesh, const GridFieldSettings& settings);

/// Bricks that come this near to the surface along each axis are fine, voxels: no coarse one comes
/// nearer, or has a value nearer to zero.
inline constexpr double kFineMargin = 0.125;

}  // namespace voxshell
