#pragma once

#include <cstdint>
#include <vector>

#include "voxshell/pose.h"
#include "voxshell/progress.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// One side of the surface within one voxel.
struct SurfaceSample {
  Vec3 point;              ///< closest to the voxel's center of this side of the surface within it
  Vec3f to_middle;         ///< from `point` to well within the part of the triangle in the voxel
  std::uint32_t triangle;  ///< the triangle that it lies on
  double area;             ///< of this side, m2
};

/// A regular grid of voxels about a mesh.
struct VoxelGrid {
  double spacing;          ///< edge of a voxel, meters
  Matrix3 grid_from_mesh;  ///< a rotation: its rows are the grid's axes
  Vec3 shift{};            ///< of the grid from being centered on the mesh's bounds, voxels
};

/// Surfaces face away from each other where the cosine of the angle between their normals is below
/// this: beyond a right angle by more than what the rounding of a mesh's corners makes of one.
constexpr double kFacesAway = -1e-3;

/// The outward unit normal of a triangle; zero for a needle, narrower than a billionth of its
/// length, whose normal would be mere rounding.
Vec3 compute_triangle_normal(const Vec3& a, const Vec3& b, const Vec3& c);

/// Area times the expected number of voxels that a unit of area passes, m2: of |n| along the grid's
/// axes the sum. Divided by spacing^2 it is how many voxels a surface that is flat within most
/// voxels passes.
double compute_passed_area(const TriangleMesh& mesh, const Matrix3& grid_from_mesh);

/// Cuts a mesh along a grid and samples each voxel that the surface passes: the point closest to
/// its center and, where part of the surface within the voxel faces away from that one, the closest
/// of that part, and so on; no more than four directions face away from one another. Needles face
/// nowhere, and give a sample only to voxels with nothing else.
///
/// Neighbors are near each other in the order, which is the same for any number of threads. Empty
/// where progress asked to stop.
std::vector<SurfaceSample> sample_surface_voxels(const TriangleMesh& mesh, const VoxelGrid& grid,
                                                 unsigned threads = 0,
                                                 const Progress& progress = {});

}  // namespace voxshell
