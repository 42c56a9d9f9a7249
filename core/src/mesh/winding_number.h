#pragma once

#include <cstdint>
#include <vector>

#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// Generalised winding numbers of any triangles: how much of the directions around a point they
/// cover, signed. Of a closed mesh how often it encloses the point; of an open one a number in
/// between, which is continuous where there is no triangle. Groups of triangles far away count as
/// one (Barill, Dickson, Schmidt, Levin and Jacobson, Fast Winding Numbers for Soups and Clouds,
/// 2018), which is good to a hundredth.
class WindingNumberTree {
 public:
  explicit WindingNumberTree(const TriangleMesh& mesh);

  double compute(const Vec3& p) const;

 private:
  struct Node {
    Vec3 centre;          ///< of the triangles' area
    Vec3 area;            ///< sum of the triangles' normals, as long as their areas
    double radius;        ///< no triangle reaches farther from the centre
    std::uint32_t first;  ///< a leaf's first triangle in corners_; an inner node's right child
    std::uint32_t count;  ///< a leaf's triangles; 0 for an inner node, whose left child is next
  };

  void build_node(const TriangleMesh& mesh, std::uint32_t begin, std::uint32_t end,
                  std::vector<std::uint32_t>& order, const std::vector<Vec3>& centres);

  std::vector<Node> nodes_;
  std::vector<std::array<Vec3, 3>> corners_;
};

}  // namespace voxshell
