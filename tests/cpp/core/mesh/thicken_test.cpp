#include "mesh/thicken.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <utility>

#include <gtest/gtest.h>

#include "mesh/winding_number.h"
#include "support/meshes.h"

namespace voxshell::thicken_test {
namespace {

using namespace test_support;

TriangleMesh make_sheet(const Soup& soup, double thickness) {
  auto solid = thicken(soup.mesh(), thickness);
  EXPECT_TRUE(solid) << solid.error().message;
  if (!solid) std::abort();
  return *std::move(solid);
}

Soup make_square() {
  return {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
}

TEST(Thicken, MakesABoxOfASquare) {
  const TriangleMesh box = make_sheet(make_square(), 0.1);
  EXPECT_TRUE(check_encloses_volume(box));
  EXPECT_EQ(box.vertices().size(), 8u);
  EXPECT_NEAR(box.compute_volume(), 0.1, 1e-12);
  EXPECT_NEAR(box.bounds().lower.z, -0.05, 1e-12);
  EXPECT_NEAR(box.bounds().upper.z, 0.05, 1e-12);
}

TEST(Thicken, GoesByNoOrientation) {
  Soup mixed = make_square();
  std::swap(mixed.triangles[1][0], mixed.triangles[1][1]);
  const TriangleMesh box = make_sheet(mixed, 0.1);
  EXPECT_TRUE(check_encloses_volume(box));
  EXPECT_NEAR(box.compute_volume(), 0.1, 1e-12);
}

TEST(Thicken, OfABowlHasItsAreaTimesTheThickness) {
  constexpr double kPi = 3.141592653589793;
  const Soup bowl = opened(make_icosphere(0.1, 5), -1e-6);
  const TriangleMesh solid = make_sheet(bowl, 0.002);
  EXPECT_TRUE(check_encloses_volume(solid));
  EXPECT_NEAR(solid.compute_volume(), 0.002 * bowl.mesh().compute_area(), 1e-8);
  EXPECT_NEAR(solid.bounds().lower.z, -0.101, 1e-5);
  EXPECT_GT(bowl.mesh().compute_area(), 1.9 * kPi * 0.01);
}

TEST(Thicken, KeepsItsThicknessBesideCreases) {
  // A floor and a wall at right angles.
  const Soup corner{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {0, 1, 1}},
                    {{0, 1, 2}, {0, 2, 3}, {0, 3, 5}, {0, 5, 4}}};
  const TriangleMesh solid = make_sheet(corner, 0.1);
  EXPECT_TRUE(check_encloses_volume(solid));
  EXPECT_NEAR(solid.bounds().lower.z, -0.05, 1e-12);
  EXPECT_NEAR(solid.bounds().lower.x, -0.05, 1e-12);
}

TEST(Thicken, LeavesClosedPartsAsTheyAre) {
  const Soup box = moved(make_box({0.5, 0.5, 0.5}), {5, 0, 0});
  const TriangleMesh solid = make_sheet(together(make_square(), box), 0.1);
  EXPECT_TRUE(check_encloses_volume(solid));
  EXPECT_NEAR(solid.compute_volume(), 1.1, 1e-9);
  EXPECT_NEAR(solid.bounds().upper.z, 0.5, 1e-12);
}

TEST(Thicken, CutsWhereSheetsMeetAndWhereTheyTouch) {
  // Three squares at one edge, and a fourth that touches a corner.
  const Soup soup{
      {{0, 0, 0},
       {1, 0, 0},
       {1, 1, 0},
       {0, 1, 0},
       {0, -1, 0},
       {1, -1, 0},
       {0, 0, 1},
       {1, 0, 1},
       {-1, 1, 0},
       {-1, 2, 0},
       {0, 2, 0}},
      {{0, 1, 2}, {0, 2, 3}, {1, 0, 4}, {1, 4, 5}, {0, 1, 7}, {0, 7, 6}, {3, 10, 9}, {3, 9, 8}}};
  const TriangleMesh solid = make_sheet(soup, 0.1);
  EXPECT_EQ(solid.compute_defects().open_edges, 0u);
  EXPECT_NEAR(solid.compute_volume(), 0.4, 1e-9);
}

TEST(Thicken, CutsAMoebiusStrip) {
  constexpr double kTau = 6.283185307179586;
  constexpr std::uint32_t kAround = 60;
  Soup strip;
  for (std::uint32_t i = 0; i < kAround; ++i) {
    const double angle = kTau * i / kAround;
    for (const double side : {-0.3, 0.3}) {
      const double radius = 1.0 + side * std::cos(angle / 2.0);
      strip.vertices.push_back(
          {radius * std::cos(angle), radius * std::sin(angle), side * std::sin(angle / 2.0)});
    }
    const std::uint32_t a = 2 * i;
    const std::uint32_t c = i + 1 < kAround ? a + 2 : 1;
    const std::uint32_t d = i + 1 < kAround ? a + 3 : 0;
    strip.triangles.push_back({a, c, a + 1});
    strip.triangles.push_back({a + 1, c, d});
  }
  const TriangleMesh solid = make_sheet(strip, 0.02);
  EXPECT_EQ(solid.compute_defects().open_edges, 0u);
  // Where it is cut, its ends overlap a little.
  EXPECT_NEAR(solid.compute_volume(), 0.02 * strip.mesh().compute_area(), 0.003);
}

/// Places of the surface that its sheet does not enclose, of 21 a triangle.
int count_outside(const Soup& soup, double thickness) {
  const TriangleMesh mesh = soup.mesh();
  const TriangleMesh solid = make_sheet(soup, thickness);
  EXPECT_EQ(solid.compute_defects().open_edges, 0u);
  const WindingNumberTree numbers(solid);
  constexpr int kSteps = 7;
  int outside = 0;
  for (std::size_t i = 0; i < mesh.triangles().size(); ++i) {
    const auto [a, b, c] = mesh.corners(i);
    for (int u = 1; u < kSteps; ++u) {
      for (int v = 1; u + v < kSteps; ++v) {
        const Vec3 p = a + (1.0 * u / kSteps) * (b - a) + (1.0 * v / kSteps) * (c - a);
        if (numbers.compute(p) < 0.5) ++outside;
      }
    }
  }
  return outside;
}

TEST(Thicken, EnclosesAnOpenSplinter) {
  // A mean of the normals about one of its vertices points away from a face there: the sheet was
  // inside out, and half of it was lost.
  const Soup splinter{{{-3.49, -1.35, 0.35},
                       {8.4, -0.52, 0.54},
                       {8.02, 0.75, 0.43},
                       {4.69, -0.88, 0.86},
                       {-9.49, -0.29, -0.33},
                       {-7.24, -0.07, 0.89},
                       {-2.7, -1.44, -0.09},
                       {9.75, 0.33, 0},
                       {-8.96, 0.48, 0.4},
                       {6.33, 1.05, 0.42}},
                      {{4, 7, 6},
                       {9, 7, 4},
                       {4, 6, 0},
                       {0, 5, 4},
                       {6, 3, 0},
                       {0, 3, 5},
                       {1, 6, 7},
                       {1, 3, 6},
                       {4, 5, 8},
                       {8, 9, 4},
                       {5, 9, 8},
                       {2, 9, 3},
                       {3, 1, 2},
                       {7, 9, 2},
                       {2, 1, 7}}};
  for (const double thickness : {0.01, 0.05, 0.1}) {
    EXPECT_EQ(count_outside(splinter, thickness), 0) << thickness;
  }
}

TEST(Thicken, EnclosesASurfaceThatNoNormalIsOutsideOf) {
  // The faces about its middle look in all directions.
  Soup folds{{{0.2, -0.5, -0.4},
              {-2.4, 1.8, 1.1},
              {-0.3, 0.8, 0.3},
              {-0.6, 1, -0.3},
              {-0.3, -0.8, 0.5},
              {-0.1, 0.5, -0.6},
              {0, 0, 0}},
             {}};
  for (std::uint32_t i = 0; i < 6; ++i) folds.triangles.push_back({6, i, (i + 1) % 6});
  for (const double thickness : {0.005, 0.02}) {
    EXPECT_EQ(count_outside(folds, thickness), 0) << thickness;
  }
}

}  // namespace
}  // namespace voxshell::thicken_test
