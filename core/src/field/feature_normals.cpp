#include "field/feature_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "base/portable_math.h"
#include "mesh/angle_normals.h"
#include "simd/exact_view.h"

namespace voxshell {
namespace {

Vec3 unit_normal(const TriangleMesh& mesh, std::size_t triangle) {
  const auto [a, b, c] = mesh.corners(triangle);
  return normalized(cross(b - a, c - a));
}

double angle_between(const Vec3& u, const Vec3& v) {
  return portable_atan2(length(cross(u, v)), dot(u, v));
}

/// Outward normals of the sides of a piece, each from a corner to the next, and of its corners.
struct PieceNormals {
  std::array<Vec3, 3> sides;
  std::array<Vec3, 3> corners;
};

/// `face` is the normal of the piece. The surface that meets the piece at a side may change along
/// it: the one that bends most tells the sides of all.
PieceNormals compute_by_place(const AngleNormals& around, const Vec3& face,
                              const std::array<Vec3, 3>& corners) {
  constexpr std::array kFractions{0.5, 0.1, 0.3, 0.7, 0.9};
  // A group is a corner and places of the side behind it.
  constexpr std::size_t kGroup = 1 + kFractions.size();
  std::array<Vec3, 3 * kGroup> places;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3& from = corners[k];
    const Vec3 way = corners[(k + 1) % 3] - from;
    places[kGroup * k] = from;
    std::ranges::transform(kFractions, places.begin() + kGroup * k + 1,
                           [&](double fraction) { return from + fraction * way; });
  }
  std::array<Vec3, places.size()> normals;
  around.compute(places, kGroup, normals);
  PieceNormals of_piece;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto group = std::span(normals).subspan(kGroup * k, kGroup);
    of_piece.corners[k] = group.front();
    Vec3& side = of_piece.sides[k] = face;
    for (const Vec3& each : group.subspan(1)) {
      const Vec3 here = normalized(each);
      if (here != Vec3{} && dot(here, face) < dot(side, face)) side = here;
    }
  }
  return of_piece;
}

/// Of a closed mesh without needles, which are found by who shares vertices with whom.
std::vector<float> compute_by_mesh(const TriangleMesh& mesh) {
  const auto triangles = mesh.triangles();
  std::vector<Vec3> of_vertices(mesh.vertices().size());
  std::vector<std::pair<std::uint64_t, std::uint32_t>> edges;  // vertices, triangle and side
  edges.reserve(3 * triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const Vec3 normal = unit_normal(mesh, i);
    const auto corners = mesh.corners(i);
    for (std::size_t k = 0; k < 3; ++k) {
      const double angle =
          angle_between(corners[(k + 1) % 3] - corners[k], corners[(k + 2) % 3] - corners[k]);
      of_vertices[triangles[i][k]] += angle * normal;
      const auto [low, high] = std::minmax(triangles[i][k], triangles[i][(k + 1) % 3]);
      edges.emplace_back(std::uint64_t{low} << 32 | high, 3 * i + static_cast<std::uint32_t>(k));
    }
  }
  std::ranges::sort(edges);
  std::vector<Vec3> edge_normals(3 * triangles.size());
  for (std::size_t begin = 0; begin < edges.size();) {
    std::size_t end = begin;
    Vec3 sum{};
    for (; end < edges.size() && edges[end].first == edges[begin].first; ++end) {
      sum += unit_normal(mesh, edges[end].second / 3);
    }
    for (; begin < end; ++begin) edge_normals[edges[begin].second] = sum;
  }
  std::vector<float> normals;
  normals.reserve(simd::kFeatureNormalFloats * triangles.size());
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const auto append = [&](const Vec3& normal) {
      const auto n = static_cast<Vec3f>(normal);
      normals.insert(normals.end(), {n.x, n.y, n.z});
    };
    append(unit_normal(mesh, i));
    for (std::size_t k = 0; k < 3; ++k) append(edge_normals[3 * i + k]);
    for (const std::uint32_t vertex : triangles[i]) append(of_vertices[vertex]);
  }
  return normals;
}

/// Vertices of triangles that are narrower than `rounding`, meters: what is around them is nearer
/// together than float32 tells apart.
std::vector<bool> find_needle_vertices(const TriangleMesh& mesh, double rounding) {
  std::vector<bool> found(mesh.vertices().size(), false);
  for (std::size_t i = 0; i < mesh.triangles().size(); ++i) {
    if (measure_height(mesh.corners(i)) > rounding) continue;
    for (const std::uint32_t vertex : mesh.triangles()[i]) found[vertex] = true;
  }
  return found;
}

/// Of the pieces of a mesh, those of triangles that touch no vertex in doubt as the mesh has them,
/// others by place.
Features combine(const TriangleMesh& mesh, const TriangleMesh& pieces,
                 std::span<const VisibleTriangle> of_pieces,
                 const std::vector<bool>& is_vertex_in_doubt, double rounding) {
  const std::vector<float> of_mesh = compute_by_mesh(mesh);
  const AngleNormals around(pieces, rounding);
  Features features;
  features.normals.reserve(simd::kFeatureNormalFloats * of_pieces.size());
  const auto append = [&](const Vec3& normal) {
    const auto n = static_cast<Vec3f>(normal);
    features.normals.insert(features.normals.end(), {n.x, n.y, n.z});
  };
  for (std::size_t i = 0; i < of_pieces.size(); ++i) {
    const VisibleTriangle& of = of_pieces[i];
    const bool is_clear =
        of.is_whole && std::ranges::none_of(mesh.triangles()[of.triangle],
                                            [&](std::uint32_t v) { return is_vertex_in_doubt[v]; });
    features.is_in_doubt.push_back(!is_clear);
    if (is_clear) {
      const auto from =
          of_mesh.begin() + static_cast<std::ptrdiff_t>(simd::kFeatureNormalFloats) * of.triangle;
      features.normals.insert(features.normals.end(), from, from + simd::kFeatureNormalFloats);
      continue;
    }
    const Vec3 face = unit_normal(mesh, of.triangle);
    const PieceNormals of_piece = compute_by_place(around, face, pieces.corners(i));
    append(face);
    std::ranges::for_each(of_piece.sides, append);
    std::ranges::for_each(of_piece.corners, append);
  }
  return features;
}

}  // namespace

Features compute_features(const TriangleMesh& mesh) {
  const double rounding = measure_rounding(mesh);
  const std::vector<bool> is_in_doubt = find_needle_vertices(mesh, rounding);
  if (std::ranges::find(is_in_doubt, true) == is_in_doubt.end()) {
    return {.normals = compute_by_mesh(mesh)};
  }
  std::vector<VisibleTriangle> all;
  all.reserve(mesh.triangles().size());
  for (std::uint32_t i = 0; i < mesh.triangles().size(); ++i) all.push_back({i, true});
  return combine(mesh, mesh, all, is_in_doubt, rounding);
}

Features compute_features(const TriangleMesh& mesh, const VisibleSurface& visible) {
  const double rounding = visible.cutter->rounding();
  std::vector<bool> is_in_doubt = find_needle_vertices(mesh, rounding);
  // Where all triangles around a vertex are visible as a whole, their edges are those of the mesh.
  std::vector<bool> is_whole(mesh.triangles().size(), false);
  for (const VisibleTriangle& of : visible.triangles) is_whole[of.triangle] = of.is_whole;
  for (std::size_t i = 0; i < is_whole.size(); ++i) {
    if (is_whole[i]) continue;
    for (const std::uint32_t vertex : mesh.triangles()[i]) is_in_doubt[vertex] = true;
  }
  return combine(mesh, visible.mesh, visible.triangles, is_in_doubt, rounding);
}

}  // namespace voxshell
