#pragma once

#include <array>
#include <vector>

#include "mesh/box_finder.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// The least height of a triangle, metres; 0 where it has no area.
double measure_height(const std::array<Vec3, 3>& corners);

/// The normals of places of a surface, which tell its inside from its outside: the means of the
/// normals of the triangles there, weighted by their angles (Baerentzen and Aanaes 2005). Triangles
/// are found by place, so that the corner of one may lie amid the side of another. The mesh
/// outlives this.
class AngleNormals {
 public:
  /// `rounding`: triangles this near to a place, metres, meet there.
  AngleNormals(const TriangleMesh& mesh, double rounding)
      : mesh_(mesh), rounding_(rounding), finder_(bound_triangles(mesh)) {}

  /// Not of unit length.
  Vec3 compute(const Vec3& place) const;

 private:
  const TriangleMesh& mesh_;
  double rounding_;
  BoxFinder finder_;
};

}  // namespace voxshell
