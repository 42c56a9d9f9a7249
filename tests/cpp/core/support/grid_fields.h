#pragma once

#include <cstddef>
#include <cstdlib>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/grid_bricks.h"
#include "support/meshes.h"
#include "support/random.h"
#include "voxshell/bounds.h"
#include "voxshell/grid_field.h"

namespace voxshell::test_support {

inline GridField build(const TriangleMesh& mesh, double voxel_size, double padding = 0.0) {
  auto field = GridField::build(mesh, {.voxel_size = voxel_size, .padding = padding});
  EXPECT_TRUE(field) << field.error().message;
  if (!field) std::abort();
  return *std::move(field);
}

struct Body {
  const char* name;
  TriangleMesh mesh;
  double voxel_size;
};

/// About unit size. Turned out of the grid's axes, apart from the L-shape.
inline std::vector<Body> bodies() {
  Random random(70);
  const auto turned = [&](const Soup& soup) { return transformed(soup, random.pose(0.3)).mesh(); };
  std::vector<Body> all;
  all.push_back({"L-shape", make_l_shape(0.5).mesh(), 0.06});
  all.push_back({"torus", turned(make_torus(0.7, 0.25, 20, 12)), 0.07});
  all.push_back({"blob", turned(make_blob(0.6, 2)), 0.07});
  all.push_back({"wedge", turned(make_wedge(1.0, 0.08, 0.5)), 0.04});
  all.push_back({"spike", turned(make_spike(0.3, 1.2)), 0.05});
  all.push_back({"plate", turned(make_box({0.5, 0.4, 0.015})), 0.05});  // thinner than a voxel
  all.push_back({"hollow",
                 together(make_box({0.5, 0.5, 0.5}), inverted(make_box({0.35, 0.3, 0.25}))).mesh(),
                 0.05});
  return all;
}

inline Bounds grid_bounds(const GridField& field) {
  Bounds bounds;
  bounds.extend(field.origin());
  const auto [nx, ny, nz] = field.shape();
  bounds.extend(field.origin() + field.voxel_size() * Vec3{nx - 1.0, ny - 1.0, nz - 1.0});
  return bounds;
}

inline Vec3 point_in(Random& random, const Bounds& bounds) {
  return random.in_box(bounds.lower, bounds.upper);
}

inline Bounds grown(const Bounds& bounds, double by) {
  const Vec3 margin{by, by, by};
  return {bounds.lower - margin, bounds.upper + margin};
}

inline bool is_in(const Bounds& bounds, const Vec3f& p) {
  return squared_distance(bounds, static_cast<Vec3>(p)) == 0.0;
}

/// Whether all bricks that p or its surroundings lie in hold planes or cells of one voxel.
inline bool is_fine_around(const GridField& field, const Vec3& p) {
  const double h = field.voxel_size();
  for (int corner = 0; corner < 8; ++corner) {
    const Vec3 offset{(corner & 1) != 0 ? h : -h, (corner & 2) != 0 ? h : -h,
                      (corner & 4) != 0 ? h : -h};
    if (cell_size_of(field, brick_at(field, p + offset)) != 1.0) return false;
  }
  return true;
}

inline double distance_at(const GridField& field, const Vec3& p) {
  return static_cast<double>(field.distance(static_cast<Vec3f>(p)));
}

}  // namespace voxshell::test_support
