#pragma once

#include <vector>

#include "mesh/surface_cutter.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// Data that tell inside from outside where a triangle is nearest.
struct Features {
  std::vector<float> normals;  ///< of the triangles' features, see simd/exact_view.h
  /// Triangles that were cut, or that touch such a one or a needle. Their normals are found by
  /// place, and may be wrong where several parts meet. Empty: there are none.
  std::vector<bool> is_in_doubt = {};
};

/// Of a closed mesh.
Features compute_features(const TriangleMesh& mesh);

/// Of what is visible of a closed mesh.
Features compute_features(const TriangleMesh& mesh, const VisibleSurface& visible);

}  // namespace voxshell
