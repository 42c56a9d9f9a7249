#include "mesh/edges.h"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace voxshell {

std::vector<TriangleSide> sort_sides(std::span<const Triangle> triangles, std::size_t vertices) {
  const auto visit = [&](const auto& take) {
    for (std::uint32_t i = 0; i < triangles.size(); ++i) {
      for (std::size_t side = 0; side < 3; ++side) {
        const std::uint32_t from = triangles[i][side];
        const std::uint32_t to = triangles[i][(side + 1) % 3];
        take(TriangleSide{std::min(from, to), std::max(from, to), i, from < to});
      }
    }
  };
  // Few have the same smaller vertex: once these are together, there is little left to sort.
  std::vector<std::uint32_t> next(vertices + 1, 0);
  visit([&](const TriangleSide& side) { ++next[side.low + 1]; });
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<TriangleSide> sorted(3 * triangles.size());
  visit([&](const TriangleSide& side) { sorted[next[side.low]++] = side; });
  auto begin = sorted.begin();
  for (std::size_t vertex = 0; vertex < vertices; ++vertex) {
    const auto end = sorted.begin() + static_cast<std::ptrdiff_t>(next[vertex]);
    // By triangle within an edge, so that any sort gives the same.
    std::sort(begin, end, [](const TriangleSide& a, const TriangleSide& b) {
      return a.high != b.high ? a.high < b.high : a.triangle < b.triangle;
    });
    begin = end;
  }
  return sorted;
}

std::vector<MeshEdge> find_edges(const TriangleMesh& mesh) {
  const auto sides = sort_sides(mesh.triangles(), mesh.vertices().size());
  std::vector<MeshEdge> edges;
  edges.reserve(sides.size() / 2 + 1);
  visit_edges(sides, [&](std::span<const TriangleSide> edge) {
    for (std::size_t i = 0; i < edge.size(); i += 2) {
      edges.push_back({edge[i].low, edge[i].high, edge[i].triangle,
                       i + 1 < edge.size() ? edge[i + 1].triangle : kNoTriangle});
    }
  });
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
