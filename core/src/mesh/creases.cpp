#include "mesh/creases.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>

#include "mesh/edges.h"

namespace voxshell {
namespace {

constexpr double kTenDegrees = 0.17632698070846498;    // tangent of half of the 20 degrees
constexpr double kTwentyDegrees = 0.9396926207859084;  // cosine
constexpr double kMostBend = 1e3;                      // of triangles folded onto each other

/// Triangles as edges see them.
struct Facets {
  std::vector<Vec3> normals;  ///< unit length; zero where a needle has none
  std::vector<double> areas;
};

Facets measure_facets(const TriangleMesh& mesh) {
  constexpr double kNarrow = 1e-9;  // of the longest side: less is rounding
  Facets facets;
  const std::size_t count = mesh.triangles().size();
  facets.normals.reserve(count);
  facets.areas.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto [a, b, c] = mesh.corners(i);
    const Vec3 doubled = cross(b - a, c - a);
    const double longest =
        std::max({squared_length(b - a), squared_length(c - b), squared_length(a - c)});
    const double size = length(doubled);
    facets.normals.push_back(size > kNarrow * longest ? doubled / size : Vec3{});
    facets.areas.push_back(0.5 * size);
  }
  return facets;
}

/// Needles face where the triangle beyond their longest side does.
void turn_needles(const TriangleMesh& mesh, std::span<const TriangleSide> sides, Facets& facets) {
  const std::vector<Vec3> own = facets.normals;
  std::vector<double> longest(own.size(), 0.0);
  visit_edges(sides, [&](std::span<const TriangleSide> edge) {
    if (edge.size() != 2) return;
    for (std::size_t i = 0; i < 2; ++i) {
      const std::uint32_t needle = edge[i].triangle;
      const Vec3& beyond = own[edge[1 - i].triangle];
      if (own[needle] != Vec3{} || beyond == Vec3{}) continue;
      const double squared =
          squared_length(mesh.vertices()[edge[i].high] - mesh.vertices()[edge[i].low]);
      if (squared <= longest[needle]) continue;
      longest[needle] = squared;
      facets.normals[needle] = beyond;
    }
  });
}

std::vector<BentEdge> measure_edges(const TriangleMesh& mesh, std::span<const TriangleSide> sides,
                                    const Facets& facets) {
  std::vector<BentEdge> edges;
  edges.reserve(sides.size() / 2);
  visit_edges(sides, [&](std::span<const TriangleSide> of_edge) {
    const TriangleSide& first = of_edge.front();
    const TriangleSide& second = of_edge[of_edge.size() > 1 ? 1 : 0];
    BentEdge edge{.from = first.is_forward ? first.low : first.high,
                  .to = first.is_forward ? first.high : first.low,
                  .triangles = {first.triangle, second.triangle},
                  .triangle_count = static_cast<std::uint32_t>(of_edge.size()),
                  .bend = 0.0,
                  .width = 0.0};
    const Vec3 along = mesh.vertices()[edge.to] - mesh.vertices()[edge.from];
    edge.width = (facets.areas[first.triangle] + facets.areas[second.triangle]) / length(along);
    if (edge.triangle_count == 2) {
      const bool is_flipped = first.is_forward == second.is_forward;
      const Vec3 n = facets.normals[first.triangle];
      const Vec3 m =
          is_flipped ? -facets.normals[second.triangle] : facets.normals[second.triangle];
      const Vec3 turn = cross(n, m);
      const double sine = length(turn);
      const double bend = std::min(kMostBend, sine / std::max(1.0 + dot(n, m), sine / kMostBend));
      if (sine > 0.0) edge.bend = is_flipped || dot(turn, along) > 0.0 ? bend : -bend;
    }
    edges.push_back(edge);
  });
  return edges;
}

bool is_sharp(const BentEdge& edge, double tolerance) {
  if (edge.triangle_count != 2) return true;
  // Points suffice for an edge that stands out by less.
  if (edge.bend <= 0.0 || edge.width * edge.bend <= 0.5 * tolerance) return false;
  // Between facets so wide that points along the edge would be more than its segments.
  constexpr double kWide = 18.0;
  const double angle = 2.0 * edge.bend;
  return edge.bend > kTenDegrees || edge.width * angle * angle > kWide * tolerance;
}

/// Sums of angles times lengths, over both sides of edges, by the edges' directions: divided by an
/// area, its eigenvalues are the curvatures there (Cohen-Steiner and Morvan 2003).
struct Bending {
  double xx = 0.0, yy = 0.0, zz = 0.0, xy = 0.0, yz = 0.0, zx = 0.0;
  double area = 0.0;
  double triangles = 1.0;  ///< by how often they were added

  void add(const Vec3& unit, double weight) {
    xx += weight * unit.x * unit.x;
    yy += weight * unit.y * unit.y;
    zz += weight * unit.z * unit.z;
    xy += weight * unit.x * unit.y;
    yz += weight * unit.y * unit.z;
    zx += weight * unit.z * unit.x;
  }
  void add(const Bending& b) {
    xx += b.xx;
    yy += b.yy;
    zz += b.zz;
    xy += b.xy;
    yz += b.yz;
    zx += b.zx;
    area += b.area;
    triangles += b.triangles;
  }

  /// The largest eigenvalue over the area: Newton's method from above on the characteristic
  /// polynomial, of which it is the largest root.
  double largest_curvature() const {
    if (!(area > 0.0)) return 0.0;
    const double trace = xx + yy + zz;
    const double minors = xx * yy - xy * xy + yy * zz - yz * yz + zz * xx - zx * zx;
    const double determinant =
        xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * zx) + zx * (xy * yz - yy * zx);
    double root = std::sqrt(xx * xx + yy * yy + zz * zz + 2.0 * (xy * xy + yz * yz + zx * zx));
    constexpr int kMostSteps = 40;
    for (int i = 0; i < kMostSteps; ++i) {
      const double value = ((root - trace) * root + minors) * root - determinant;
      const double slope = (3.0 * root - 2.0 * trace) * root + minors;
      if (!(slope > 0.0) || !(value > 0.0)) break;
      const double next = root - value / slope;
      if (!(next < root)) break;
      root = next;
    }
    return std::max(0.0, root / area);
  }
};

/// A place at a distance of d from the nearest point is curvature * d^2 / 2 above its tangent
/// plane. Points that voxels choose leave no gap of more than two thirds of a spacing, nearly
/// always.
double choose_spacing(double curvature, double tolerance) {
  constexpr double kSagittas = 4.5;
  return std::sqrt(kSagittas * tolerance / curvature);
}

std::vector<double> choose_spacings(const TriangleMesh& mesh, std::span<const BentEdge> edges,
                                    const std::vector<bool>& is_barrier, const Facets& facets,
                                    double tolerance) {
  std::vector<Bending> bending(facets.areas.size());
  for (std::size_t i = 0; i < bending.size(); ++i) bending[i].area = facets.areas[i];
  std::vector<std::array<std::uint32_t, 2>> neighbors;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    if (is_barrier[i]) continue;
    neighbors.push_back(edges[i].triangles);
    const Vec3 along = mesh.vertices()[edges[i].to] - mesh.vertices()[edges[i].from];
    const double size = length(along);
    for (const std::uint32_t triangle : edges[i].triangles) {
      bending[triangle].add(along / size, edges[i].bend * size);
    }
  }
  // Each round adds what is around the neighbors: it spreads as random walks do, over some 3.6
  // triangles more. A triangle is done where this area is as large as the spacing that it asks for.
  constexpr int kMostRounds = 32;
  constexpr double kTrianglesARound = 3.6;
  std::vector<double> spacings(bending.size(), 0.0);
  std::vector<Bending> wider;
  for (int round = 0;; ++round) {
    std::size_t left = 0;
    for (std::size_t i = 0; i < bending.size(); ++i) {
      if (spacings[i] > 0.0) continue;
      const Bending& b = bending[i];
      const double spacing = choose_spacing(b.largest_curvature(), tolerance);
      const double area = b.area / b.triangles * (1.0 + kTrianglesARound * round);
      if (round == kMostRounds || spacing * spacing <= area || std::isinf(spacing)) {
        spacings[i] = spacing;
      } else {
        ++left;
      }
    }
    if (left == 0) return spacings;
    wider = bending;
    for (const auto& [a, b] : neighbors) {
      wider[a].add(bending[b]);
      wider[b].add(bending[a]);
    }
    bending.swap(wider);
  }
}

/// The edges and triangles around a vertex.
struct Surroundings {
  Vec3 normal{};
  Vec3 neighbors{};      ///< their sum
  double edges = 0.0;    ///< the sum of their lengths
  double spacing = 0.0;  ///< the least of its triangles'
  std::uint32_t neighbor_count = 0;
  std::uint32_t sharp_count = 0;
  Vec3 first_direction{};  ///< along the first of its sharp edges
  bool turns = false;      ///< where it has two
};

std::vector<Corner> find_corners(const TriangleMesh& mesh, std::span<const BentEdge> edges,
                                 const std::vector<bool>& is_sharp_edge,
                                 std::span<const double> spacings, double tolerance) {
  const auto vertices = mesh.vertices();
  std::vector<Surroundings> around(vertices.size());
  for (std::size_t triangle = 0; triangle < spacings.size(); ++triangle) {
    const Triangle& t = mesh.triangles()[triangle];
    for (std::size_t i = 0; i < 3; ++i) {
      double& spacing = around[t[i]].spacing;
      spacing = spacing == 0.0 ? spacings[triangle] : std::min(spacing, spacings[triangle]);
      const Vec3 a = vertices[t[(i + 1) % 3]] - vertices[t[i]];
      const Vec3 b = vertices[t[(i + 2) % 3]] - vertices[t[i]];
      // Weights close to the angles (Max 1999).
      around[t[i]].normal += cross(a, b) / std::sqrt(squared_length(a) * squared_length(b));
    }
  }
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const Vec3 way = vertices[edges[i].to] - vertices[edges[i].from];
    const double size = length(way);
    const Vec3 along = way / size;
    const auto visit = [&](std::uint32_t vertex, std::uint32_t other, const Vec3& direction) {
      Surroundings& s = around[vertex];
      s.neighbors += vertices[other];
      s.edges += size;
      ++s.neighbor_count;
      if (!is_sharp_edge[i]) return;
      if (s.sharp_count++ == 0) s.first_direction = direction;
      if (s.sharp_count == 2) s.turns = dot(direction, s.first_direction) > -kTwentyDegrees;
    };
    visit(edges[i].from, edges[i].to, along);
    visit(edges[i].to, edges[i].from, -along);
  }
  std::vector<Corner> corners;
  for (std::uint32_t v = 0; v < vertices.size(); ++v) {
    const Surroundings& s = around[v];
    const Vec3 normal = normalized(s.normal);
    bool is_corner = s.sharp_count != 2 || s.turns;
    if (s.sharp_count == 0) {
      const Vec3 middle = s.neighbors / static_cast<double>(s.neighbor_count);
      // Facets that points lie more densely than take their vertices in.
      is_corner = dot(normal, vertices[v] - middle) > tolerance &&
                  s.edges >= s.spacing * static_cast<double>(s.neighbor_count);
    }
    if (is_corner) corners.push_back({v, normal});
  }
  return corners;
}

}  // namespace

std::vector<BentEdge> find_bent_edges(const TriangleMesh& mesh) {
  Facets facets = measure_facets(mesh);
  const std::vector<TriangleSide> sides = sort_sides(mesh.triangles(), mesh.vertices().size());
  turn_needles(mesh, sides, facets);
  return measure_edges(mesh, sides, facets);
}

Creases find_creases(const TriangleMesh& mesh, double tolerance) {
  Facets facets = measure_facets(mesh);
  const std::vector<TriangleSide> sides = sort_sides(mesh.triangles(), mesh.vertices().size());
  turn_needles(mesh, sides, facets);
  const std::vector<BentEdge> edges = measure_edges(mesh, sides, facets);
  std::vector<bool> is_sharp_edge(edges.size());
  std::vector<bool> is_barrier(edges.size());
  Creases creases;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    is_sharp_edge[i] = is_sharp(edges[i], tolerance);
    is_barrier[i] = is_sharp_edge[i] || edges[i].bend < -kTenDegrees;
    if (!is_sharp_edge[i]) continue;
    const auto [a, b] = edges[i].triangles;
    creases.sharp_edges.push_back(edges[i]);
    creases.edge_normals.push_back(normalized(facets.normals[a] + facets.normals[b]));
  }
  creases.spacings = choose_spacings(mesh, edges, is_barrier, facets, tolerance);
  creases.corners = find_corners(mesh, edges, is_sharp_edge, creases.spacings, tolerance);
  return creases;
}

}  // namespace voxshell
