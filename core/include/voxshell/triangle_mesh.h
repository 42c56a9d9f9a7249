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

/// What stands between a mesh and a closed, consistently oriented surface.
struct MeshDefects {
  std::size_t open_edges = 0;          ///< edges of one triangle
  std::size_t non_manifold_edges = 0;  ///< edges of more than two triangles
  std::size_t flipped_edges = 0;       ///< edges whose two triangles disagree on orientation
  Vec3 first_location{};               ///< midpoint of the first such edge, metres

  bool is_closed() const { return open_edges + non_manifold_edges + flipped_edges == 0; }
};

/// A validated triangle mesh: finite, from 1e-9 to 1e9 m in size, indices in range, at least one
/// triangle with area. Vertices at exactly the same place are merged; triangles that lose a corner
/// by it and vertices that no triangle uses are dropped. Counter-clockwise triangles face outwards.
/// Metres.
class TriangleMesh {
 public:
  static Result<TriangleMesh> create(std::span<const Vec3> vertices,
                                     std::span<const Triangle> triangles);

  /// From what vertices() and triangles() of a mesh returned: checked, but neither merged nor
  /// reordered, and so much faster.
  static Result<TriangleMesh> from_parts(std::vector<Vec3> vertices,
                                         std::vector<Triangle> triangles);

  std::span<const Vec3> vertices() const { return vertices_; }
  std::span<const Triangle> triangles() const { return triangles_; }
  const Bounds& bounds() const { return bounds_; }

  /// The corners of one triangle.
  std::array<Vec3, 3> corners(std::size_t triangle) const;

  double compute_area() const;

  /// Signed volume by the divergence theorem; negative where the mesh is inside out.
  double compute_volume() const;

  MeshDefects compute_defects() const;

  /// The same surface with its inside out.
  TriangleMesh turned() const;

 private:
  std::vector<Vec3> vertices_;
  std::vector<Triangle> triangles_;
  Bounds bounds_;
};

/// Error kInvalidMesh, with counts and a location, unless the mesh is closed, consistently
/// oriented and right side out: what a signed distance and a solid's mass need.
Result<std::monostate> check_encloses_volume(const TriangleMesh& mesh);

}  // namespace voxshell
