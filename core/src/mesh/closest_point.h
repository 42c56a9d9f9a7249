#pragma once

#include <cstdint>
#include <vector>

#include "voxshell/triangle_mesh.h"

namespace voxshell {

struct ClosestPoint {
  Vec3 point;
  double squared_distance;
  std::uint32_t triangle;
};

/// Closest point of one triangle to `p` (Ericson, Real-Time Collision Detection, section 5.1.5).
/// Triangles without area answer with an edge or a vertex.
Vec3 closest_point_on_triangle(const Vec3& p, const std::array<Vec3, 3>& corners);

/// Answers closest-point queries on a mesh by a tree of bounding boxes.
class ClosestPointTree {
 public:
  explicit ClosestPointTree(const TriangleMesh& mesh);

  /// The closest point of the mesh. `guess` is any triangle; a near one, such as the answer for a
  /// neighboring point, makes the search short and does not change the distance found.
  ClosestPoint find_closest(const Vec3& p, std::uint32_t guess = 0) const;

 private:
  struct Node {
    Bounds bounds;
    std::uint32_t first;  ///< a leaf's first triangle in order_; an inner node's right child
    std::uint32_t count;  ///< a leaf's triangles; 0 for an inner node, whose left child is next
  };

  void build_node(std::uint32_t begin, std::uint32_t end, std::vector<Bounds>& triangle_bounds);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;          ///< triangle indices, leaf by leaf
  std::vector<std::array<Vec3, 3>> corners_;  ///< in the same order
  std::vector<std::uint32_t> place_;          ///< where order_ holds a triangle
};

}  // namespace voxshell
