#include "shell/sample_by_tolerance.h"

#include <algorithm>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "support/brute_force.h"
#include "support/meshes.h"
#include "support/shells.h"

namespace voxshell::sample_by_tolerance_test {
namespace {

using namespace test_support;

TEST(SampleByTolerance, OnAWireThatHasNoThickness) {
  // Points half its thickness apart would be ten million.
  for (const double half : {1e-8, 1e-12, 1e-27}) {
    const TriangleMesh wire = make_box({0.5, half, half}).mesh();
    const std::size_t count = build_shell(wire, {.tolerance = 0.01}).size();
    EXPECT_GE(count, 1'000u);
    EXPECT_LE(count, 2'100u);
  }
}

TEST(SampleByTolerance, HasTheMeshesAreaAndNoTwoPointsAtOnePlace) {
  for (const Soup& soup : {make_box({0.1, 0.1, 0.1}), make_torus(0.1, 0.03, 60, 30),
                           make_blob(0.1, 3), make_wedge(0.3, 0.02, 0.2), make_spike(0.1, 0.3)}) {
    const TriangleMesh mesh = soup.mesh();
    const PointShell shell = build_shell(mesh, {.tolerance = 1e-4});
    double area = 0.0;
    for (const float a : shell.areas()) area += static_cast<double>(a);
    EXPECT_NEAR(area / mesh.compute_area(), 1.0, 1e-5);
    std::vector<Vec3f> points(shell.points().begin(), shell.points().end());
    std::sort(points.begin(), points.end(), [](const Vec3f& a, const Vec3f& b) {
      return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
    });
    EXPECT_EQ(std::adjacent_find(points.begin(), points.end()), points.end());
    for (std::size_t i = 0; i < points.size(); i += 17) {
      ASSERT_LT(distance_to_mesh(static_cast<Vec3>(points[i]), mesh), 1e-7);
    }
  }
}

TEST(SampleByTolerance, IsDenseWhereTheSurfaceCurvesAndSparseWhereItIsFlat) {
  const PointShell ball = build_shell(make_icosphere(0.1, 5).mesh(), {.tolerance = 5e-5});
  EXPECT_GT(ball.size(), 3'000u);
  EXPECT_LT(ball.size(), 15'000u);
  EXPECT_GT(build_shell(make_icosphere(0.1, 5).mesh(), {.tolerance = 1e-5}).size(),
            2 * ball.size());
  EXPECT_LT(build_shell(make_box({0.1, 0.1, 0.1}).mesh(), {.tolerance = 5e-5}).size(), 4'000u);
  EXPECT_GT(build_shell(make_box({0.1, 0.1, 0.1}).mesh(), {.tolerance = 5e-5}).size(), 3'000u);
}

TEST(SampleByTolerance, IsTheSameForAnyNumberOfThreads) {
  const TriangleMesh mesh = make_blob(0.1, 4).mesh();
  const auto one = PointShell::build(mesh, {.tolerance = 1e-4, .threads = 1});
  const auto three = PointShell::build(mesh, {.tolerance = 1e-4, .threads = 3});
  ASSERT_TRUE(one && three);
  const std::vector<Vec3f> a(one->points().begin(), one->points().end());
  const std::vector<Vec3f> b(three->points().begin(), three->points().end());
  EXPECT_EQ(a, b);
}

}  // namespace
}  // namespace voxshell::sample_by_tolerance_test
