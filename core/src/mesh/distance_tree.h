#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "simd/mesh_distance.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// Distances to a mesh from the nodes of a grid, eight triangles at a time, in float32: to 1e-3
/// voxel in a grid of up to 8192 voxels along a side, to 1e-5 near triangles of a few voxels.
/// Lengths in voxels, positions from the grid's origin.
class DistanceTree {
 public:
  /// `origin` in meters, the mesh's frame.
  DistanceTree(const TriangleMesh& mesh, const Vec3& origin, double voxel_size, unsigned threads);

  struct Nearest {
    float distance;
    std::uint32_t triangle;
    std::int32_t guess;  ///< for a point close by
  };
  /// Makes the search short; 0 will do.
  Nearest find_nearest(const Vec3& p, std::int32_t guess) const;
  /// Guesses for points close to each triangle.
  std::vector<std::int32_t> list_guesses() const;

  /// Puts triangles into `found` that come within `radius` of p, and some others near. False where
  /// they would be more than `most`.
  bool find_within(const Vec3& p, double radius, std::size_t most,
                   std::vector<std::uint32_t>& found) const;

  /// Working memory of one thread that measures bricks.
  struct Scratch {
    std::unique_ptr<std::int32_t[]> indices;
    std::unique_ptr<float[]> floats;
  };
  /// Distances of 9^3 nodes a voxel apart, x fastest, with `center` in the middle, whose own
  /// distance is `at_center`.
  void measure_brick(const Vec3& center, float at_center, Scratch& scratch,
                     std::span<float> distances) const;

  simd::MeshTreeView view() const;

 private:
  void order_triangles(const TriangleMesh& mesh, unsigned threads);
  std::int32_t build_node(std::size_t first_block, std::size_t blocks,
                          const std::vector<Bounds>& of);

  std::vector<std::uint32_t> order_;  ///< triangles, block by block
  std::vector<simd::BoxNode> nodes_;
  std::vector<float> blocks_;
  std::vector<float> centers_;
  float slack_ = 0.0f;
};

}  // namespace voxshell
