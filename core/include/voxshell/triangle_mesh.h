#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "voxshell/bounds.h"
#include "voxshell/result.h"
#include "voxshell/vector.h"

namespace voxshell {

using Triangle = std::array<std::uint32_t, 3>;

/// Defects that keep a mesh from being a closed, consistently oriented surface.
struct MeshDefects {
  std::size_t open_edges = 0;          ///< edges of one triangle
  std::size_t non_manifold_edges = 0;  ///< edges of more than two triangles
  std::size_t flipped_edges = 0;       ///< edges whose two triangles disagree on orientation
  Vec3 first_location{};               ///< midpoint of the first such edge, meters

  bool is_closed() const { return open_edges + non_manifold_edges + flipped_edges == 0; }
};

/// A validated triangle mesh: finite, from 1e-9 to 1e9 m in size, indices in range, at least one
/// triangle with area. Vertices at exactly the same place are merged. Triangles that lose a corner
/// by merging, and vertices that no triangle uses, are dropped. Counterclockwise triangles face
/// outward. Meters.
class TriangleMesh {
 public:
  static Result<TriangleMesh> create(std::span<const Vec3> vertices,
                                     std::span<const Triangle> triangles);

  /// From the results of vertices() and triangles() of a mesh. They are checked, but neither merged
  /// nor reordered, which is much faster.
  static Result<TriangleMesh> from_parts(std::vector<Vec3> vertices,
                                         std::vector<Triangle> triangles);

  std::span<const Vec3> vertices() const { return vertices_; }
  std::span<const Triangle> triangles() const { return triangles_; }
  const Bounds& bounds() const { return bounds_; }

  /// The corners of one triangle.
  std::array<Vec3, 3> corners(std::size_t triangle) const {
    const Triangle& t = triangles_[triangle];
    return {vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]};
  }

  double compute_area() const;

  /// Signed volume by the divergence theorem; negative if the mesh is inside out.
  double compute_volume() const;

  MeshDefects compute_defects() const;

  /// The same surface with inside and outside exchanged.
  TriangleMesh turned() const;

 private:
  std::vector<Vec3> vertices_;
  std::vector<Triangle> triangles_;
  Bounds bounds_;
};

/// Error kInvalidMesh, with counts and a location, unless the mesh is closed, consistently oriented
/// and oriented outward, as a signed distance and a solid's mass require.
Result<std::monostate> check_encloses_volume(const TriangleMesh& mesh);

}  // namespace voxshell
