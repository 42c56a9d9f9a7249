#include "voxshell/edge_segments.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <gtest/gtest.h>

#include "support/brute_force.h"
#include "support/meshes.h"
#include "support/random.h"
#include "voxshell/point_shell.h"

namespace voxshell::edge_segments_test {
namespace {

using namespace test_support;

PointShell build(const Soup& soup, double tolerance) {
  auto shell = PointShell::build(soup.mesh(), {.tolerance = tolerance});
  if (!shell) std::abort();
  return *std::move(shell);
}

double distance_to_edges(const Vec3& p, const EdgeSegments& edges) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const auto middle = static_cast<Vec3>(edges.middles()[i]);
    const auto half = static_cast<Vec3>(edges.halves()[i]);
    nearest = std::min(nearest, distance_to_segment(p, middle - half, middle + half));
  }
  return nearest;
}

TEST(EdgeSegments, CoverTheEdgesOfABoxAndItsCornersArePoints) {
  const Vec3 half{0.5, 0.2, 0.1};
  const PointShell shell = build(make_box(half), 1e-3);
  ASSERT_NE(shell.edges(), nullptr);
  const EdgeSegments& edges = *shell.edges();
  double sum = 0.0;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    sum += 2.0 * static_cast<double>(length(edges.halves()[i]));
    EXPECT_LE(length(edges.halves()[i]), edges.reach());
    EXPECT_NEAR(length(edges.normals()[i]), 1.0f, 1e-6f);
  }
  EXPECT_NEAR(sum, 8 * (half.x + half.y + half.z), 1e-4);
  EXPECT_LE(static_cast<double>(edges.reach()), 7.001e-3);
  EXPECT_LE(edges.bracket(), 1.001e-3);
  Random random(200);
  for (int i = 0; i < 300; ++i) {
    Vec3 p = random.in_box(-half, half);
    const std::size_t along = random.below(3);
    for (int axis = 0; axis < 3; ++axis) {
      if (axis != static_cast<int>(along)) p[axis] = std::copysign(half[axis], p[axis]);
    }
    ASSERT_LT(distance_to_edges(p, edges), 1e-6);
  }
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3f at{static_cast<float>((corner & 1) != 0 ? half.x : -half.x),
                   static_cast<float>((corner & 2) != 0 ? half.y : -half.y),
                   static_cast<float>((corner & 4) != 0 ? half.z : -half.z)};
    const BucketPoints points = shell.points();
    const auto found = std::find(points.begin(), points.end(), at);
    ASSERT_NE(found, points.end());
  }
}

TEST(EdgeSegments, AreAbsentFromUniformShellsAndSmoothBodies) {
  const auto uniform = PointShell::build(make_box({1, 1, 1}).mesh(), {.spacing = 0.1});
  ASSERT_TRUE(uniform);
  EXPECT_EQ(uniform->edges(), nullptr);
  EXPECT_EQ(uniform->element_count(), uniform->size());
  EXPECT_EQ(build(make_icosphere(0.1, 4), 1e-3).edges(), nullptr);
}

TEST(EdgeSegments, GrowLongerRatherThanTooMany) {
  const PointShell shell = build(make_box({1, 1, 1}), 1e-5);
  EXPECT_LE(shell.edges()->size(), EdgeSegments::kMostPieces);
  EXPECT_GT(shell.edges()->size(), EdgeSegments::kMostPieces / 2);
  EXPECT_GT(shell.edges()->bracket(), 1e-5);
}

}  // namespace
}  // namespace voxshell::edge_segments_test
