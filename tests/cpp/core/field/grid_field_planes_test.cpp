#include <algorithm>
#include <cstddef>

#include <gtest/gtest.h>

#include "support/brute_force.h"
#include "support/grid_bricks.h"
#include "support/grid_fields.h"
#include "support/meshes.h"
#include "support/random.h"
#include "voxshell/grid_field.h"

namespace voxshell {
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

TEST(GridFieldPlanes, PlanesSayHowFarAroundThemTheyHold) {
  const GridField field = build(make_box({0.5, 0.4, 0.3}).mesh(), 0.01);
  const auto& [nx, ny, nz] = field.data().bricks;
  const auto entry_at = [&](int x, int y, int z) {
    return entry_of(field, static_cast<std::size_t>(x + nx * (y + ny * z)));
  };
  int largest = 0;
  for (int z = 0; z < nz; ++z) {
    for (int y = 0; y < ny; ++y) {
      for (int x = 0; x < nx; ++x) {
        const BrickEntry entry = entry_at(x, y, z);
        if (!entry.is_plane) continue;
        const auto holds = [&](int radius) {
          if (std::min({x, y, z, nx - 1 - x, ny - 1 - y, nz - 1 - z}) < radius) return false;
          for (int c = -radius; c <= radius; ++c) {
            for (int b = -radius; b <= radius; ++b) {
              for (int a = -radius; a <= radius; ++a) {
                const BrickEntry other = entry_at(x + a, y + b, z + c);
                if (!other.is_plane || other.first != entry.first) return false;
              }
            }
          }
          return true;
        };
        ASSERT_TRUE(holds(entry.radius));
        ASSERT_TRUE(entry.radius == simd::kFieldMask || !holds(entry.radius + 1));
        largest = std::max(largest, entry.radius);
      }
    }
  }
  EXPECT_GE(largest, 1);
}

TEST(GridFieldPlanes, ACavityUnderAFaceIsSeenThroughNoPlane) {
  const Soup cavity = inverted(moved(make_box({0.1, 0.1, 0.1}), {0, 0, 0.3}));
  const GridField field = build(together(make_box({0.5, 0.5, 0.5}), cavity).mesh(), 0.02);
  EXPECT_NEAR(field.distance({0, 0, 0.47f}), -0.03f, 2e-4f);
  EXPECT_NEAR(field.distance({0, 0, 0.41f}), -0.01f, 2e-4f);
  EXPECT_NEAR(field.distance({0.15f, 0, 0.3f}), -0.05f, 2e-3f);
}

}  // namespace
}  // namespace voxshell
