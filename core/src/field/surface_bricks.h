#pragma once

#include <array>
#include <span>
#include <vector>

#include "field/brick_grid.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// One flag a brick: 1 where a triangle passes through it or within `margin` voxels, measured along
/// each axis.
std::vector<char> find_surface_bricks(std::span<const std::array<Vec3, 3>> triangles,
                                      const BrickGrid& grid, double margin);
std::vector<char> find_surface_bricks(const TriangleMesh& mesh, const BrickGrid& grid,
                                      double margin);

}  // namespace voxshell
