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

namespace voxshell::grid_field_bounds_test {
namespace {

using namespace test_support;

/// With one that winding numbers close.
std::vector<Body> bodies_and_a_bowl() {
  std::vector<Body> all = bodies();
  all.push_back({"bowl", opened(make_icosphere(0.5, 3), 0.2).mesh(), 0.05});
  return all;
}

TEST(GridFieldBounds, ValuesDifferByNoMoreThanTheirNodesCan) {
  Random random(77);
  for (const auto& [name, mesh, voxel_size] : bodies_and_a_bowl()) {
    const GridField field = build(mesh, voxel_size);
    const Bounds bounds = grown(mesh.bounds(), voxel_size);
    const GridFieldData& data = field.data();
    int checked = 0;
    double steepest = 0.0;
    for (int i = 0; i < 100'000; ++i) {
      const Vec3 p = point_in(random, bounds);
      const double apart = random.unit() * (i % 2 == 0 ? 1.0 : 12.0) * voxel_size;
      const Vec3 q = p + apart * random.direction();
      if (!is_fine_around(field, p) || !is_fine_around(field, q)) continue;
      ++checked;
      const double change = std::abs(distance_at(field, p) - distance_at(field, q));
      const double allowed =
          std::sqrt(apart * apart + 0.75 * voxel_size * voxel_size + data.gap()) +
          2.0 * data.node_error + 1e-6;
      ASSERT_LE(change, allowed) << name;
      steepest = std::max(steepest, change / allowed);
    }
    EXPECT_GT(checked, 10'000) << name;
    EXPECT_GT(steepest, data.gap() > 0.0 ? 0.9 : 0.97) << name;
  }
}

/// The smallest value that can be found in a ball: at random, downhill, and at the grid's nodes.
float find_smallest(const GridField& field, const Vec3& center, double radius, Random& random) {
  float smallest = field.distance(static_cast<Vec3f>(center));
  const auto try_point = [&](const Vec3& p) {
    const Vec3 away = p - center;
    const double far = length(away);
    // Stay within the ball also after rounding.
    const Vec3 clamped = far > radius ? center + (radius * (1.0 - 1e-7) / far) * away : p;
    smallest = std::min(smallest, field.distance(static_cast<Vec3f>(clamped)));
    return clamped;
  };
  for (int i = 0; i < 10; ++i) {
    try_point(center + radius * random.direction());
    try_point(center + (radius * random.unit()) * random.direction());
  }
  for (int start = 0; start < 3; ++start) {
    Vec3 p = start == 0 ? center : try_point(center + radius * random.direction());
    for (int i = 0; i < 12; ++i) {
      const Vec3f slope = field.gradient(static_cast<Vec3f>(p));
      p = try_point(p - (radius / (1 + i / 3)) * static_cast<Vec3>(slope));
    }
  }
  const double h = field.voxel_size();
  Vec3 low = center - Vec3{radius, radius, radius} - field.origin();
  for (int i = 0; i < 20; ++i) {
    Vec3 node;
    for (int axis = 0; axis < 3; ++axis) {
      const double cells = std::ceil(low[axis] / h) + std::floor(random.unit() * 2.0 * radius / h);
      node[axis] = field.origin()[axis] + cells * h;
    }
    if (length(node - center) < radius) try_point(node);
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
    int close = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vec3 center = point_in(random, grown(bounds, i % 4 == 0 ? 1.0 : 0.0));
      const double radius = std::pow(10.0, random.uniform(-3, 0));
      const auto center_f = static_cast<Vec3f>(center);
      const float bound = field.lower_bound(center_f, static_cast<float>(radius));
      const float smallest = find_smallest(field, static_cast<Vec3>(center_f), radius, random);
      ASSERT_GE(smallest, bound - 2e-6f) << name << " at " << center.x << " " << center.y << " "
                                         << center.z << ", radius " << radius;
      const bool center_in = is_in(bounds, center_f);
      const bool ball_in = is_in(Bounds{bounds.lower + Vec3{radius, radius, radius},
                                        bounds.upper - Vec3{radius, radius, radius}},
                                 center_f);
      in_the_grid += ball_in;
      across += center_in && !ball_in;
      outside += !center_in;
      deep += smallest < -static_cast<float>(voxel_size);
      // A useless bound holds, too.
      const auto value = static_cast<double>(field.distance(center_f));
      if (center_in && std::abs(value) < 2.0 * voxel_size && radius < voxel_size &&
          cell_size_of(field, brick_at(field, static_cast<Vec3>(center_f))) == 1.0) {
        ++close;
        const double spread = std::sqrt(radius * radius + 0.75 * voxel_size * voxel_size);
        const double expected = value - spread - 2.0 * field.data().node_error;
        const double floor = field.data().coarse_floors[0];
        if (expected < -floor) continue;  // near larger cells, perhaps
        ASSERT_GE(static_cast<double>(bound), std::min(expected, floor) - 1e-6);
      }
    }
    EXPECT_GT(in_the_grid, 500) << name;
    EXPECT_GT(across, 300) << name;
    EXPECT_GT(outside, 300) << name;
    if (std::string_view(name) != "plate" && std::string_view(name) != "wedge") {
      EXPECT_GT(deep, 100) << name;
    }
    EXPECT_GT(close, 10) << name;
  }
}

TEST(GridFieldBounds, LowerBoundHoldsForBallsThatAreSmallBesideAVoxel) {
  Random random(79);
  for (const auto& [name, mesh, voxel_size] : bodies_and_a_bowl()) {
    const GridField field = build(mesh, voxel_size);
    const Bounds bounds = grown(mesh.bounds(), voxel_size);
    double closest = 1.0;  // voxels
    for (int i = 0; i < 20'000; ++i) {
      const Vec3 center = static_cast<Vec3>(static_cast<Vec3f>(point_in(random, bounds)));
      const double radius = voxel_size * std::pow(10.0, random.uniform(-3, -0.5));
      const float bound = field.lower_bound(static_cast<Vec3f>(center), static_cast<float>(radius));
      const float smallest = find_smallest(field, center, radius, random);
      ASSERT_GE(smallest, bound - 2e-6f) << name << " at " << center.x << " " << center.y << " "
                                         << center.z << ", radius " << radius;
      closest = std::min(closest, static_cast<double>(smallest - bound) / voxel_size);
    }
    EXPECT_LT(closest, 0.01) << name;
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
}  // namespace voxshell::grid_field_bounds_test
