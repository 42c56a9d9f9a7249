#include "mesh/thickness.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "voxshell/pose.h"

namespace voxshell::thickness_test {
namespace {

using namespace test_support;

/// Turns a profile of (radius, z), which begins and ends on the axis, about the z axis.
Soup revolve(const std::vector<std::array<double, 2>>& profile, std::uint32_t around) {
  constexpr double kTau = 6.283185307179586;
  Soup soup;
  const auto n = static_cast<std::uint32_t>(profile.size());
  for (std::uint32_t i = 0; i < around; ++i) {
    const double angle = kTau * i / around;
    for (const auto& [radius, z] : profile) {
      soup.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
    }
  }
  for (std::uint32_t i = 0; i < around; ++i) {
    for (std::uint32_t j = 0; j + 1 < n; ++j) {
      const std::uint32_t a = i * n + j;
      const std::uint32_t b = (i + 1) % around * n + j;
      soup.triangles.push_back({a, b, b + 1});
      soup.triangles.push_back({a, b + 1, a + 1});
    }
  }
  return soup;
}

Soup make_cup(double radius, double height, double wall) {
  return revolve({{0.0, 0.0},
                  {radius, 0.0},
                  {radius, height},
                  {radius - wall, height},
                  {radius - wall, wall},
                  {0.0, wall}},
                 64);
}

TEST(Thickness, OfABoxIsItsShortestSide) {
  EXPECT_NEAR(compute_thickness(make_box({0.5, 0.05, 0.005}).mesh()), 0.01, 1e-12);
  EXPECT_NEAR(compute_thickness(make_box({0.5, 0.5, 0.5}).mesh()), 1.0, 1e-12);
}

TEST(Thickness, OfABallIsItsDiameter) {
  EXPECT_NEAR(compute_thickness(make_icosphere(0.1, 5).mesh()), 0.2, 0.002);
}

TEST(Thickness, OfACupIsItsWall) {
  EXPECT_NEAR(compute_thickness(make_cup(0.04, 0.1, 0.0015).mesh()), 0.0015, 0.00001);
}

TEST(Thickness, IsNotThatBesideTheEdgeOfAWedgeUnlessItIsSharp) {
  const double sharp = compute_thickness(make_wedge(1.0, 0.3, 2.0).mesh());
  EXPECT_GT(sharp, 0.0);
  EXPECT_LT(sharp, 0.01);
  EXPECT_NEAR(compute_thickness(make_wedge(1.0, 0.7, 2.0).mesh()), 0.7, 1e-12);
}

TEST(Thickness, IsThatOfTheThinnestPartOfSomeSize) {
  const Soup plate = moved(make_box({0.3, 0.3, 0.002}), {1.0, 0.0, 0.0});
  EXPECT_NEAR(compute_thickness(together(make_box({0.5, 0.5, 0.5}), plate).mesh()), 0.004, 1e-9);
}

TEST(Thickness, IsThatOfAllPartsTogether) {
  // Two blocks that overlap a little, by less than rounding, touch, or are that much apart.
  const Soup block = make_box({0.5, 0.5, 0.5});
  for (const double overlap : {0.1, 1e-3, 1e-6, 1e-9, 0.0, -1e-9, -1e-3}) {
    const Soup both = together(block, moved(block, {1.0 - overlap, 0.0, 0.0}));
    EXPECT_NEAR(compute_thickness(both.mesh()), 1.0, 1e-6) << overlap;
    EXPECT_NEAR(compute_thickness(inverted(both).mesh()), 1.0, 1e-6) << overlap;
  }
  // A lining inside a block is no wall, one that sticks out is.
  const Soup plate = make_box({0.4, 0.4, 0.002});
  EXPECT_NEAR(compute_thickness(together(block, plate).mesh()), 1.0, 1e-6);
  EXPECT_NEAR(compute_thickness(together(block, moved(plate, {0.5, 0.0, 0.0})).mesh()), 0.004,
              1e-6);
}

TEST(Thickness, DoesNotDependOnOrientationOrPlace) {
  const Soup cup = make_cup(0.04, 0.1, 0.0015);
  EXPECT_NEAR(compute_thickness(inverted(cup).mesh()), compute_thickness(cup.mesh()), 1e-8);
  const Pose pose{
      Matrix3{
          {2.0 / 3, -1.0 / 3, 2.0 / 3}, {2.0 / 3, 2.0 / 3, -1.0 / 3}, {-1.0 / 3, 2.0 / 3, 2.0 / 3}},
      {3.0, 2.0, 1.0}};
  EXPECT_NEAR(compute_thickness(transformed(cup, pose).mesh()), compute_thickness(cup.mesh()),
              1e-8);
}

TEST(Thickness, OfAnOpenMeshIsAtMostTheShortestSideOfItsBounds) {
  const Soup square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  const double flat = compute_thickness(square.mesh());
  EXPECT_GT(flat, 0.0);
  EXPECT_LE(flat, 1e-6);
  const double bowl = compute_thickness(opened(make_icosphere(0.1, 4), 0.0).mesh());
  EXPECT_GT(bowl, 0.0);
  EXPECT_LE(bowl, 0.12);
}

}  // namespace
}  // namespace voxshell::thickness_test
