#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/box_finder.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// Parts nearer together than this touch, meters: above the rounding of coordinates, in files as
/// well, and below what matters.
double measure_rounding(const TriangleMesh& mesh);

/// Where triangles of a mesh cross one another, or touch along a line, other than neighbors along
/// their common side. Keeps no reference to the mesh. Meters.
class SelfCrossings {
 public:
  explicit SelfCrossings(const TriangleMesh& mesh);

  /// Parts nearer together count as touching, meters.
  double rounding() const { return rounding_; }
  std::size_t size() const { return triangles_.size(); }  ///< triangles of the mesh
  const std::array<Vec3, 3>& corners(std::uint32_t triangle) const { return corners_[triangle]; }
  /// Of unit length; 0 where the triangle has no area.
  const Vec3& normal(std::uint32_t triangle) const { return normals_[triangle]; }
  const BoxFinder& finder() const { return finder_; }  ///< of the triangles

  /// A straight line in the plane of a triangle.
  struct Line {
    Vec3 from;
    Vec3 to;
    Vec3 outward;  ///< the normal of the other triangle, unit length
  };

  /// Where other triangles meet the plane of a triangle, of those that may meet it.
  std::vector<Line> find_lines(std::uint32_t triangle) const;
  /// Cuts lines down to what lies well within a convex polygon in the plane of a triangle,
  /// counter-clockwise, and drops those that do not.
  void clip(std::span<const Vec3> polygon, const Vec3& normal, std::vector<Line>& lines) const;
  bool is_crossed(std::uint32_t triangle) const;

  /// The triangles that are crossed, ascending.
  std::vector<std::uint32_t> find_crossed(unsigned threads) const;

 private:
  double rounding_;
  std::vector<Triangle> triangles_;
  std::vector<std::array<Vec3, 3>> corners_;
  std::vector<Vec3> normals_;
  BoxFinder finder_;
};

}  // namespace voxshell
