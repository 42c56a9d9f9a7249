#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "voxshell/triangle_mesh.h"
#include "voxshell/vector.h"

namespace voxshell {

/// An edge of a mesh between two of its vertices.
struct BentEdge {
  std::uint32_t from;
  std::uint32_t to;
  std::array<std::uint32_t, 2> triangles;  ///< the first is the only one of an open edge
  std::uint32_t triangle_count;
  /// Tangent of half of the angle between the two triangles' normals: 0 where they lie in one
  /// plane, above 0 where the edge is convex, below where it is concave.
  double bend;
  double width;  ///< mean height of its triangles above it, meters
};

/// A vertex that sticks out of the surface around it.
struct Corner {
  std::uint32_t vertex;
  Vec3 normal;  ///< outward unit normal, the mean over the angles around it; zero where it has none
};

/// Features that points spread over a mesh would miss.
struct Creases {
  /// The sharp edges: those where the surface bends outwards by more than 20 degrees, or where wide
  /// facets meet at smaller angles; edges of one triangle or of more than two; all of them only
  /// where they stand out by more than the tolerance.
  std::vector<BentEdge> sharp_edges;
  std::vector<Vec3> edge_normals;  ///< the means of their triangles' normals, unit length
  /// Where sharp edges end, meet or turn, and vertices without any that stand out, as tips of
  /// cones.
  std::vector<Corner> corners;
  /// How far apart points may be on each triangle, by the largest convex curvature about it beside
  /// its sharp edges; meters, infinity where it is flat. The curvature is that of surroundings
  /// about as large as the spacing itself, so that roughness below the tolerance does not count.
  std::vector<double> spacings;
};

/// Finds what a shell must hold to miss no more than `tolerance`, meters. Faces that are split into
/// triangles have no creases, nor has a finely tessellated smooth surface. Deterministic.
Creases find_creases(const TriangleMesh& mesh, double tolerance);

/// All edges, ascending by their vertices.
std::vector<BentEdge> find_bent_edges(const TriangleMesh& mesh);

}  // namespace voxshell
