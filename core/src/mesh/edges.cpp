#include "mesh/edges.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace voxshell {

std::vector<MeshEdge> find_edges(const TriangleMesh& mesh) {
  struct HalfEdge {
    std::uint32_t high;
    std::uint32_t triangle;
  };
  const auto visit = [&](const auto& take) {
    for (std::size_t i = 0; i < mesh.triangles().size(); ++i) {
      const Triangle& t = mesh.triangles()[i];
      for (std::size_t side = 0; side < 3; ++side) {
        const std::uint32_t from = t[side];
        const std::uint32_t to = t[(side + 1) % 3];
        take(std::min(from, to), HalfEdge{std::max(from, to), static_cast<std::uint32_t>(i)});
      }
    }
  };
  // Few have the same smaller vertex: once these are together, there is little left to sort.
  std::vector<std::uint32_t> next(mesh.vertices().size() + 1, 0);
  visit([&](std::uint32_t low, const HalfEdge&) { ++next[low + 1]; });
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<HalfEdge> sorted(3 * mesh.triangles().size());
  visit([&](std::uint32_t low, const HalfEdge& edge) { sorted[next[low]++] = edge; });

  std::vector<MeshEdge> edges;
  edges.reserve(sorted.size() / 2 + 1);
  std::size_t begin = 0;
  for (std::uint32_t low = 0; low < mesh.vertices().size(); ++low) {
    const std::size_t end = next[low];
    // By triangle within an edge, so that any sort gives the same.
    std::sort(sorted.begin() + static_cast<std::ptrdiff_t>(begin),
              sorted.begin() + static_cast<std::ptrdiff_t>(end),
              [](const HalfEdge& a, const HalfEdge& b) {
                return a.high != b.high ? a.high < b.high : a.triangle < b.triangle;
              });
    while (begin < end) {
      const HalfEdge& edge = sorted[begin];
      const bool has_twin = begin + 1 < end && sorted[begin + 1].high == edge.high;
      edges.push_back(
          {low, edge.high, edge.triangle, has_twin ? sorted[begin + 1].triangle : kNoTriangle});
      begin += has_twin ? 2 : 1;
    }
  }
  return edges;
}

VertexStars::VertexStars(const TriangleMesh& mesh)
    : begin_(mesh.vertices().size() + 1, 0), triangles_(3 * mesh.triangles().size()) {
  for (const Triangle& t : mesh.triangles()) {
    for (const std::uint32_t vertex : t) ++begin_[vertex];
  }
  // Ends at first; filling in from behind moves them to the beginnings.
  std::uint32_t sum = 0;
  for (std::uint32_t& begin : begin_) {
    sum += begin;
    begin = sum;
  }
  for (std::size_t i = mesh.triangles().size(); i-- > 0;) {
    for (const std::uint32_t vertex : mesh.triangles()[i]) {
      triangles_[--begin_[vertex]] = static_cast<std::uint32_t>(i);
    }
  }
}

}  // namespace voxshell
