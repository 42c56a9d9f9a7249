#include "mesh/angle_normals.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "support/random.h"

namespace voxshell::angle_normals_test {
namespace {

using namespace test_support;

constexpr double kRounding = 1e-6;

TEST(AngleNormals, WeighFacesByTheirAngles) {
  const TriangleMesh box = make_box({0.5, 0.25, 0.1}).mesh();
  const AngleNormals around(box, kRounding);
  const auto expect_near = [](const Vec3& a, const Vec3& b) {
    EXPECT_LT(length(a - b), 1e-9) << a.x << " " << a.y << " " << a.z;
  };
  constexpr double kPi = std::numbers::pi;
  expect_near(around.compute({0.5, 0.25, 0.1}), 0.5 * kPi * Vec3{1.0, 1.0, 1.0});
  expect_near(around.compute({0.5, 0.25, 0.03}), kPi * Vec3{1.0, 1.0, 0.0});
  expect_near(around.compute({0.5, 0.1, 0.03}), 2.0 * kPi * Vec3{1.0, 0.0, 0.0});
  expect_near(around.compute({0.5, 0.1, 0.3}), {});
}

/// Sums of floating-point numbers show the order in which they were added.
TEST(AngleNormals, GivePlacesTogetherTheBitsOfEachAlone) {
  for (const Soup& soup : {make_blob(0.5, 3), make_torus(0.5, 0.2, 30, 20)}) {
    const TriangleMesh mesh = soup.mesh();
    const AngleNormals around(mesh, kRounding);
    int found = 0;
    const auto expect_same = [&](const std::array<Vec3, 5>& places) {
      std::array<Vec3, 5> together{};
      around.compute(places, places.size(), together);
      std::array<Vec3, 5> in_groups{};
      around.compute(places, 2, in_groups);
      for (std::size_t i = 0; i < places.size(); ++i) {
        EXPECT_EQ(together[i], around.compute(places[i]));
        EXPECT_EQ(in_groups[i], together[i]);
        if (together[i] != Vec3{}) ++found;
      }
    };
    Random random(17);
    for (int round = 0; round < 200; ++round) {
      const auto [a, b, c] = mesh.corners(random.below(mesh.triangles().size()));
      expect_same({a, b, 0.5 * (a + b), a + 0.1 * (b - a), a + 0.9 * (c - a)});
      // So far apart that each is looked up by itself.
      const auto [p, q, r] = mesh.corners(random.below(mesh.triangles().size()));
      expect_same({a, p, q, c, r});
    }
    EXPECT_GT(found, 1500);
  }
}

}  // namespace
}  // namespace voxshell::angle_normals_test
