#include "mesh/creases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "support/random.h"

namespace voxshell::creases_test {
namespace {

using namespace test_support;

double sum_lengths(const TriangleMesh& mesh, const Creases& creases) {
  double sum = 0.0;
  for (const BentEdge& edge : creases.sharp_edges) {
    sum += length(mesh.vertices()[edge.to] - mesh.vertices()[edge.from]);
  }
  return sum;
}

TEST(Creases, OfABoxAreItsTwelveEdgesAndEightCorners) {
  Random random(190);
  for (int i = 0; i < 20; ++i) {
    const auto mesh = transformed(make_box({0.5, 0.2, 0.1}), random.pose(1.0)).mesh();
    const Creases creases = find_creases(mesh, 1e-4);
    ASSERT_EQ(creases.sharp_edges.size(), 12u);
    EXPECT_EQ(creases.corners.size(), 8u);
    EXPECT_NEAR(sum_lengths(mesh, creases), 4 * 1.6, 1e-9);
    for (const BentEdge& edge : creases.sharp_edges) EXPECT_NEAR(edge.bend, 1.0, 1e-9);
    for (const Corner& corner : creases.corners) {
      EXPECT_GT(dot(corner.normal, mesh.vertices()[corner.vertex] - mesh.bounds().center()), 0.0);
    }
    for (const double spacing : creases.spacings) EXPECT_GT(spacing, 1e3);
  }
}

TEST(Creases, OfAnLShapeLeaveItsConcaveEdgeOut) {
  const TriangleMesh mesh = make_l_shape(1.0).mesh();
  const Creases creases = find_creases(mesh, 1e-3);
  EXPECT_EQ(creases.sharp_edges.size(), 17u);
  const auto edges = find_bent_edges(mesh);
  EXPECT_EQ(std::count_if(edges.begin(), edges.end(), [](const BentEdge& e) { return e.bend < 0; }),
            1);
}

TEST(Creases, OfAFineCylinderAreItsRims) {
  for (const std::uint32_t sides : {64u, 256u}) {
    const TriangleMesh mesh = make_cylinder(0.1, 0.5, sides).mesh();
    const Creases creases = find_creases(mesh, 1e-3);
    EXPECT_EQ(creases.sharp_edges.size(), 2 * sides);
    EXPECT_TRUE(creases.corners.empty());
    // The sides are as dense as a curvature of 10 / m asks for, the caps are flat.
    for (std::size_t i = 0; i < creases.spacings.size(); ++i) {
      const auto [a, b, c] = mesh.corners(i);
      const bool is_cap = a.z == b.z && b.z == c.z;
      if (is_cap) {
        EXPECT_GT(creases.spacings[i], 1e3);
      } else {
        EXPECT_NEAR(creases.spacings[i], std::sqrt(4.5 * 1e-3 * 0.1), 2e-3);
      }
    }
  }
}

TEST(Creases, OfACoarseCylinderAreAllItsEdges) {
  const TriangleMesh mesh = make_cylinder(0.1, 0.5, 8).mesh();
  const Creases creases = find_creases(mesh, 1e-4);
  EXPECT_EQ(creases.sharp_edges.size(), 24u);
  EXPECT_EQ(creases.corners.size(), 16u);
}

TEST(Creases, OfAConeHoldItsTip) {
  for (const std::uint32_t sides : {16u, 64u, 256u}) {
    const TriangleMesh mesh = make_cone(0.05, 0.3, sides).mesh();
    const Creases creases = find_creases(mesh, 1e-4);
    EXPECT_TRUE(std::any_of(creases.corners.begin(), creases.corners.end(), [&](const Corner& c) {
      return mesh.vertices()[c.vertex].z == 0.3 && c.normal.z > 0.99;
    })) << sides;
  }
}

TEST(Creases, OfASmoothSphereAreNone) {
  for (const int subdivisions : {3, 4, 5}) {
    const Creases creases = find_creases(make_icosphere(0.1, subdivisions).mesh(), 1e-3);
    EXPECT_TRUE(creases.sharp_edges.empty()) << subdivisions;
    for (const double spacing : creases.spacings) {
      EXPECT_NEAR(spacing, std::sqrt(4.5 * 1e-3 * 0.1), 7e-3);
    }
  }
}

TEST(Creases, HoldTheEdgesOfAnOpenMesh) {
  const TriangleMesh mesh = opened(make_box({0.5, 0.5, 0.5}), 0.4).mesh();
  const Creases creases = find_creases(mesh, 1e-3);
  const auto open = std::count_if(creases.sharp_edges.begin(), creases.sharp_edges.end(),
                                  [](const BentEdge& e) { return e.triangle_count == 1; });
  EXPECT_EQ(open, 4);
  EXPECT_EQ(creases.sharp_edges.size(), 12u);
}

TEST(Creases, SeeThroughNeedles) {
  // A needle along the edge of a box, as exporters leave them.
  Soup soup = make_box({0.5, 0.5, 0.5});
  const TriangleMesh whole = soup.mesh();
  const auto edges = find_bent_edges(whole);
  const auto sharp =
      std::find_if(edges.begin(), edges.end(), [](const BentEdge& e) { return e.bend > 0.5; });
  const auto middle = static_cast<std::uint32_t>(soup.vertices.size());
  const std::uint32_t from = sharp->from;
  const std::uint32_t to = sharp->to;
  soup.vertices.push_back(0.5 * (whole.vertices()[from] + whole.vertices()[to]));
  soup.vertices.assign(whole.vertices().begin(), whole.vertices().end());
  soup.vertices.push_back(0.5 * (whole.vertices()[from] + whole.vertices()[to]));
  soup.triangles.assign(whole.triangles().begin(), whole.triangles().end());
  // Split one of the two triangles at the middle of the edge, and close the gap by a needle.
  Triangle& split = soup.triangles[sharp->triangles[1]];
  Triangle other = split;
  for (std::uint32_t& corner : split) corner = corner == from ? middle : corner;
  for (std::uint32_t& corner : other) corner = corner == to ? middle : corner;
  soup.triangles.push_back(other);
  soup.triangles.push_back({to, from, middle});
  std::swap(soup.triangles.back()[0], soup.triangles.back()[1]);
  const TriangleMesh mesh = soup.mesh();
  const Creases creases = find_creases(mesh, 1e-3);
  EXPECT_GE(sum_lengths(mesh, creases), 12.0 - 1e-9);
  EXPECT_LE(sum_lengths(mesh, creases), 13.0 + 1e-9);
}

TEST(Creases, AreThoseOfTheShapeHoweverItsFacesAreTriangulated) {
  // A face split into many triangles adds no crease.
  Soup soup = make_box({0.5, 0.5, 0.5});
  for (int pass = 0; pass < 3; ++pass) {
    std::vector<Triangle> finer;
    for (const Triangle& t : soup.triangles) {
      const auto center = static_cast<std::uint32_t>(soup.vertices.size());
      soup.vertices.push_back((soup.vertices[t[0]] + soup.vertices[t[1]] + soup.vertices[t[2]]) /
                              3.0);
      for (std::size_t i = 0; i < 3; ++i) finer.push_back({t[i], t[(i + 1) % 3], center});
    }
    soup.triangles = finer;
  }
  const Creases creases = find_creases(soup.mesh(), 1e-3);
  EXPECT_EQ(creases.sharp_edges.size(), 12u);
  EXPECT_EQ(creases.corners.size(), 8u);
  for (const double spacing : creases.spacings) EXPECT_GT(spacing, 1.0);
}

}  // namespace
}  // namespace voxshell::creases_test
