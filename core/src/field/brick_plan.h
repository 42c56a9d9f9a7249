#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "field/brick_entry.h"
#include "field/brick_grid.h"
#include "field/flat_regions.h"
#include "mesh/distance_tree.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// Half the edge and half the diagonal of a brick, voxels.
inline constexpr double kHalfEdge = 0.5 * simd::kBrickCells;
inline constexpr double kHalfDiagonal = 1.7320508075688772 * kHalfEdge;

/// Signed distances at the corners of all bricks.
struct CornerLattice {
  std::array<std::size_t, 3> nodes;
  std::vector<float> distances;          ///< voxels
  std::vector<std::uint32_t> triangles;  ///< the nearest ones

  std::size_t index(std::size_t x, std::size_t y, std::size_t z) const {
    return x + nodes[0] * (y + nodes[1] * z);
  }
  std::size_t corner(const std::array<std::size_t, 3>& brick, std::size_t i) const {
    return index(brick[0] + (i & 1), brick[1] + (i >> 1 & 1), brick[2] + (i >> 2));
  }
  std::array<double, 8> corners_of(const std::array<std::size_t, 3>& brick) const {
    std::array<double, 8> corners{};
    for (std::size_t i = 0; i < 8; ++i) {
      corners[i] = static_cast<double>(distances[corner(brick, i)]);
    }
    return corners;
  }
};

/// How a brick is going to be held.
struct BrickPlan {
  std::int32_t cells = 0;    ///< along each axis; 0: as a plane
  std::uint32_t region = 0;  ///< of the mesh, whose plane it is
  float at_center = 0.0f;    ///< unsigned distance, voxels
  std::int32_t guess = 0;    ///< the block nearest to the center, for searches in the brick
};

/// The middle of a brick, voxels from the grid's origin.
inline Vec3 center_of(const std::array<std::size_t, 3>& brick) {
  const auto at = [&](std::size_t axis) {
    return static_cast<double>(simd::kBrickCells * brick[axis]) + kHalfEdge;
  };
  return {at(0), at(1), at(2)};
}

/// Says how bricks are to be held.
class BrickPlanner {
 public:
  BrickPlanner(const TriangleMesh& mesh, const BrickGrid& grid, const CornerLattice& lattice,
               const DistanceTree& tree, const FlatRegions& flat, double plane_tolerance)
      : mesh_(mesh),
        grid_(grid),
        lattice_(lattice),
        tree_(tree),
        flat_(flat),
        plane_tolerance_(plane_tolerance) {}

  /// Working memory of one thread that plans.
  struct Work {
    DistanceTree::Nearest nearest{};
    std::vector<std::uint32_t> nearby;
    DistanceTree::Scratch scratch;
    std::array<float, cube(simd::kBrickCells + 1)> nodes;
  };

  /// A brick has at least `least_cells` along each axis, unless it holds a plane.
  BrickPlan plan(const std::array<std::size_t, 3>& brick, int least_cells, Work& work) const;

 private:
  int choose_cells_at_ridges(const std::array<std::size_t, 3>& brick,
                             std::uint32_t nearest_to_center) const;
  bool is_plane(const std::array<std::size_t, 3>& brick, const std::array<double, 8>& corners,
                double at_center, std::uint32_t nearest, Work& work) const;

  const TriangleMesh& mesh_;
  const BrickGrid& grid_;
  const CornerLattice& lattice_;
  const DistanceTree& tree_;
  const FlatRegions& flat_;
  double plane_tolerance_;  ///< by which a plane may be off distances at nodes, voxels
};

}  // namespace voxshell
