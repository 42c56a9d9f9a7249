#pragma once

#include <cstdint>
#include <vector>

#include "base/stage.h"
#include "voxshell/pose.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// The surface within one voxel, as one sample.
struct SurfaceSample {
  Vec3 point;              ///< closest to the voxel's centre of the surface within the voxel
  std::uint32_t triangle;  ///< the triangle that it lies on
  double area;             ///< of the surface within the voxel, m2
};

/// A regular grid of voxels about a mesh.
struct VoxelGrid {
  double spacing;          ///< edge of a voxel, metres
  Matrix3 grid_from_mesh;  ///< a rotation: its rows are the grid's axes
  Vec3 shift{};            ///< of the grid from being centred on the mesh's bounds, voxels
};

/// Cuts a mesh along a grid and samples each voxel that the surface passes through. Ordered by
/// voxel, x fastest.
std::vector<SurfaceSample> sample_surface_voxels(const TriangleMesh& mesh, const VoxelGrid& grid,
                                                 Stage& stage);

/// The same without anybody who watches.
inline std::vector<SurfaceSample> sample_surface_voxels(const TriangleMesh& mesh,
                                                        const VoxelGrid& grid) {
  const Progress nobody;
  Stage stage(nobody, "");
  return sample_surface_voxels(mesh, grid, stage);
}

}  // namespace voxshell
