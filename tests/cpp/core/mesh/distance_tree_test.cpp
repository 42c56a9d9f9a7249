#include "mesh/distance_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "simd/isa.h"
#include "support/brute_force.h"
#include "support/closest_point_tree.h"
#include "support/meshes.h"
#include "support/random.h"

namespace voxshell::distance_tree_test {
namespace {

using namespace test_support;

constexpr double kTolerance = 2e-5;  // voxels, near triangles of ordinary size

/// Edges from a thousandth to ten voxels long, some without area, some nearly so.
Soup random_triangles(Random& random, std::size_t count, double reach) {
  Soup soup;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 a = random.in_cube(reach);
    const double size = std::pow(10.0, random.uniform(-3.0, 1.0));
    const Vec3 b = a + size * random.direction();
    Vec3 c = a + size * random.direction();
    if (i % 5 == 0) c = a + random.uniform(-1.0, 2.0) * (b - a);
    if (i % 5 == 1) c = a + random.uniform(-1.0, 2.0) * (b - a) + 1e-5 * random.direction();
    const auto first = static_cast<std::uint32_t>(soup.vertices.size());
    soup.vertices.insert(soup.vertices.end(), {a, b, c});
    soup.triangles.push_back({first, first + 1, first + 2});
  }
  return soup;
}

TEST(DistanceTree, TakesTrianglesThatAreAsSmallAsAPoint) {
  // A corner cut off by so little that a voxel's coordinates do not show it.
  const double tiny = 1e-19;
  const TriangleMesh mesh = Soup{{{tiny, 0, 0}, {0, tiny, 0}, {0, 0, tiny}, {1, 0, 0}, {0, 1, 0}},
                                 {{0, 3, 4}, {0, 4, 1}, {0, 1, 2}}}
                                .mesh();
  const Vec3 origin{-5.0, -5.0, -5.0};
  const DistanceTree tree(mesh, origin, 0.5, 1);
  DistanceTree::Scratch scratch;
  std::vector<float> distances(9 * 9 * 9);
  const Vec3 center{10.0, 10.0, 10.0};
  const float at_center = tree.find_nearest(center, 0).distance;
  ASSERT_NEAR(at_center, 0.0f, kTolerance);
  tree.measure_brick(center, at_center, scratch, distances);
  for (const float d : distances) ASSERT_LE(d, 4.0f * std::sqrt(3.0f) + 1e-3f);
}

TEST(DistanceTree, FindsTheDistanceToAnyTriangles) {
  Random random(200);
  for (const std::size_t count : {1u, 7u, 8u, 9u, 64u, 65u, 1000u}) {
    const TriangleMesh mesh = random_triangles(random, count, 10.0).mesh();
    const Vec3 origin = random.in_cube(5.0);
    const double voxel_size = random.uniform(0.5, 2.0);
    const DistanceTree tree(mesh, origin, voxel_size, 2);
    std::int32_t guess = 0;
    for (int i = 0; i < 300; ++i) {
      const Vec3 p = random.in_cube(i % 2 == 0 ? 12.0 : 40.0);
      const auto nearest = tree.find_nearest((p - origin) / voxel_size, guess);
      guess = nearest.guess;
      const double expected = distance_to_mesh(p, mesh) / voxel_size;
      // Thin triangles count as their longest edge.
      ASSERT_NEAR(nearest.distance, expected, 2e-4) << count;
      const double of_triangle =
          distance_to_triangle(p, mesh.corners(nearest.triangle)) / voxel_size;
      ASSERT_NEAR(of_triangle, expected, 4e-4) << count;
    }
  }
}

TEST(DistanceTree, MeasuresBricksOfNodes) {
  Random random(201);
  const std::vector<TriangleMesh> meshes{
      make_blob(20.0, 4).mesh(), make_box({30.0, 8.0, 15.0}).mesh(),
      make_torus(25.0, 6.0, 40, 20).mesh(), random_triangles(random, 500, 20.0).mesh(),
      make_blob(1.0, 5).mesh()};  // the last is too many triangles for a brick
  for (const TriangleMesh& mesh : meshes) {
    const ClosestPointTree exact(mesh);
    const DistanceTree tree(mesh, {}, 1.0, 2);
    DistanceTree::Scratch scratch;
    std::vector<float> distances(729);
    for (int trial = 0; trial < 12; ++trial) {
      const Vec3 center = random.in_cube(trial % 2 == 0 ? 10.0 : 30.0);
      tree.measure_brick(center, tree.find_nearest(center, 0).distance, scratch, distances);
      for (std::size_t node = 0; node < 729; ++node) {
        const Vec3 p = center + Vec3{static_cast<double>(node % 9) - 4.0,
                                     static_cast<double>(node / 9 % 9) - 4.0,
                                     static_cast<double>(node / 81) - 4.0};
        const double expected = std::sqrt(exact.find_closest(p).squared_distance);
        ASSERT_NEAR(distances[node], expected, kTolerance + 2e-4);
      }
    }
  }
}

TEST(DistanceTree, IsExactBesideTrianglesOfAThousandVoxels) {
  Random random(202);
  const TriangleMesh mesh =
      transformed(make_box({4000.0, 900.0, 2000.0}), random.pose(10.0)).mesh();
  const Vec3 origin = mesh.bounds().lower;
  const DistanceTree tree(mesh, origin, 1.0, 1);
  const ClosestPointTree exact(mesh);
  for (int i = 0; i < 2000; ++i) {
    const auto corners = mesh.corners(random.below(mesh.triangles().size()));
    const double u = random.unit();
    const double v = random.unit() * (1.0 - u);
    const Vec3 on_surface =
        corners[0] + u * (corners[1] - corners[0]) + v * (corners[2] - corners[0]);
    const Vec3 p = on_surface + 5.0 * random.in_cube(1.0);
    const double expected = std::sqrt(exact.find_closest(p).squared_distance);
    ASSERT_NEAR(tree.find_nearest(p - origin, 0).distance, expected, 1e-3);
  }
}

TEST(DistanceTree, FindsAllTrianglesWithin) {
  Random random(203);
  const TriangleMesh mesh = make_blob(10.0, 3).mesh();
  const DistanceTree tree(mesh, {}, 1.0, 1);
  std::vector<std::uint32_t> found;
  for (int i = 0; i < 200; ++i) {
    const Vec3 p = random.in_cube(15.0);
    const double radius = random.uniform(0.0, 10.0);
    ASSERT_TRUE(tree.find_within(p, radius, 2000, found));
    for (std::uint32_t t = 0; t < mesh.triangles().size(); ++t) {
      if (distance_to_triangle(p, mesh.corners(t)) > radius) continue;
      ASSERT_NE(std::find(found.begin(), found.end(), t), found.end());
    }
  }
  EXPECT_FALSE(tree.find_within({}, 100.0, 64, found));
}

TEST(DistanceTree, IsTheSameBitsWithEveryInstructionSetAndNumberOfThreads) {
#ifdef VOXSHELL_HAS_AVX2
  if (simd::active_isa() != simd::Isa::kAvx2) GTEST_SKIP() << "this processor has no AVX2";
  Random random(204);
  // A tree of two blocks, by hand, as kernels take it.
  const TriangleMesh mesh = make_blob(6.0, 2).mesh();
  const DistanceTree one(mesh, {}, 1.0, 1);
  const DistanceTree seven(mesh, {}, 1.0, 7);
  const simd::MeshTreeView tree = one.view();
  std::vector<std::int32_t> indices(512 * 17);
  std::vector<float> floats(512 * (2 * simd::kBlockFloats + 8));
  float* gathered = floats.data() + 512 * simd::kBlockFloats;
  const simd::BrickScratch scratch{512,
                                   indices.data(),
                                   floats.data(),
                                   gathered,
                                   gathered + 512 * simd::kBlockFloats,
                                   indices.data() + 512,
                                   indices.data() + 512 * 9};
  for (int i = 0; i < 50; ++i) {
    const Vec3 p = random.in_cube(12.0);
    const std::array<double, 3> place{p.x, p.y, p.z};
    const auto portable = simd::kPortableMeshDistance.find_nearest(tree, place.data(), 0);
    const auto avx2 = simd::kAvx2MeshDistance.find_nearest(tree, place.data(), 0);
    ASSERT_EQ(portable.distance, avx2.distance);
    ASSERT_EQ(portable.triangle, avx2.triangle);
    ASSERT_EQ(seven.find_nearest(p, 0).distance, avx2.distance);
    std::array<float, 729> by_portable{};
    std::array<float, 729> by_avx2{};
    ASSERT_TRUE(simd::kPortableMeshDistance.measure_brick(tree, place.data(), portable.distance,
                                                          scratch, by_portable.data()));
    ASSERT_TRUE(simd::kAvx2MeshDistance.measure_brick(tree, place.data(), avx2.distance, scratch,
                                                      by_avx2.data()));
    ASSERT_EQ(std::memcmp(by_portable.data(), by_avx2.data(), sizeof by_avx2), 0);
  }
#endif
}

TEST(DistanceTree, GuessesOfTrianglesAreBlocksThatHoldThem) {
  const TriangleMesh mesh = make_torus(25.0, 6.0, 40, 20).mesh();
  const DistanceTree tree(mesh, {}, 1.0, 1);
  const std::vector<std::int32_t> guesses = tree.list_guesses();
  ASSERT_EQ(guesses.size(), mesh.triangles().size());
  for (std::uint32_t triangle = 0; triangle < guesses.size(); ++triangle) {
    const auto [a, b, c] = mesh.corners(triangle);
    const DistanceTree::Nearest found = tree.find_nearest((a + b + c) / 3.0, guesses[triangle]);
    EXPECT_EQ(found.triangle, triangle);
    EXPECT_EQ(found.guess, guesses[triangle]);
  }
}

}  // namespace
}  // namespace voxshell::distance_tree_test
