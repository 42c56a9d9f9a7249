#include <algorithm>
#include <cstddef>

#include <gtest/gtest.h>

#include "support/brute_force.h"
#include "support/grid_bricks.h"
#include "support/grid_fields.h"
#include "support/meshes.h"
#include "support/random.h"
#include "voxshell/grid_field.h"

namespace voxshell::grid_field_planes_test {
namespace {

using namespace test_support;

TEST(GridFieldPlanes, HoldsPlanesWhereAFaceIsFlat) {
  Random random(85);
  for (const Pose& pose : {Pose{}, random.pose(0.5), random.pose(2.0)}) {
    const TriangleMesh mesh = transformed(make_box({0.5, 0.4, 0.3}), pose).mesh();
    const double h = 0.01;
    const GridField field = build(mesh, h);
    const std::size_t bricks = field.data().entries.size();
    EXPECT_EQ(field.data().planes.size(), 4u * 6u);  // one a face, shared by its bricks
    std::size_t planes = 0;
    for (std::size_t brick = 0; brick < bricks; ++brick) {
      if (!entry_of(field, brick).is_plane) continue;
      ++planes;
      visit_nodes(field, brick, [&](const Vec3& p, double value) {
        if (random.below(2000) == 0) {
          ASSERT_NEAR(value, signed_distance_to_mesh(p, mesh), h / 512);
        }
      });
    }
    EXPECT_GT(planes, 0.4 * static_cast<double>(bricks));
  }
}

TEST(GridFieldPlanes, AroundAPlaneNothingElseComesNear) {
  Random random(86);
  for (const Pose& pose : {Pose{}, random.pose(0.5)}) {
    const TriangleMesh mesh = transformed(make_box({0.5, 0.4, 0.3}), pose).mesh();
    const GridField field = build(mesh, 0.01, 0.08);
    const GridFieldData& data = field.data();
    const auto& [nx, ny, nz] = data.bricks;
    const double edge = simd::kBrickCells * data.voxel_size;
    const double margin = data.plane_margin();
    int farthest = 0;
    int near = 0;
    int outside = 0;
    for (std::size_t brick = 0; brick < data.entries.size(); ++brick) {
      const BrickEntry entry = entry_of(field, brick);
      if (!entry.is_plane) continue;
      farthest = std::max(farthest, entry.radius);
      const auto at = static_cast<int>(brick);
      const Vec3 place{1.0 * (at % nx), 1.0 * (at / nx % ny), 1.0 * (at / (nx * ny))};
      const double around = entry.radius + 0.49;
      const Vec3 middle = data.origin + edge * (place + Vec3{0.5, 0.5, 0.5});
      const Vec3 reach = edge * Vec3{around, around, around};
      const float* plane = &data.planes[4 * entry.first];
      const auto normal = static_cast<Vec3>(Vec3f{plane[0], plane[1], plane[2]});
      for (int i = 0; i < 100; ++i) {
        const Vec3 p = random.in_box(middle - reach, middle + reach);
        const double by_plane = dot(normal, p) - static_cast<double>(plane[3]);
        const double value = distance_at(field, p);
        if (by_plane > margin && value > margin) continue;
        ++near;
        outside += !is_in(grid_bounds(field), static_cast<Vec3f>(p));
        ASSERT_NEAR(value, by_plane, 1e-6);
      }
    }
    EXPECT_GE(farthest, 2);
    EXPECT_GT(near, 1000);
    EXPECT_EQ(outside, 0);
  }
}

TEST(GridFieldPlanes, ACavityUnderAFaceIsSeenThroughNoPlane) {
  const Soup cavity = inverted(moved(make_box({0.1, 0.1, 0.1}), {0, 0, 0.3}));
  const GridField field = build(together(make_box({0.5, 0.5, 0.5}), cavity).mesh(), 0.02);
  EXPECT_NEAR(field.distance({0, 0, 0.47f}), -0.03f, 2e-4f);
  EXPECT_NEAR(field.distance({0, 0, 0.41f}), -0.01f, 2e-4f);
  EXPECT_NEAR(field.distance({0.15f, 0, 0.3f}), -0.05f, 2e-3f);
}

}  // namespace
}  // namespace voxshell::grid_field_planes_test
