#include "mesh/closest_point.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "support/brute_force.h"
#include "support/closest_point_tree.h"
#include "support/meshes.h"
#include "support/random.h"

namespace voxshell::closest_point_test {
namespace {

using namespace test_support;

void expect_closest_on_triangle(const Vec3& p, const std::array<Vec3, 3>& corners,
                                double tolerance) {
  const Vec3 closest = closest_point_on_triangle(p, corners);
  ASSERT_TRUE(is_finite(closest));
  ASSERT_LE(distance_to_triangle(closest, corners), tolerance);
  ASSERT_NEAR(length(p - closest), distance_to_triangle(p, corners), tolerance);
}

TEST(ClosestPointOnTriangle, LiesOnFaceEdgesAndCorners) {
  const std::array<Vec3, 3> t{Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{0, 4, 0}};
  EXPECT_EQ(closest_point_on_triangle({1, 1, 5}, t), (Vec3{1, 1, 0}));
  EXPECT_EQ(closest_point_on_triangle({2, -3, 1}, t), (Vec3{2, 0, 0}));
  EXPECT_EQ(closest_point_on_triangle({-3, 2, 1}, t), (Vec3{0, 2, 0}));
  EXPECT_EQ(closest_point_on_triangle({4, 4, -1}, t), (Vec3{2, 2, 0}));
  EXPECT_EQ(closest_point_on_triangle({-1, -2, 3}, t), (Vec3{0, 0, 0}));
  EXPECT_EQ(closest_point_on_triangle({7, -1, 0}, t), (Vec3{4, 0, 0}));
  EXPECT_EQ(closest_point_on_triangle({-1, 9, 0}, t), (Vec3{0, 4, 0}));
}

TEST(ClosestPointOnTriangle, AgreesWithBruteForceOnRandomTriangles) {
  Random random(30);
  for (int i = 0; i < 200'000; ++i) {
    const std::array<Vec3, 3> corners{random.in_cube(1), random.in_cube(1), random.in_cube(1)};
    expect_closest_on_triangle(random.in_cube(2), corners, 1e-12);
  }
}

TEST(ClosestPointOnTriangle, AgreesWithBruteForceOnSmallIntegers) {
  // Right on features, degenerate triangles included.
  Random random(31);
  const auto lattice = [&] {
    return Vec3{static_cast<double>(random.below(4)), static_cast<double>(random.below(4)),
                static_cast<double>(random.below(4))};
  };
  for (int i = 0; i < 200'000; ++i) {
    expect_closest_on_triangle(lattice(), {lattice(), lattice(), lattice()}, 1e-13);
  }
}

TEST(ClosestPointOnTriangle, OfTrianglesWithoutAreaLiesOnTheirSegment) {
  Random random(32);
  for (int i = 0; i < 100'000; ++i) {
    const Vec3 a = random.in_cube(1);
    const Vec3 b = random.in_cube(1);
    const Vec3 c = a + random.uniform(-1, 2) * (b - a);
    expect_closest_on_triangle(random.in_cube(2), {a, b, c}, 1e-7);
  }
}

TEST(ClosestPointOnTriangle, OfSliversIsOnThem) {
  Random random(33);
  for (int i = 0; i < 200'000; ++i) {
    const Vec3 a = random.in_cube(1);
    const Vec3 b = random.in_cube(1);
    const double height = std::pow(10.0, random.uniform(-15, -2));
    const Vec3 c = a + random.unit() * (b - a) + height * random.direction();
    const std::array<Vec3, 3> sliver{a, b, c};
    // Half of the points near the sliver, where its own width matters.
    const Vec3 p = i % 2 == 0 ? random.in_cube(2)
                              : a + random.unit() * (b - a) + (3 * height) * random.direction();
    const Vec3 closest = closest_point_on_triangle(p, sliver);
    ASSERT_TRUE(is_finite(closest));
    ASSERT_LE(distance_to_segment(closest, a, b), height + 1e-12);
    // A sliver lies within its height of its long side, so being wrong on it costs no more.
    ASSERT_NEAR(length(p - closest), distance_to_segment(p, a, b), height + 1e-9);
  }
}

std::vector<Soup> bodies() {
  return {make_corner_tetrahedron(1),
          make_box({0.5, 0.25, 1}),
          make_l_shape(0.5),
          make_wedge(2, 0.01, 0.5),
          make_spike(0.1, 2),
          make_icosphere(1, 2),
          make_blob(1, 2),
          make_torus(1, 0.25, 24, 12)};
}

TEST(ClosestPointTree, AgreesWithBruteForce) {
  Random random(34);
  for (const Soup& body : bodies()) {
    const TriangleMesh mesh = transformed(body, random.pose(1)).mesh();
    const ClosestPointTree tree(mesh);
    for (int i = 0; i < 500; ++i) {
      const Vec3 p = random.in_cube(i % 10 == 0 ? 100.0 : 2.0);
      const ClosestPoint closest = tree.find_closest(p);
      ASSERT_NEAR(std::sqrt(closest.squared_distance), distance_to_mesh(p, mesh), 1e-12);
      ASSERT_NEAR(length(closest.point - p), std::sqrt(closest.squared_distance), 1e-12);
      ASSERT_LT(closest.triangle, mesh.triangles().size());
      ASSERT_LE(distance_to_triangle(closest.point, mesh.corners(closest.triangle)), 1e-12);
    }
  }
}

TEST(ClosestPointTree, IsZeroOnTheSurface) {
  Random random(35);
  for (const Soup& body : bodies()) {
    const TriangleMesh mesh = body.mesh();
    const ClosestPointTree tree(mesh);
    for (const Vec3& v : mesh.vertices()) EXPECT_EQ(tree.find_closest(v).squared_distance, 0.0);
    for (int i = 0; i < 200; ++i) {
      const auto [a, b, c] = mesh.corners(random.below(mesh.triangles().size()));
      const double u = random.unit();
      const double v = random.uniform(0, 1 - u);
      const Vec3 p = a + u * (b - a) + v * (c - a);
      EXPECT_LE(tree.find_closest(p).squared_distance, 1e-26);
    }
  }
}

TEST(ClosestPointTree, DistanceDoesNotDependOnTheGuess) {
  Random random(36);
  for (const Soup& body : bodies()) {
    const TriangleMesh mesh = body.mesh();
    const ClosestPointTree tree(mesh);
    for (int i = 0; i < 1000; ++i) {
      // Lattice points as well, whose closest features tie.
      Vec3 p = random.in_cube(2);
      if (i % 2 == 0)
        p = {std::round(4 * p.x) / 4, std::round(4 * p.y) / 4, std::round(4 * p.z) / 4};
      const double squared = tree.find_closest(p).squared_distance;
      for (int k = 0; k < 5; ++k) {
        const auto guess = static_cast<std::uint32_t>(random.below(mesh.triangles().size()));
        ASSERT_EQ(tree.find_closest(p, guess).squared_distance, squared);
      }
    }
  }
}

TEST(ClosestPointTree, TakesTrianglesWithoutAreaAlsoAsTheGuess) {
  // A box whose first two triangles are a collinear one and the half of a side that goes with it.
  Soup soup = make_box({1, 1, 1});
  soup.vertices.push_back({0.5, -1, -1});
  const Triangle first = soup.triangles[0];
  ASSERT_EQ(first, (Triangle{0, 2, 1}));
  soup.triangles[0] = {0, 8, 1};
  soup.triangles.push_back({0, 2, 8});
  soup.triangles.push_back({8, 2, 1});
  const TriangleMesh mesh = soup.mesh();
  ASSERT_TRUE(check_encloses_volume(mesh));
  const ClosestPointTree tree(mesh);
  EXPECT_EQ(tree.find_closest({0.75, -3, -2}, 0).squared_distance, 5.0);
  Random random(38);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 p = random.in_cube(2);
    ASSERT_NEAR(std::sqrt(tree.find_closest(p, 0).squared_distance), distance_to_mesh(p, mesh),
                1e-12);
  }
}

TEST(ClosestPointTree, TakesASingleTriangleAndManyEqualOnes) {
  const Soup one{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
  const TriangleMesh single = one.mesh();
  EXPECT_EQ(ClosestPointTree(single).find_closest({0.25, 0.25, 2}).squared_distance, 4.0);

  Soup pile = one;
  pile.triangles.assign(1000, {0, 1, 2});  // no median separates them
  const TriangleMesh mesh = pile.mesh();
  EXPECT_EQ(ClosestPointTree(mesh).find_closest({0.25, 0.25, 2}).squared_distance, 4.0);
}

}  // namespace
}  // namespace voxshell::closest_point_test
