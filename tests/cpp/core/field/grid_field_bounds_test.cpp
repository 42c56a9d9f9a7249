#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "support/grid_bricks.h"
#include "support/grid_fields.h"
#include "support/meshes.h"
#include "support/random.h"
#include "voxshell/grid_field.h"

namespace voxshell {
namespace {

using namespace test_support;

TEST(GridFieldBounds, LocalConstantsBoundEveryPairAroundABrick) {
  Random random(77);
  // Between flat faces, where neighbours hold planes or agree to a quantum.
  std::vector<Body> flat;
  flat.push_back({"box", make_box({0.5, 0.4, 0.6}).mesh(), 0.02});
  flat.push_back({"turned", transformed(make_box({0.5, 0.4, 0.6}), random.pose(1.0)).mesh(), 0.02});
  flat.push_back({"L-shape", make_l_shape(0.5).mesh(), 0.02});
  for (const auto& [name, mesh, voxel_size] : flat) {
    const GridField field = build(mesh, voxel_size, 2 * voxel_size);
    const Bounds bounds = grid_bounds(field);
    const double reach = 8.0 * voxel_size;
    double steepest = 0.0;
    int checked = 0;
    for (int i = 0; i < 100'000; ++i) {
      const Vec3 p = point_in(random, bounds);
      const Vec3 q =
          p + random.unit() * (i % 2 == 0 ? 0.5 * voxel_size : reach) * random.direction();
      const std::size_t brick = brick_at(field, p);
      if (!has_local_constant(field, brick)) continue;
      ++checked;
      const double constant = local_constant(field, brick);
      const double apart = length(p - q);
      // Values outside the grid are never below that of its nearest point.
      const double change = distance_at(field, p) - distance_at(field, q);
      const double allowed = constant * apart + field.data().jump + 1e-6;
      ASSERT_LE(change, allowed) << name;
      if (is_in(bounds, static_cast<Vec3f>(q))) {
        ASSERT_GE(change, -allowed) << name;
      }
      steepest = std::max(
          steepest, length(static_cast<Vec3>(field.gradient(static_cast<Vec3f>(p)))) / constant);
    }
    EXPECT_GT(checked, 10'000) << name;
    EXPECT_LE(steepest, 1.0 + 1e-5) << name;
    EXPECT_GT(steepest, 0.75) << name;  // a constant far too large would prune nothing
  }
}

TEST(GridFieldBounds, LocalConstantIsOneBesideAFaceAndMoreAroundAnEdge) {
  const GridField field = build(make_box({1, 1, 1}).mesh(), 0.02);
  const double face = local_constant(field, brick_at(field, Vec3{0.01, 0.01, 1.01}));
  EXPECT_GE(face, 1.0);
  EXPECT_LE(face, 1.02);  // to bfloat16
  // Inside, the two slopes that meet over an edge are mixed: up to sqrt(2) of either.
  for (std::size_t brick = 0; brick < field.data().entries.size(); ++brick) {
    if (!has_local_constant(field, brick)) continue;
    EXPECT_GE(local_constant(field, brick), 1.0);
    EXPECT_LE(local_constant(field, brick), std::sqrt(3.0) * 1.02);
  }
}

TEST(GridFieldBounds, BoundsOfBricksHoldAndAreClose) {
  Random random(84);
  for (const auto& [name, mesh, voxel_size] : bodies()) {
    const GridField field = build(mesh, voxel_size);
    for (std::size_t brick = 0; brick < field.data().entries.size(); ++brick) {
      double lowest = 1e30;
      visit_nodes(field, brick,
                  [&](const Vec3&, double value) { lowest = std::min(lowest, value); });
      const double expected = lowest - field.interpolation_error() * cell_size_of(field, brick);
      ASSERT_LE(lowest_in(field, brick), expected + 1e-9) << name;
      ASSERT_GE(lowest_in(field, brick), expected - 0.01 * std::abs(expected)) << name;
    }
  }
}

/// The smallest value that can be found in a ball: at random, downhill, and at the grid's nodes.
float find_smallest(const GridField& field, const Vec3& centre, double radius, Random& random) {
  float smallest = field.distance(static_cast<Vec3f>(centre));
  const auto try_point = [&](const Vec3& p) {
    const Vec3 away = p - centre;
    const double far = length(away);
    // Stay within the ball also after rounding.
    const Vec3 clamped = far > radius ? centre + (radius * (1.0 - 1e-7) / far) * away : p;
    smallest = std::min(smallest, field.distance(static_cast<Vec3f>(clamped)));
    return clamped;
  };
  for (int i = 0; i < 10; ++i) {
    try_point(centre + radius * random.direction());
    try_point(centre + (radius * random.unit()) * random.direction());
  }
  for (int start = 0; start < 3; ++start) {
    Vec3 p = start == 0 ? centre : try_point(centre + radius * random.direction());
    for (int i = 0; i < 12; ++i) {
      const Vec3f slope = field.gradient(static_cast<Vec3f>(p));
      p = try_point(p - (radius / (1 + i / 3)) * static_cast<Vec3>(slope));
    }
  }
  const double h = field.voxel_size();
  Vec3 low = centre - Vec3{radius, radius, radius} - field.origin();
  for (int i = 0; i < 20; ++i) {
    Vec3 node;
    for (int axis = 0; axis < 3; ++axis) {
      const double cells = std::ceil(low[axis] / h) + std::floor(random.unit() * 2.0 * radius / h);
      node[axis] = field.origin()[axis] + cells * h;
    }
    if (length(node - centre) < radius) try_point(node);
  }
  return smallest;
}

TEST(GridFieldBounds, LowerBoundHoldsInAcrossAndOutsideTheGrid) {
  Random random(78);
  for (const auto& [name, mesh, voxel_size] : bodies()) {
    const GridField field = build(mesh, voxel_size, 2 * voxel_size);
    const Bounds bounds = grid_bounds(field);
    int in_the_grid = 0;
    int across = 0;
    int outside = 0;
    int deep = 0;
    double slack = 0.0;
    for (int i = 0; i < 4000; ++i) {
      const Vec3 centre = point_in(random, grown(bounds, i % 4 == 0 ? 1.0 : 0.0));
      const double radius = std::pow(10.0, random.uniform(-3, 0));
      const auto centre_f = static_cast<Vec3f>(centre);
      const float bound = field.lower_bound(centre_f, static_cast<float>(radius));
      const float smallest = find_smallest(field, static_cast<Vec3>(centre_f), radius, random);
      ASSERT_GE(smallest, bound - 2e-6f) << name << " at " << centre.x << " " << centre.y << " "
                                         << centre.z << ", radius " << radius;
      const bool centre_in = is_in(bounds, centre_f);
      const bool ball_in = is_in(Bounds{bounds.lower + Vec3{radius, radius, radius},
                                        bounds.upper - Vec3{radius, radius, radius}},
                                 centre_f);
      in_the_grid += ball_in;
      across += centre_in && !ball_in;
      outside += !centre_in;
      deep += smallest < -static_cast<float>(voxel_size);
      const std::size_t brick = brick_at(field, centre);
      if (ball_in && radius < voxel_size && has_local_constant(field, brick)) {
        const double jump = field.data().jump;
        const double missing = static_cast<double>(smallest - bound) - jump - 1e-6;
        slack = std::max(slack, missing / (radius * local_constant(field, brick)));
      }
    }
    EXPECT_GT(in_the_grid, 500) << name;
    EXPECT_GT(across, 300) << name;
    EXPECT_GT(outside, 300) << name;
    if (std::string_view(name) != "plate" && std::string_view(name) != "wedge") {
      EXPECT_GT(deep, 100) << name;
    }
    // A useless bound holds, too: small balls in the grid must be answered tightly.
    EXPECT_LT(slack, 2.0) << name;
  }
}

TEST(GridFieldBounds, LowerBoundOfABallDeepInsideIsBelowZero) {
  // Regression: the distance to the surface's bounds, which is 0 in there, is no bound inside.
  const GridField field = build(make_box({1, 1, 1}).mesh(), 0.1);
  EXPECT_LE(field.lower_bound({0, 0, 0}, 0.01f), -0.99f);
  EXPECT_GE(field.lower_bound({0, 0, 0}, 0.01f), -2.0f);
}

TEST(GridFieldBounds, LowerBoundIsTightFarAway) {
  const GridField field = build(make_box({1, 1, 1}).mesh(), 0.1);
  // The surface may be to the side of what the grid's border sees.
  EXPECT_GE(field.lower_bound({101, 0, 0}, 1.0f), 99.0f - 2.0f);
  EXPECT_LE(field.lower_bound({101, 0, 0}, 1.0f), 99.0f);
}

TEST(GridFieldBounds, ReachHoldsTheGrid) {
  for (const auto& [name, mesh, voxel_size] : bodies()) {
    const GridField field = build(mesh, voxel_size);
    const Bounds bounds = grid_bounds(field);
    EXPECT_GE(field.reach(), std::max(length(bounds.lower), length(bounds.upper)));
  }
}

}  // namespace
}  // namespace voxshell
