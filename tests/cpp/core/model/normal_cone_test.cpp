#include "model/normal_cone.h"

#include <cmath>

#include <gtest/gtest.h>

namespace voxshell::normal_cone_test {
namespace {

TEST(NormalCone, AngleOfAChordIsTwiceTheArcsine) {
  for (const double angle : {0.0, 1e-9, 0.001, 0.5, 1.0, 1.5707963267948966, 3.0, 3.14159265}) {
    EXPECT_NEAR(angle_of_chord(2.0 * std::sin(angle / 2.0)), angle, 1e-7 * angle + 1e-15);
  }
  EXPECT_NEAR(angle_of_chord(kLongestChord), 3.141592653589793, 1e-9);
}

TEST(NormalCone, OfOneNormalIsThatNormal) {
  NormalCone cone;
  EXPECT_EQ(cone.chord_to({1, 0, 0}), kLongestChord);
  cone.add({0, 0, 1});
  EXPECT_EQ(cone.chord_to({0, 0, 1}), 0.0);
  EXPECT_NEAR(cone.chord_to({1, 0, 0}), std::sqrt(2.0), 1e-15);
}

TEST(NormalCone, OfTwoHoldsTheArcBetweenThem) {
  NormalCone cone;
  cone.add({1, 0, 0});
  cone.add({0, 1, 0});
  EXPECT_NEAR(cone.chord_to(normalized(Vec3{1, 3, 0})), 0.0, 1e-12);
  const Vec3 beside = normalized(Vec3{1, 1, 0.2});
  EXPECT_NEAR(angle_of_chord(cone.chord_to(beside)), std::asin(beside.z), 1e-9);
  // The arc from the one to the other does not go the long way round.
  EXPECT_NEAR(cone.chord_to({-1, 0, 0}), std::sqrt(2.0), 1e-12);
}

TEST(NormalCone, OfACornerHoldsWhatIsBetween) {
  NormalCone cone;
  for (const Vec3& normal : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) cone.add(normal);
  EXPECT_EQ(cone.chord_to(normalized(Vec3{1, 2, 3})), 0.0);
  EXPECT_GT(cone.chord_to(normalized(Vec3{1, 2, -1})), 0.3);
}

}  // namespace
}  // namespace voxshell::normal_cone_test
