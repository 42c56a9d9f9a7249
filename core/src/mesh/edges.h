#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "voxshell/triangle_mesh.h"

namespace voxshell {

inline constexpr std::uint32_t kNoTriangle = ~std::uint32_t{0};

/// One side of a triangle.
struct TriangleSide {
  std::uint32_t low;   ///< smaller vertex index
  std::uint32_t high;  ///< larger vertex index
  std::uint32_t triangle;
  bool is_forward;  ///< the triangle has it from low to high

  bool is_of_same_edge(const TriangleSide& other) const {
    return low == other.low && high == other.high;
  }
};

/// The sides of all triangles, by smaller vertex, then by larger vertex, then by triangle.
std::vector<TriangleSide> sort_sides(std::span<const Triangle> triangles, std::size_t vertices);

/// Visits the sides of each edge, as a span, of what sort_sides() returned.
template <class Visit>
void visit_edges(std::span<const TriangleSide> sides, const Visit& visit) {
  for (std::size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
    while (end < sides.size() && sides[end].is_of_same_edge(sides[begin])) ++end;
    visit(sides.subspan(begin, end - begin));
  }
}

/// An edge of a mesh. Of an edge of three triangles or more there are several, of two each.
struct MeshEdge {
  std::uint32_t low;     ///< smaller vertex index
  std::uint32_t high;    ///< larger vertex index
  std::uint32_t first;   ///< a triangle
  std::uint32_t second;  ///< the triangle across, or kNoTriangle at a rim
};

/// The edges of a mesh, by their smaller vertex, then by the larger one.
std::vector<MeshEdge> find_edges(const TriangleMesh& mesh);

/// Which triangles each vertex is a corner of, ascending.
class VertexStars {
 public:
  explicit VertexStars(const TriangleMesh& mesh);

  std::span<const std::uint32_t> operator[](std::uint32_t vertex) const {
    return std::span(triangles_).subspan(begin_[vertex], begin_[vertex + 1] - begin_[vertex]);
  }

 private:
  std::vector<std::uint32_t> begin_;
  std::vector<std::uint32_t> triangles_;
};

}  // namespace voxshell
