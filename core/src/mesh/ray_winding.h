#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "mesh/box_finder.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// Winding numbers of a balanced mesh, at each of whose edges as many triangles run one way as the
/// other: how often it encloses a place, by the triangles that a ray from there leaves and enters
/// through. Whole, and found in time that grows with the triangles that the ray meets, where solid
/// angles take time that grows with all triangles near. Keeps no reference to the mesh. Meters.
class RayWinding {
 public:
  explicit RayWinding(const TriangleMesh& mesh);

  /// Of two places, at less cost where they are near each other. None where one of them lies on the
  /// surface, within the rounding. Adds to `steps` how many triangles it has looked at.
  std::optional<std::array<int, 2>> compute(const std::array<Vec3, 2>& places,
                                            std::size_t& steps) const;

 private:
  /// A triangle in axes of which x runs along the rays, and its corners by their indices, so that
  /// every triangle of an edge sees the edge the same way around.
  struct Facet {
    std::array<Vec3, 3> corners;
    Vec3 normal;  ///< unit length, for this order of the corners; 0 where there is no area
    int sign;     ///< -1 where the triangle faces the other way

    int encircle(const Vec3& p) const;
  };

  static std::vector<Facet> turn_triangles(const TriangleMesh& mesh);

  Vec3 center_;
  std::vector<Facet> facets_;
  BoxFinder finder_;
  Bounds bounds_;    ///< of the facets
  double rounding_;  ///< places nearer to the surface lie on it
};

}  // namespace voxshell
