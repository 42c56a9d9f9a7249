#include "mesh/thicken.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/edges.h"

namespace voxshell {
namespace {

/// Sides of triangles, from one corner to the next.
constexpr std::size_t kSides = 3;

std::size_t next(std::size_t corner) { return (corner + 1) % kSides; }

/// The surface cut along edges of more than two triangles, and where it cannot be oriented.
class Sheets {
 public:
  explicit Sheets(const TriangleMesh& mesh)
      : mesh_(mesh),
        across_(mesh.triangles().size(), {kNoTriangle, kNoTriangle, kNoTriangle}),
        is_flipped_(mesh.triangles().size(), false),
        is_open_(mesh.triangles().size(), false) {
    join_triangles();
    orient();
  }

  bool is_open(std::size_t triangle) const { return is_open_[triangle]; }

  /// The corners of a triangle of a sheet in an order that goes with its neighbors.
  std::array<std::size_t, kSides> order(std::size_t triangle) const {
    if (is_flipped_[triangle]) return {0, 2, 1};
    return {0, 1, 2};
  }

  /// Across the side between two corners, in either order.
  std::uint32_t across(std::size_t triangle, std::size_t from, std::size_t to) const {
    return across_[triangle][next(from) == to ? from : to];
  }

  /// The corner of a triangle that is at a vertex.
  std::size_t corner_at(std::size_t triangle, std::uint32_t vertex) const {
    const Triangle& t = mesh_.triangles()[triangle];
    return t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2;
  }

 private:
  void join_triangles() {
    const std::vector<MeshEdge> edges = find_edges(mesh_);
    for (std::size_t i = 0; i < edges.size(); ++i) {
      const auto is_same = [&](std::size_t other) {
        return other < edges.size() && edges[other].low == edges[i].low &&
               edges[other].high == edges[i].high;
      };
      const MeshEdge& edge = edges[i];
      if (edge.second == kNoTriangle || is_same(i + 1) || (i > 0 && is_same(i - 1))) continue;
      across_[edge.first][side_of(edge.first, edge)] = edge.second;
      across_[edge.second][side_of(edge.second, edge)] = edge.first;
    }
  }

  std::size_t side_of(std::uint32_t triangle, const MeshEdge& edge) const {
    const std::size_t a = corner_at(triangle, edge.low);
    const std::size_t b = corner_at(triangle, edge.high);
    return next(a) == b ? a : b;
  }

  /// Whether a triangle runs along its side from the smaller vertex to the larger one.
  bool runs_up(std::size_t triangle, std::size_t side) const {
    const Triangle& t = mesh_.triangles()[triangle];
    return (t[side] < t[next(side)]) != is_flipped_[triangle];
  }

  void orient() {
    std::vector<bool> is_done(across_.size(), false);
    std::vector<std::uint32_t> part;
    for (std::uint32_t first = 0; first < across_.size(); ++first) {
      if (is_done[first]) continue;
      is_done[first] = true;
      part.assign(1, first);
      bool has_rim = false;
      for (std::size_t i = 0; i < part.size(); ++i) {
        const std::uint32_t triangle = part[i];
        for (std::size_t side = 0; side < kSides; ++side) {
          const std::uint32_t other = across_[triangle][side];
          if (other == kNoTriangle) {
            has_rim = true;
            continue;
          }
          const std::size_t other_side = side_back(triangle, side, other);
          if (!is_done[other]) {
            is_done[other] = true;
            is_flipped_[other] = runs_up(other, other_side) == runs_up(triangle, side);
            part.push_back(other);
          } else if (runs_up(other, other_side) == runs_up(triangle, side)) {
            across_[triangle][side] = kNoTriangle;
            across_[other][other_side] = kNoTriangle;
            has_rim = true;
          }
        }
      }
      for (const std::uint32_t triangle : part) is_open_[triangle] = has_rim;
    }
  }

  std::size_t side_back(std::uint32_t triangle, std::size_t side, std::uint32_t other) const {
    const Triangle& t = mesh_.triangles()[triangle];
    const std::size_t a = corner_at(other, t[side]);
    const std::size_t b = corner_at(other, t[next(side)]);
    return next(a) == b ? a : b;
  }

  const TriangleMesh& mesh_;
  std::vector<std::array<std::uint32_t, kSides>> across_;  ///< by side; kNoTriangle where it is cut
  std::vector<bool> is_flipped_;
  std::vector<bool> is_open_;
};

/// A vertex of a sheet: where several sheets touch at a vertex of the mesh, there is one of each.
std::vector<std::uint32_t> number_corners(const TriangleMesh& mesh, const Sheets& sheets) {
  std::vector<std::uint32_t> parent(kSides * mesh.triangles().size());
  for (std::uint32_t i = 0; i < parent.size(); ++i) parent[i] = i;
  const auto find = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (std::size_t i = 0; i < mesh.triangles().size(); ++i) {
    const Triangle& t = mesh.triangles()[i];
    for (std::size_t side = 0; side < kSides; ++side) {
      const std::uint32_t other = sheets.across(i, side, next(side));
      if (other == kNoTriangle) continue;
      for (const std::size_t corner : {side, next(side)}) {
        const std::uint32_t a = find(static_cast<std::uint32_t>(kSides * i + corner));
        const std::uint32_t b =
            find(static_cast<std::uint32_t>(kSides * other + sheets.corner_at(other, t[corner])));
        parent[std::max(a, b)] = std::min(a, b);
      }
    }
  }
  for (std::uint32_t i = 0; i < parent.size(); ++i) parent[i] = find(i);
  return parent;
}

}  // namespace

Result<TriangleMesh> thicken(const TriangleMesh& mesh, double thickness) {
  const Sheets sheets(mesh);
  const std::vector<std::uint32_t> corner = number_corners(mesh, sheets);
  const auto triangles = mesh.triangles();
  const auto at = [&](std::size_t triangle, std::size_t k) {
    return corner[kSides * triangle + k];
  };

  // Normals that do not change with the triangulation (Max 1999).
  std::vector<Vec3> normals(corner.size());
  std::vector<Vec3> faces(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::array<std::size_t, kSides> order = sheets.order(i);
    const auto corners = mesh.corners(i);
    const Vec3 doubled =
        cross(corners[order[1]] - corners[order[0]], corners[order[2]] - corners[order[0]]);
    faces[i] = normalized(doubled);
    for (std::size_t k = 0; k < kSides; ++k) {
      const double weight = squared_length(corners[next(k)] - corners[k]) *
                            squared_length(corners[next(next(k))] - corners[k]);
      if (weight > 0.0) normals[at(i, k)] += doubled / weight;
    }
  }
  for (Vec3& normal : normals) normal = normalized(normal);
  // At a crease a vertex moves farther, so that the faces beside it move by half the thickness.
  constexpr double kLeastCosine = 0.5;
  std::vector<double> cosines(corner.size(), 1.0);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (faces[i] == Vec3{}) continue;
    for (std::size_t k = 0; k < kSides; ++k) {
      double& cosine = cosines[at(i, k)];
      cosine = std::max(std::min(cosine, dot(faces[i], normals[at(i, k)])), kLeastCosine);
    }
  }

  std::vector<Vec3> vertices(2 * corner.size());
  std::vector<Triangle> solid;
  solid.reserve(2 * triangles.size());
  const auto above = [](std::uint32_t v) { return 2 * v; };
  const auto below = [](std::uint32_t v) { return 2 * v + 1; };
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const bool is_open = sheets.is_open(i);
    for (std::size_t k = 0; k < kSides; ++k) {
      const std::uint32_t v = at(i, k);
      const Vec3& place = mesh.vertices()[triangles[i][k]];
      const Vec3 off = (is_open ? 0.5 * thickness / cosines[v] : 0.0) * normals[v];
      vertices[above(v)] = place + off;
      vertices[below(v)] = place - off;
    }
    if (!is_open) {
      solid.push_back({above(at(i, 0)), above(at(i, 1)), above(at(i, 2))});
      continue;
    }
    const std::array<std::size_t, kSides> order = sheets.order(i);
    const std::uint32_t a = at(i, order[0]);
    const std::uint32_t b = at(i, order[1]);
    const std::uint32_t c = at(i, order[2]);
    solid.push_back({above(a), above(b), above(c)});
    solid.push_back({below(a), below(c), below(b)});
    for (std::size_t side = 0; side < kSides; ++side) {
      if (sheets.across(i, order[side], order[next(side)]) != kNoTriangle) continue;
      const std::uint32_t from = at(i, order[side]);
      const std::uint32_t to = at(i, order[next(side)]);
      solid.push_back({above(to), above(from), below(from)});
      solid.push_back({above(to), below(from), below(to)});
    }
  }
  return TriangleMesh::create(vertices, solid);
}

}  // namespace voxshell
