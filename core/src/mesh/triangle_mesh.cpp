#include "voxshell/triangle_mesh.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "base/text.h"

namespace voxshell {
namespace {

struct SamePlaceHash {
  std::size_t operator()(const Vec3& p) const {
    std::uint64_t hash = 0;
    for (const double c : {p.x, p.y, p.z}) {
      hash = (hash ^ std::bit_cast<std::uint64_t>(c)) * 0x9E3779B97F4A7C15u;
      hash ^= hash >> 32;
    }
    return static_cast<std::size_t>(hash);
  }
};

/// -0.0 and 0.0 are one place but two bit patterns.
Vec3 without_negative_zero(const Vec3& p) { return p + Vec3{0.0, 0.0, 0.0}; }

Error invalid_mesh(std::string message) { return {ErrorCode::kInvalidMesh, std::move(message)}; }

Result<std::monostate> check_finite(std::span<const Vec3> vertices) {
  const auto is_wrong = [](const Vec3& vertex) { return !is_finite(vertex); };
  const auto first = std::find_if(vertices.begin(), vertices.end(), is_wrong);
  if (first == vertices.end()) return std::monostate{};
  return invalid_mesh(format_text(
      "%td of %zu vertices of the mesh are not finite (first: vertex %td); remove "
      "them, or export the mesh again",
      std::count_if(first, vertices.end(), is_wrong), vertices.size(), first - vertices.begin()));
}

Error no_such_vertex(std::size_t triangle, std::uint32_t vertex, std::size_t vertices) {
  return invalid_mesh(
      format_text("triangle %zu of the mesh uses vertex %u, but there are %zu, counted from 0; "
                  "remove the triangle, or export the mesh again",
                  triangle, vertex, vertices));
}

Error no_area(std::size_t triangles) {
  return invalid_mesh(format_text(
      "mesh has no triangle with an area above zero, of %zu; export it again, with more "
      "digits",
      triangles));
}

/// Queries work on fourth powers of lengths in float32: beyond these they would over- or underflow.
Result<std::monostate> check_size(const Bounds& bounds) {
  constexpr double kSmallestSide = 1e-9;      // meters
  constexpr double kLargestCoordinate = 1e9;  // meters
  const double longest_side = bounds.extents()[bounds.longest_axis()];
  double farthest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    farthest = std::max({farthest, std::abs(bounds.lower[axis]), std::abs(bounds.upper[axis])});
  }
  if (longest_side < kSmallestSide) {
    return invalid_mesh(
        format_text("mesh is too small: its longest side is %.3g m (at least %g); "
                    "check its unit",
                    longest_side, kSmallestSide));
  }
  if (farthest > kLargestCoordinate) {
    return invalid_mesh(
        format_text("mesh is too large: it reaches %.3g m from its origin (at most "
                    "%g); check its unit",
                    farthest, kLargestCoordinate));
  }
  return std::monostate{};
}

/// One side of a triangle as seen from its edge.
struct HalfEdge {
  std::uint32_t low;   ///< smaller vertex index
  std::uint32_t high;  ///< larger vertex index
  bool forward;        ///< the triangle runs from low to high

  bool same_edge(const HalfEdge& other) const { return low == other.low && high == other.high; }
};

/// By their smaller vertex, then by the larger one.
std::vector<HalfEdge> sort_half_edges(std::span<const Triangle> triangles, std::size_t vertices) {
  const auto visit = [&](const auto& take) {
    for (const Triangle& t : triangles) {
      for (std::size_t side = 0; side < 3; ++side) {
        const std::uint32_t from = t[side];
        const std::uint32_t to = t[(side + 1) % 3];
        take(HalfEdge{std::min(from, to), std::max(from, to), from < to});
      }
    }
  };
  // Few have the same smaller vertex: once these are together, there is little left to sort.
  std::vector<std::size_t> next(vertices + 1, 0);
  visit([&](const HalfEdge& edge) { ++next[edge.low + 1]; });
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<HalfEdge> sorted(3 * triangles.size());
  visit([&](const HalfEdge& edge) { sorted[next[edge.low]++] = edge; });
  auto begin = sorted.begin();
  for (std::size_t vertex = 0; vertex < vertices; ++vertex) {
    const auto end = sorted.begin() + static_cast<std::ptrdiff_t>(next[vertex]);
    std::sort(begin, end, [](const HalfEdge& a, const HalfEdge& b) { return a.high < b.high; });
    begin = end;
  }
  return sorted;
}

}  // namespace

Result<TriangleMesh> TriangleMesh::create(std::span<const Vec3> vertices,
                                          std::span<const Triangle> triangles) {
  if (triangles.empty()) return invalid_mesh("mesh has no triangles");
  if (auto finite = check_finite(vertices); !finite) return finite.error();

  TriangleMesh mesh;
  std::unordered_map<Vec3, std::uint32_t, SamePlaceHash> index_at;
  index_at.reserve(vertices.size());
  mesh.triangles_.reserve(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    std::array<Vec3, 3> places{};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint32_t index = triangles[i][corner];
      if (index >= vertices.size()) return no_such_vertex(i, index, vertices.size());
      places[corner] = without_negative_zero(vertices[index]);
    }
    if (places[0] == places[1] || places[1] == places[2] || places[2] == places[0]) continue;

    Triangle merged{};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto [entry, is_new] =
          index_at.try_emplace(places[corner], static_cast<std::uint32_t>(mesh.vertices_.size()));
      if (is_new) {
        mesh.vertices_.push_back(places[corner]);
        mesh.bounds_.extend(places[corner]);
      }
      merged[corner] = entry->second;
    }
    mesh.triangles_.push_back(merged);
  }
  mesh.vertices_.shrink_to_fit();  // models keep them
  mesh.triangles_.shrink_to_fit();
  if (!mesh.triangles_.empty()) {
    if (auto sized = check_size(mesh.bounds_); !sized) return sized.error();
  }
  if (!(mesh.compute_area() > 0.0)) return no_area(triangles.size());
  return mesh;
}

Result<TriangleMesh> TriangleMesh::from_parts(std::vector<Vec3> vertices,
                                              std::vector<Triangle> triangles) {
  if (triangles.empty()) return invalid_mesh("mesh has no triangles");
  TriangleMesh mesh;
  mesh.vertices_ = std::move(vertices);
  mesh.triangles_ = std::move(triangles);
  if (auto finite = check_finite(mesh.vertices_); !finite) return finite.error();
  for (const Vec3& vertex : mesh.vertices_) mesh.bounds_.extend(vertex);
  if (auto sized = check_size(mesh.bounds_); !sized) return sized.error();
  std::vector<bool> is_used(mesh.vertices_.size());
  for (std::size_t i = 0; i < mesh.triangles_.size(); ++i) {
    const auto [a, b, c] = mesh.triangles_[i];
    for (const std::uint32_t index : {a, b, c}) {
      if (index >= mesh.vertices_.size()) return no_such_vertex(i, index, mesh.vertices_.size());
      is_used[index] = true;
    }
    if (a == b || b == c || c == a) {
      return invalid_mesh(format_text("triangle %zu of the mesh has less than three corners", i));
    }
  }
  if (const auto unused = std::find(is_used.begin(), is_used.end(), false);
      unused != is_used.end()) {
    return invalid_mesh(format_text("vertex %zu of the mesh is of no triangle",
                                    static_cast<std::size_t>(unused - is_used.begin())));
  }
  if (!(mesh.compute_area() > 0.0)) return no_area(mesh.triangles_.size());
  return mesh;
}

double TriangleMesh::compute_area() const {
  double doubled = 0.0;
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    const auto [a, b, c] = corners(i);
    doubled += length(cross(b - a, c - a));
  }
  return doubled / 2.0;
}

double TriangleMesh::compute_volume() const {
  const Vec3 origin = bounds_.center();
  double sixfold = 0.0;
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    const auto [a, b, c] = corners(i);
    sixfold += dot(a - origin, cross(b - origin, c - origin));
  }
  return sixfold / 6.0;
}

MeshDefects TriangleMesh::compute_defects() const {
  const std::vector<HalfEdge> half_edges = sort_half_edges(triangles_, vertices_.size());
  MeshDefects defects;
  for (std::size_t begin = 0, end = 0; begin < half_edges.size(); begin = end) {
    while (end < half_edges.size() && half_edges[end].same_edge(half_edges[begin])) ++end;
    const bool was_closed = defects.is_closed();
    if (end - begin == 1) ++defects.open_edges;
    if (end - begin > 2) ++defects.non_manifold_edges;
    if (end - begin == 2 && half_edges[begin].forward == half_edges[begin + 1].forward) {
      ++defects.flipped_edges;
    }
    if (was_closed && !defects.is_closed()) {
      const HalfEdge& edge = half_edges[begin];
      defects.first_location = 0.5 * (vertices_[edge.low] + vertices_[edge.high]);
    }
  }
  return defects;
}

TriangleMesh TriangleMesh::turned() const {
  TriangleMesh mesh = *this;
  for (Triangle& t : mesh.triangles_) std::swap(t[1], t[2]);
  return mesh;
}

Result<std::monostate> check_encloses_volume(const TriangleMesh& mesh) {
  const MeshDefects defects = mesh.compute_defects();
  if (!defects.is_closed()) {
    return invalid_mesh(
        format_text("mesh is not watertight: %zu open, %zu non-manifold and %zu wrongly oriented "
                    "edges (first near %s meters); repair it",
                    defects.open_edges, defects.non_manifold_edges, defects.flipped_edges,
                    format_point(defects.first_location).c_str()));
  }
  const double volume = mesh.compute_volume();
  const Vec3 extents = mesh.bounds().extents();
  const double box_volume = extents.x * extents.y * extents.z;
  constexpr double kFlatVolume = 1e-9;
  // Rounding gives a flat mesh a volume of either sign.
  if (std::abs(volume) <= kFlatVolume * box_volume) {
    return invalid_mesh(
        format_text("mesh encloses no volume: %.4g m3 in a box of %.4g m3", volume, box_volume));
  }
  if (volume < 0.0) {
    return invalid_mesh(
        format_text("mesh is inside out: its volume is %.4g m3; reverse the corner "
                    "order of its triangles",
                    volume));
  }
  return std::monostate{};
}

}  // namespace voxshell
