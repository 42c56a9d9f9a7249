#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "mesh/box_finder.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// The least height of a triangle, meters; 0 where it has no area.
double measure_height(const std::array<Vec3, 3>& corners);

/// The normals of places of a surface, which tell its inside from its outside: the means of the
/// normals of the triangles there, weighted by their angles (Baerentzen and Aanaes 2005). Triangles
/// are found by place, so that the corner of one may lie amid the side of another. Keeps no
/// reference to the mesh.
class AngleNormals {
 public:
  /// `rounding`: triangles this near to a place, meters, meet there.
  AngleNormals(const TriangleMesh& mesh, double rounding);

  /// Not of unit length.
  Vec3 compute(const Vec3& place) const;
  /// The same at several places, at less cost where they are near one another. If they are not,
  /// each run of `group` places may be.
  void compute(std::span<const Vec3> places, std::size_t group, std::span<Vec3> normals) const;

 private:
  /// A triangle and what its answers have in common, since many places ask the same triangle.
  struct Facet {
    std::array<Vec3, 3> corners;
    Vec3 normal;
    double weight;                 ///< needles face anywhere, and count for less
    std::array<Vec3, 3> inwards;   ///< of its sides, from corner i to the next
    std::array<double, 3> angles;  ///< at its corners

    double measure_angle(const Vec3& place, double rounding) const;
    Vec3 weigh(const Vec3& place, double rounding) const;
  };

  bool compute_together(std::span<const Vec3> places, std::span<Vec3> normals) const;

  double rounding_;
  std::vector<Facet> facets_;
  BoxFinder finder_;
};

}  // namespace voxshell
