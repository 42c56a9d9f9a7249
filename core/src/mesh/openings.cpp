#include "mesh/openings.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "mesh/disjoint_sets.h"
#include "mesh/edges.h"

namespace voxshell {
namespace {

Vec3 doubled_area(const TriangleMesh& mesh, std::uint32_t triangle) {
  const auto [a, b, c] = mesh.corners(triangle);
  return cross(b - a, c - a);
}

/// Edges of one rim.
struct Rim {
  double length = 0.0;
  Vec3 moment{};  ///< of its edges' middles, by length
  Bounds bounds;
  double cap = 0.0;    ///< area of a fan of triangles to the center
  Vec3 cap_normal{};   ///< sum of their normals, by area
  double along = 0.0;  ///< length of edges, each times the cosine of its triangle to the cap

  Vec3 center() const { return moment / length; }
};

/// Area of the surface that hangs together with a rim.
double compute_open_area(const TriangleMesh& mesh, const std::vector<MeshEdge>& edges) {
  DisjointSets parts(mesh.triangles().size());
  for (const MeshEdge& edge : edges) {
    if (edge.second != kNoTriangle) parts.join(edge.first, edge.second);
  }
  std::vector<bool> is_open(mesh.triangles().size(), false);
  for (const MeshEdge& edge : edges) {
    if (edge.second == kNoTriangle) is_open[parts.find(edge.first)] = true;
  }
  double area = 0.0;
  for (std::uint32_t i = 0; i < is_open.size(); ++i) {
    if (is_open[parts.find(i)]) area += 0.5 * length(doubled_area(mesh, i));
  }
  return area;
}

}  // namespace

Openings find_openings(const TriangleMesh& mesh) {
  const std::vector<MeshEdge> edges = find_edges(mesh);
  std::vector<MeshEdge> rim_edges;
  for (const MeshEdge& edge : edges) {
    if (edge.second == kNoTriangle) rim_edges.push_back(edge);
  }
  Openings openings;
  if (rim_edges.empty()) return openings;

  const auto vertices = mesh.vertices();
  DisjointSets joined(vertices.size());
  for (const MeshEdge& edge : rim_edges) joined.join(edge.low, edge.high);
  std::vector<std::uint32_t> rim_of(vertices.size(), kNoTriangle);
  std::vector<Rim> rims;
  const auto find_rim = [&](const MeshEdge& edge) -> Rim& {
    std::uint32_t& index = rim_of[joined.find(edge.low)];
    if (index == kNoTriangle) {
      index = static_cast<std::uint32_t>(rims.size());
      rims.emplace_back();
    }
    return rims[index];
  };
  for (const MeshEdge& edge : rim_edges) {
    const Vec3& a = vertices[edge.low];
    const Vec3& b = vertices[edge.high];
    Rim& rim = find_rim(edge);
    const double size = length(b - a);
    rim.length += size;
    rim.moment += 0.5 * size * (a + b);
    rim.bounds.extend(a);
    rim.bounds.extend(b);
  }
  for (const MeshEdge& edge : rim_edges) {
    Rim& rim = find_rim(edge);
    const Vec3 center = rim.center();
    Vec3 part = 0.5 * cross(vertices[edge.low] - center, vertices[edge.high] - center);
    rim.cap += length(part);
    // Edges run in either direction.
    if (dot(part, rim.cap_normal) < 0.0) part = -part;
    rim.cap_normal += part;
  }
  for (const MeshEdge& edge : rim_edges) {
    Rim& rim = find_rim(edge);
    const Vec3 face = normalized(doubled_area(mesh, edge.first));
    rim.along += length(vertices[edge.high] - vertices[edge.low]) *
                 std::abs(dot(face, normalized(rim.cap_normal)));
  }

  constexpr double kMouthCosine = 0.5;  // the surface meets the cap by more than 60 degrees
  constexpr double kWide = 0.5;         // of the widest
  openings.loops = rims.size();
  openings.first_location = 0.5 * (vertices[rim_edges[0].low] + vertices[rim_edges[0].high]);
  double caps = 0.0;
  for (const Rim& rim : rims) {
    caps += rim.cap;
    openings.largest_diameter = std::max(openings.largest_diameter, length(rim.bounds.extents()));
  }
  for (const Rim& rim : rims) {
    const bool is_wide = length(rim.bounds.extents()) >= kWide * openings.largest_diameter;
    if (is_wide && rim.along <= kMouthCosine * rim.length) ++openings.mouths;
  }
  const double area = compute_open_area(mesh, edges);
  openings.fraction = area > 0.0 ? caps / area : 1.0;
  return openings;
}

bool suggest_sheet(const Openings& openings) {
  constexpr double kSheetFraction = 0.15;
  constexpr double kTubeFraction = 0.005;
  constexpr std::size_t kTubeMouths = 2;
  if (openings.loops == 0) return false;
  return openings.fraction >= kSheetFraction ||
         (openings.mouths >= kTubeMouths && openings.fraction >= kTubeFraction);
}

}  // namespace voxshell
