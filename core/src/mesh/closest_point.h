#pragma once

#include <cstdint>
#include <vector>

#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// Which part of a triangle a closest point lies on.
enum class TriangleFeature : std::uint8_t {
  kVertex0,
  kVertex1,
  kVertex2,
  kEdge01,
  kEdge12,
  kEdge20,
  kFace,
};

struct ClosestPoint {
  Vec3 point;
  double squared_distance;
  std::uint32_t triangle;
  TriangleFeature feature;
};

/// Closest point of one triangle to `p` (Ericson, Real-Time Collision Detection, section 5.1.5).
/// Triangles without area answer with an edge or a vertex.
ClosestPoint closest_point_on_triangle(const Vec3& p, const std::array<Vec3, 3>& corners);

/// Answers closest-point and signed-distance queries on a mesh by a tree of bounding boxes.
/// Keeps a reference to the mesh, which must outlive it.
class ClosestPointTree {
 public:
  explicit ClosestPointTree(const TriangleMesh& mesh);

  /// The closest point among those nearer than `max_distance`; where there is none, the result's
  /// squared_distance is infinite.
  ClosestPoint find_closest(const Vec3& p, double max_distance) const;

  /// Distance of `p` with the sign of the angle-weighted pseudonormal of the closest feature
  /// (Baerentzen and Aanaes 2005): exact for closed, oriented, not self-intersecting meshes.
  /// `max_distance` must not be below the true distance.
  double signed_distance(const Vec3& p, double max_distance) const;

 private:
  struct Node {
    Bounds bounds;
    std::uint32_t first;  ///< a leaf's first triangle in order_; an inner node's right child
    std::uint32_t count;  ///< a leaf's triangles; 0 for an inner node, whose left child is next
  };

  void build_node(std::uint32_t begin, std::uint32_t end, std::vector<Bounds>& triangle_bounds);
  void build_pseudonormals();
  Vec3 pseudonormal(const ClosestPoint& closest) const;

  const TriangleMesh& mesh_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;               ///< triangle indices, leaf by leaf
  std::vector<std::array<Vec3, 3>> corners_;       ///< in the same order
  std::vector<Vec3> vertex_normals_;               ///< by vertex; direction only
  std::vector<std::array<Vec3, 3>> edge_normals_;  ///< by triangle: edges 01, 12, 20
};

}  // namespace voxshell
