#include "mesh/thicken.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
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

  /// Parts a triangle from the one across a side.
  void cut(std::uint32_t triangle, std::size_t side) {
    const std::uint32_t other = across_[triangle][side];
    across_[other][side_back(triangle, side, other)] = kNoTriangle;
    across_[triangle][side] = kNoTriangle;
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

/// Where the vertices of a sheet move.
struct Offsets {
  std::vector<std::uint32_t> corner;  ///< the vertex of each corner of each triangle
  std::vector<Vec3> normals;          ///< unit length, of each vertex
  std::vector<double> cosines;        ///< the least one with the normals of the faces about it
};

/// The direction from which the faces with these normals are seen least aslant: that of the center
/// of their smallest enclosing ball (Aubry and Loehner 2008, "On the 'most normal' normal"), as
/// Badoiu and Clarkson (2003, "Smaller core-sets for balls") find it.
Vec3 find_most_normal(std::span<const Vec3> faces, Vec3 center) {
  constexpr int kRounds = 512;
  for (int i = 1; i <= kRounds; ++i) {
    const auto farthest = std::ranges::min_element(
        faces, [&](const Vec3& a, const Vec3& b) { return dot(a, center) < dot(b, center); });
    center += (*farthest - center) / (i + 1.0);
  }
  return normalized(center);
}

/// A vertex moves farther at a crease, so that the faces beside it move by half the thickness, up
/// to this cosine.
constexpr double kLeastCosine = 0.5;
/// Where the offset of a vertex is more aslant to a face than this, faces are parted. Smaller:
/// sheets are thinner there. Below 0 they would be inside out.
constexpr double kLeastVisible = 0.05;

/// Finds in which directions the vertices of sheets move, as these are cut now.
class OffsetFinder {
 public:
  OffsetFinder(const TriangleMesh& mesh, const Sheets& sheets) {
    offsets_.corner = number_corners(mesh, sheets);
    add_normals(mesh, sheets);
    list_faces();
    for (std::uint32_t v = 0; v < offsets_.normals.size(); ++v) turn_to_faces(v);
  }

  const Offsets& offsets() const { return offsets_; }
  const Vec3& face(std::uint32_t triangle) const { return faces_[triangle]; }

 private:
  /// Normals that do not change with the triangulation (Max 1999).
  void add_normals(const TriangleMesh& mesh, const Sheets& sheets) {
    const std::size_t count = mesh.triangles().size();
    offsets_.normals.resize(kSides * count);
    faces_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::array<std::size_t, kSides> order = sheets.order(i);
      const auto corners = mesh.corners(i);
      const Vec3 doubled =
          cross(corners[order[1]] - corners[order[0]], corners[order[2]] - corners[order[0]]);
      faces_[i] = normalized(doubled);
      for (std::size_t k = 0; k < kSides; ++k) {
        const double weight = squared_length(corners[next(k)] - corners[k]) *
                              squared_length(corners[next(next(k))] - corners[k]);
        if (weight > 0.0) offsets_.normals[offsets_.corner[kSides * i + k]] += doubled / weight;
      }
    }
    for (Vec3& normal : offsets_.normals) normal = normalized(normal);
  }

  /// Puts the normals of the faces about each vertex one after the other.
  void list_faces() {
    first_.assign(offsets_.normals.size() + 1, 0);
    for (const std::uint32_t v : offsets_.corner) ++first_[v + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    about_.resize(offsets_.corner.size());
    std::vector<std::uint32_t> at(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < offsets_.corner.size(); ++i) {
      about_[at[offsets_.corner[i]]++] = faces_[i / kSides];
    }
    offsets_.cosines.assign(offsets_.normals.size(), 1.0);
  }

  void turn_to_faces(std::uint32_t v) {
    const auto begin = about_.begin() + first_[v];
    const auto end = about_.begin() + first_[v + 1];
    const std::span<const Vec3> faces(begin, std::remove(begin, end, Vec3{}));
    if (faces.empty()) return;
    const auto find_least = [&](const Vec3& normal) {
      double least = 1.0;
      for (const Vec3& face : faces) least = std::min(least, dot(face, normal));
      return least;
    };
    double& cosine = offsets_.cosines[v];
    cosine = find_least(offsets_.normals[v]);
    if (cosine >= kLeastCosine) return;
    const Vec3 better = find_most_normal(faces, offsets_.normals[v]);
    const double best = find_least(better);
    if (best <= cosine) return;
    offsets_.normals[v] = better;
    cosine = best;
  }

  Offsets offsets_;
  std::vector<Vec3> faces_;           ///< normals; 0 of triangles without an area
  std::vector<std::uint32_t> first_;  ///< where those about each vertex begin in about_
  std::vector<Vec3> about_;
};

/// At some vertices, no direction is outside of all faces. Sheets are cut along the sharp edges
/// that end there, and the pieces overlap.
Offsets find_offsets(const TriangleMesh& mesh, Sheets& sheets) {
  // Edges are sharp whose faces have normals with a smaller cosine: first the sharpest.
  constexpr std::array kSharp{0.0, 0.5, 0.9};
  OffsetFinder found(mesh, sheets);
  for (const double sharp : kSharp) {
    const Offsets& offsets = found.offsets();
    bool is_cut = false;
    for (std::size_t i = 0; i < offsets.corner.size(); ++i) {
      if (offsets.cosines[offsets.corner[i]] >= kLeastVisible) continue;
      const auto triangle = static_cast<std::uint32_t>(i / kSides);
      if (!sheets.is_open(triangle)) continue;
      const std::size_t k = i % kSides;
      for (const std::size_t side : {k, next(next(k))}) {
        const std::uint32_t other = sheets.across(triangle, side, next(side));
        if (other == kNoTriangle || dot(found.face(triangle), found.face(other)) > sharp) continue;
        sheets.cut(triangle, side);
        is_cut = true;
      }
    }
    if (is_cut) found = OffsetFinder(mesh, sheets);
  }
  return found.offsets();
}

}  // namespace

Result<TriangleMesh> thicken(const TriangleMesh& mesh, double thickness) {
  Sheets sheets(mesh);
  const Offsets offsets = find_offsets(mesh, sheets);
  const std::vector<std::uint32_t>& corner = offsets.corner;
  const auto triangles = mesh.triangles();
  const auto at = [&](std::size_t triangle, std::size_t k) {
    return corner[kSides * triangle + k];
  };

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
      const double cosine = std::max(offsets.cosines[v], kLeastCosine);
      const Vec3 off = (is_open ? 0.5 * thickness / cosine : 0.0) * offsets.normals[v];
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
