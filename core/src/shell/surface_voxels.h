#pragma once

#include <cstdint>
#include <vector>

#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// The surface within one voxel, as one sample.
struct SurfaceSample {
  Vec3 point;              ///< closest to the voxel's centre of the surface within the voxel
  std::uint32_t triangle;  ///< the triangle that it lies on
  double area;             ///< of the surface within the voxel, m2
};

/// Cuts a mesh along a regular grid of voxels of edge `spacing` (centred on the mesh's bounds) and
/// samples each voxel that the surface passes through. Ordered by voxel, x fastest.
std::vector<SurfaceSample> sample_surface_voxels(const TriangleMesh& mesh, double spacing);

}  // namespace voxshell
