#include "foremost.h"

#include <cmath>

#include <gtest/gtest.h>

namespace voxshell::bullet::foremost_test {
namespace {

const BoxField kBox{{0.1, 0.1, 0.1}};
constexpr double kOutside = 1e-4;

Vec3 shown(const Vec3& place, const Vec3& direction) {
  return normal_outside(kBox, place, normalized(direction), kOutside);
}

TEST(Foremost, AFaceShowsItsOwnNormalInAllDirections) {
  for (const double lean : {0.0, 0.1, 0.4}) {
    const Vec3 normal = shown({0.02, 0.03, 0.1}, {std::sin(lean), 0.0, std::cos(lean)});
    EXPECT_NEAR(normal.z, 1.0, 1e-6) << lean;
  }
}

TEST(Foremost, AnEdgeShowsWhatLiesBetweenItsFaces) {
  const Vec3 edge{0.1, 0.02, 0.1};
  for (const double angle : {0.1, 0.7, 1.4}) {
    const Vec3 between{std::sin(angle), 0.0, std::cos(angle)};
    EXPECT_NEAR(dot(shown(edge, between), between), 1.0, 1e-6) << angle;
  }
  EXPECT_NEAR(shown(edge, {-0.3, 0.0, 1.0}).z, 1.0, 1e-6);
}

TEST(Foremost, ACornerShowsAllDirectionsOutOfIt) {
  const Vec3 out = normalized(Vec3{0.2, 0.5, 0.8});
  EXPECT_NEAR(dot(shown({0.1, 0.1, 0.1}, out), out), 1.0, 1e-6);
  EXPECT_LT(dot(shown({0.1, 0.1, 0.1}, {-0.5, 0.0, 1.0}), normalized(Vec3{-0.5, 0.0, 1.0})), 0.95);
}

TEST(Foremost, ShapesOfAllKindsAreAsked) {
  const Field field = kBox;
  EXPECT_NEAR(normal_outside(field, {0.02, 0.03, 0.1}, {0, 0, 1}, kOutside).z, 1.0, 1e-6);
}

}  // namespace
}  // namespace voxshell::bullet::foremost_test
