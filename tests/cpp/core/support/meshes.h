#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <numbers>
#include <utility>
#include <vector>

#include "voxshell/pose.h"
#include "voxshell/triangle_mesh.h"
#include "voxshell/vector.h"

namespace voxshell::test_support {

/// Vertices and triangles before anybody has checked them. The generators below make closed
/// surfaces, right side out, centered at the origin unless they say otherwise. Meters.
struct Soup {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;

  /// Ends the test program where the mesh is refused: for meshes that are meant to be fine.
  TriangleMesh mesh() const {
    auto created = TriangleMesh::create(vertices, triangles);
    if (!created) std::abort();
    return *std::move(created);
  }
};

inline Soup transformed(Soup soup, const Pose& pose) {
  for (Vec3& v : soup.vertices) v = pose.transform_point(v);
  return soup;
}

inline Soup moved(Soup soup, const Vec3& offset) {
  return transformed(std::move(soup), Pose{{}, offset});
}

inline Soup scaled(Soup soup, double factor) {
  for (Vec3& v : soup.vertices) v = factor * v;
  return soup;
}

inline Soup inverted(Soup soup) {
  for (Triangle& t : soup.triangles) std::swap(t[1], t[2]);
  return soup;
}

inline Soup together(Soup a, const Soup& b) {
  const auto offset = static_cast<std::uint32_t>(a.vertices.size());
  a.vertices.insert(a.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const Triangle& t : b.triangles) {
    a.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  }
  return a;
}

/// The corner of a cube: right angles at the origin, legs of length `leg`. Volume leg^3 / 6.
inline Soup make_corner_tetrahedron(double leg) {
  return {{{0, 0, 0}, {leg, 0, 0}, {0, leg, 0}, {0, 0, leg}},
          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
}

/// A polygon (counter-clockwise seen from +z) drawn out from z = low to high; `caps` triangulates
/// it.
inline Soup make_prism(const std::vector<std::array<double, 2>>& polygon,
                       const std::vector<Triangle>& caps, double low, double high) {
  Soup soup;
  const auto n = static_cast<std::uint32_t>(polygon.size());
  for (const double z : {low, high}) {
    for (const auto& [x, y] : polygon) soup.vertices.push_back({x, y, z});
  }
  for (const Triangle& t : caps) {
    soup.triangles.push_back({t[0], t[2], t[1]});
    soup.triangles.push_back({t[0] + n, t[1] + n, t[2] + n});
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    soup.triangles.push_back({i, j, j + n});
    soup.triangles.push_back({i, j + n, i + n});
  }
  return soup;
}

/// About z, its middle at the origin.
inline Soup make_cylinder(double radius, double height, std::uint32_t sides) {
  std::vector<std::array<double, 2>> polygon;
  std::vector<Triangle> caps;
  for (std::uint32_t i = 0; i < sides; ++i) {
    polygon.push_back({radius * std::cos(2.0 * std::numbers::pi * i / sides),
                       radius * std::sin(2.0 * std::numbers::pi * i / sides)});
    if (i >= 2) caps.push_back({0, i - 1, i});
  }
  return make_prism(polygon, caps, -height / 2, height / 2);
}

/// Its base at z = 0, its tip above it.
inline Soup make_cone(double radius, double height, std::uint32_t sides) {
  Soup soup{{{0, 0, height}}, {}};
  for (std::uint32_t i = 0; i < sides; ++i) {
    soup.vertices.push_back({radius * std::cos(2.0 * std::numbers::pi * i / sides),
                             radius * std::sin(2.0 * std::numbers::pi * i / sides), 0});
    soup.triangles.push_back({0, i + 1, (i + 1) % sides + 1});
    if (i >= 2) soup.triangles.push_back({1, i + 1, i});
  }
  return soup;
}

inline Soup make_box(const Vec3& half) {
  return make_prism({{-half.x, -half.y}, {half.x, -half.y}, {half.x, half.y}, {-half.x, half.y}},
                    {{0, 1, 2}, {0, 2, 3}}, -half.z, half.z);
}

/// Three cubes of edge `side` in an L: [0, 2] x [0, 2] x [0, 1] sides without the quadrant beyond
/// (1, 1). Not centered. Volume 3 side^3.
inline Soup make_l_shape(double side) {
  const double s = side;
  return make_prism({{0, 0}, {2 * s, 0}, {2 * s, s}, {s, s}, {s, 2 * s}, {0, 2 * s}},
                    {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}}, 0.0, s);
}

/// A blade: `length` along x, `thickness` high at x = 0 and an edge at x = length.
inline Soup make_wedge(double length, double thickness, double width) {
  return make_prism({{0, -thickness / 2}, {length, 0}, {0, thickness / 2}}, {{0, 1, 2}}, -width / 2,
                    width / 2);
}

/// A square pyramid on [-base/2, base/2]^2 at z = 0 with its apex at z = height.
inline Soup make_spike(double base, double height) {
  const double b = base / 2;
  return {{{-b, -b, 0}, {b, -b, 0}, {b, b, 0}, {-b, b, 0}, {0, 0, height}},
          {{0, 2, 1}, {0, 3, 2}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}}};
}

/// Each triangle in four, so many times.
inline Soup subdivided(Soup soup, int subdivisions) {
  for (int pass = 0; pass < subdivisions; ++pass) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
    const auto middle = [&](std::uint32_t a, std::uint32_t b) {
      const auto [entry, is_new] =
          middles.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(soup.vertices.size()));
      if (is_new) soup.vertices.push_back(0.5 * (soup.vertices[a] + soup.vertices[b]));
      return entry->second;
    };
    std::vector<Triangle> finer;
    for (const auto& [a, b, c] : soup.triangles) {
      const std::uint32_t ab = middle(a, b);
      const std::uint32_t bc = middle(b, c);
      const std::uint32_t ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    soup.triangles = std::move(finer);
  }
  return soup;
}

/// A sphere of 20 * 4^subdivisions triangles; all vertices at `radius`.
inline Soup make_icosphere(double radius, int subdivisions) {
  const double g = (1.0 + std::sqrt(5.0)) / 2.0;
  Soup soup{{{-1, g, 0},
             {1, g, 0},
             {-1, -g, 0},
             {1, -g, 0},
             {0, -1, g},
             {0, 1, g},
             {0, -1, -g},
             {0, 1, -g},
             {g, 0, -1},
             {g, 0, 1},
             {-g, 0, -1},
             {-g, 0, 1}},
            {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
             {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
             {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}}};
  soup = subdivided(std::move(soup), subdivisions);
  for (Vec3& v : soup.vertices) v = radius * normalized(v);
  return soup;
}

/// A star-shaped bumpy body: not convex, no symmetry, radius within 35 % of `radius`.
inline Soup make_blob(double radius, int subdivisions) {
  Soup soup = make_icosphere(1.0, subdivisions);
  for (Vec3& v : soup.vertices) {
    const double bumps = 0.15 * std::sin(4.0 * v.x + 1.0) * std::cos(3.0 * v.y) +
                         0.12 * std::sin(5.0 * v.z - 2.0 * v.x) + 0.08 * v.x;
    v = (radius * (1.0 + bumps)) * v;
  }
  return soup;
}

/// A ring about the z axis: genus 1.
inline Soup make_torus(double major, double minor, std::uint32_t around, std::uint32_t across) {
  constexpr double kTau = 6.283185307179586;
  Soup soup;
  for (std::uint32_t i = 0; i < around; ++i) {
    const double u = kTau * i / around;
    for (std::uint32_t j = 0; j < across; ++j) {
      const double v = kTau * j / across;
      const double r = major + minor * std::cos(v);
      soup.vertices.push_back({r * std::cos(u), r * std::sin(u), minor * std::sin(v)});
      const std::uint32_t i2 = (i + 1) % around;
      const std::uint32_t j2 = (j + 1) % across;
      const auto at = [&](std::uint32_t a, std::uint32_t b) { return a * across + b; };
      soup.triangles.push_back({at(i, j), at(i2, j), at(i2, j2)});
      soup.triangles.push_back({at(i, j), at(i2, j2), at(i, j2)});
    }
  }
  return soup;
}

/// Without the triangles whose corners all lie above z = `height`.
inline Soup opened(Soup soup, double height) {
  std::erase_if(soup.triangles, [&](const Triangle& t) {
    return soup.vertices[t[0]].z > height && soup.vertices[t[1]].z > height &&
           soup.vertices[t[2]].z > height;
  });
  return soup;
}

}  // namespace voxshell::test_support
