#pragma once

#include <vector>

#include "field/brick_grid.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// One flag a brick: 1 where the mesh passes through it or within `margin` voxels, measured along
/// each axis.
std::vector<char> find_surface_bricks(const TriangleMesh& mesh, const BrickGrid& grid,
                                      double margin);

}  // namespace voxshell
