#include "mesh/openings.h"

#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

#include "support/meshes.h"

namespace voxshell::openings_test {
namespace {

using namespace test_support;

constexpr double kTau = 6.283185307179586;

/// A cylinder about the z axis without caps.
Soup make_tube(double radius, double length, std::uint32_t around) {
  Soup soup;
  for (const double z : {-length / 2, length / 2}) {
    for (std::uint32_t i = 0; i < around; ++i) {
      soup.vertices.push_back(
          {radius * std::cos(kTau * i / around), radius * std::sin(kTau * i / around), z});
    }
  }
  for (std::uint32_t i = 0; i < around; ++i) {
    const std::uint32_t j = (i + 1) % around;
    soup.triangles.push_back({i, j, j + around});
    soup.triangles.push_back({i, j + around, i + around});
  }
  return soup;
}

/// Without its first triangles.
Soup without(Soup soup, std::ptrdiff_t count) {
  soup.triangles.erase(soup.triangles.begin(), soup.triangles.begin() + count);
  return soup;
}

TEST(Openings, OfAClosedMeshAreNone) {
  const Openings openings = find_openings(make_box({1, 1, 1}).mesh());
  EXPECT_EQ(openings.loops, 0u);
  EXPECT_FALSE(suggest_sheet(openings));
}

TEST(Openings, OfATubeAreItsTwoEnds) {
  const Openings openings = find_openings(make_tube(0.1, 1.0, 64).mesh());
  EXPECT_EQ(openings.loops, 2u);
  EXPECT_EQ(openings.mouths, 2u);
  EXPECT_NEAR(openings.fraction, 0.1, 0.001);  // 2 pi r^2 of 2 pi r l
  EXPECT_NEAR(openings.largest_diameter, 0.2 * std::sqrt(2.0), 1e-3);
  EXPECT_NEAR(std::abs(openings.first_location.z), 0.5, 1e-12);
  EXPECT_NEAR(std::hypot(openings.first_location.x, openings.first_location.y), 0.1, 1e-3);
  EXPECT_TRUE(suggest_sheet(openings));
}

TEST(Openings, SuggestASheetForTubesBowlsTraysAndPanels) {
  EXPECT_TRUE(suggest_sheet(find_openings(make_tube(0.1, 0.05, 32).mesh())));
  EXPECT_TRUE(suggest_sheet(find_openings(make_tube(0.1, 10.0, 32).mesh())));
  EXPECT_TRUE(suggest_sheet(find_openings(opened(make_icosphere(0.1, 4), -0.001).mesh())));
  const Soup panel{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  EXPECT_TRUE(suggest_sheet(find_openings(panel.mesh())));
  EXPECT_TRUE(suggest_sheet(find_openings(opened(make_box({0.5, 0.5, 0.5}), 0.4).mesh())));
}

TEST(Openings, SuggestASolidForBodiesWithHoles) {
  const Openings pierced = find_openings(without(make_icosphere(0.1, 4), 6).mesh());
  EXPECT_GE(pierced.loops, 1u);
  EXPECT_LT(pierced.fraction, 0.01);
  EXPECT_FALSE(suggest_sheet(pierced));
  EXPECT_FALSE(suggest_sheet(find_openings(without(make_box({0.5, 0.5, 0.5}), 1).mesh())));
  EXPECT_FALSE(suggest_sheet(find_openings(opened(make_icosphere(0.1, 4), 0.09).mesh())));
}

TEST(Openings, ClosedPartsBesideDoNotCount) {
  const Soup both = together(make_tube(0.1, 1.0, 64), moved(make_box({5, 5, 5}), {9, 0, 0}));
  EXPECT_NEAR(find_openings(both.mesh()).fraction, 0.1, 0.001);
}

}  // namespace
}  // namespace voxshell::openings_test
