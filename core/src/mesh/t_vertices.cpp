#include "mesh/t_vertices.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <map>
#include <utility>

#include "mesh/box_finder.h"
#include "mesh/edges.h"

namespace voxshell {
namespace {

/// How near a vertex is to an edge that it lies on, of the mesh's longest side.
constexpr double kRounding = 1e-6;
/// A vertex lies amid few edges, and each adds one piece. Only of meshes that are hardly wider than
/// the rounding do all vertices lie amid all edges, and pieces amid pieces: these stay uncut.
constexpr std::size_t kMostAmid = 64;   // edges a vertex, on average
constexpr std::size_t kMostPieces = 4;  // a vertex amid an edge

using Edge = std::pair<std::uint32_t, std::uint32_t>;  // the smaller vertex first

/// The vertices amid each open edge, from its first vertex to its second; none where there are too
/// many.
std::map<Edge, std::vector<std::uint32_t>> find_amid(const TriangleMesh& mesh) {
  std::vector<Edge> open;
  std::vector<std::uint32_t> ends;
  for (const MeshEdge& edge : find_edges(mesh)) {
    if (edge.second != kNoTriangle) continue;
    open.emplace_back(edge.low, edge.high);
    ends.insert(ends.end(), {edge.low, edge.high});
  }
  std::ranges::sort(ends);
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  std::map<Edge, std::vector<std::uint32_t>> amid;
  if (open.empty()) return amid;
  std::vector<Bounds> boxes(ends.size());
  for (std::size_t i = 0; i < ends.size(); ++i) boxes[i].extend(mesh.vertices()[ends[i]]);
  const BoxFinder finder(std::move(boxes));
  const double rounding = kRounding * mesh.bounds().extents()[mesh.bounds().longest_axis()];
  std::size_t total = 0;
  for (const Edge& edge : open) {
    const Vec3& from = mesh.vertices()[edge.first];
    const Vec3 way = mesh.vertices()[edge.second] - from;
    Bounds box;
    box.extend(from);
    box.extend(from + way);
    std::vector<std::pair<double, std::uint32_t>> found;
    finder.visit(widen(box, rounding), [&](std::uint32_t i) {
      const Vec3 to_vertex = mesh.vertices()[ends[i]] - from;
      const double along = dot(to_vertex, normalized(way));
      if (along <= rounding || along >= length(way) - rounding) return;
      if (length(to_vertex - along * normalized(way)) <= rounding)
        found.emplace_back(along, ends[i]);
    });
    if (found.empty()) continue;
    total += found.size();
    if (total > kMostAmid * ends.size()) return {};
    std::ranges::sort(found);
    for (const auto& [along, vertex] : found) amid[edge].push_back(vertex);
  }
  return amid;
}

}  // namespace

std::vector<Triangle> cut_at_t_vertices(const TriangleMesh& mesh) {
  const auto amid = find_amid(mesh);
  std::vector<Triangle> triangles(mesh.triangles().begin(), mesh.triangles().end());
  if (amid.empty()) return triangles;
  std::size_t most = triangles.size();
  for (const auto& [edge, vertices] : amid) most += kMostPieces * vertices.size();
  std::vector<Triangle> pieces;
  std::vector<Triangle> waiting;
  const auto cut = [&](const Triangle& t) {
    for (std::size_t side = 0; side < t.size(); ++side) {
      const std::uint32_t from = t[side];
      const std::uint32_t to = t[(side + 1) % t.size()];
      const std::uint32_t apex = t[(side + 2) % t.size()];
      const auto found = amid.find(std::minmax(from, to));
      if (found == amid.end()) continue;
      std::vector<std::uint32_t> stops = found->second;
      if (std::ranges::find(stops, apex) != stops.end()) continue;  // a triangle without area
      if (from > to) std::ranges::reverse(stops);
      stops.insert(stops.begin(), from);
      stops.push_back(to);
      for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
        waiting.push_back({stops[i], stops[i + 1], apex});
      }
      return true;
    }
    return false;
  };
  for (const Triangle& triangle : triangles) {
    waiting.assign(1, triangle);
    while (!waiting.empty()) {
      const Triangle next = waiting.back();
      waiting.pop_back();
      if (!cut(next)) pieces.push_back(next);
      if (pieces.size() + waiting.size() > most) return triangles;
    }
  }
  return pieces;
}

}  // namespace voxshell
