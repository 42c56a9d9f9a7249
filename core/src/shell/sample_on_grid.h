#pragma once

#include "base/stage.h"
#include "shell/shell_samples.h"
#include "shell/surface_voxels.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// Outward unit normal; not a number if the triangle has no area.
Vec3 normal_of_triangle(const TriangleMesh& mesh, std::uint32_t triangle);

/// Samples a mesh with one point per surface voxel of a grid, and more where sides of the surface
/// within a voxel face away from each other. No two points share a place. Deterministic; once the
/// stage is stopped, the result has no meaning.
ShellSamples sample_on_grid(const TriangleMesh& mesh, const VoxelGrid& grid, unsigned threads,
                            Stage& stage);

}  // namespace voxshell
