#pragma once

#include <cstdint>
#include <vector>

#include "mesh/distance_tree.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// Finds the triangle of a mesh that is nearest to a place. Meters, the mesh's frame.
class TriangleFinder {
 public:
  explicit TriangleFinder(const TriangleMesh& mesh)
      : origin_(mesh.bounds().lower),
        unit_(choose_unit(mesh)),
        tree_(mesh, origin_, unit_, 0),
        guesses_(tree_.list_guesses()) {}

  /// A near triangle as a guess shortens the search.
  std::uint32_t find_nearest(const Vec3& place, std::uint32_t guess) const {
    return tree_.find_nearest((place - origin_) / unit_, guesses_[guess]).triangle;
  }

 private:
  /// A thousand units along the mesh's diagonal.
  static double choose_unit(const TriangleMesh& mesh) {
    constexpr double kUnits = 1024.0;
    const double diagonal = length(mesh.bounds().extents());
    return diagonal > 0.0 ? diagonal / kUnits : 1.0;
  }

  Vec3 origin_;
  double unit_;  ///< of the tree's lengths, meters
  DistanceTree tree_;
  std::vector<std::int32_t> guesses_;  ///< for the tree, of places near each triangle
};

}  // namespace voxshell
