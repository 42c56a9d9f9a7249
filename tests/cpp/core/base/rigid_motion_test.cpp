#include "voxshell/rigid_motion.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "support/random.h"

namespace voxshell::rigid_motion_test {
namespace {

using namespace test_support;

constexpr double kPi = std::numbers::pi;

double farthest_entry(const Pose& a, const Pose& b) {
  double farthest = length(a.translation - b.translation);
  for (const Vec3& axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    farthest = std::max(farthest, length(a.rotate(axis) - b.rotate(axis)));
  }
  return farthest;
}

Pose turned(const Vec3& turn) { return RigidMotion{{}, {}, turn}.at(1.0); }

TEST(RigidMotion, LeadsFromOnePoseToTheOther) {
  Random random(220);
  for (int i = 0; i < 10'000; ++i) {
    const Pose start = random.pose(3.0);
    const Pose end = random.pose(3.0);
    const RigidMotion motion = RigidMotion::between(start, end);
    ASSERT_LE(length(motion.turn), kPi + 1e-12);
    ASSERT_LT(farthest_entry(motion.at(0.0), start), 1e-14);
    ASSERT_LT(farthest_entry(motion.at(1.0), end), 1e-12);
  }
}

TEST(RigidMotion, TurnsSteadilyAboutItsAxis) {
  Random random(221);
  for (int i = 0; i < 10'000; ++i) {
    const Vec3 axis = random.direction();
    const double angle =
        i % 2 == 0 ? random.uniform(0.0, kPi) : std::pow(10.0, -12.0 * random.unit());
    const Pose start = random.pose(1.0);
    const Pose end{turned(angle * axis).rotation * start.rotation, start.translation};
    const RigidMotion motion = RigidMotion::between(start, end);
    ASSERT_LT(length(motion.turn - angle * axis), 1e-14 + 1e-11 * angle) << angle;
    const double fraction = random.unit();
    const Pose expected{turned(fraction * angle * axis).rotation * start.rotation,
                        start.translation};
    ASSERT_LT(farthest_entry(motion.at(fraction), expected), 1e-11);
  }
}

TEST(RigidMotion, OfHalfATurnGoesOneWay) {
  for (const Vec3& axis :
       {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, normalized(Vec3{1, -2, 3})}) {
    const Pose half{turned(kPi * axis).rotation, {}};
    EXPECT_LT(length(RigidMotion::between({}, half).turn - kPi * axis), 1e-7);
  }
  EXPECT_EQ(length(RigidMotion::between({}, {}).turn), 0.0);
}

TEST(RigidMotion, TurnsMoreThanOnce) {
  const RigidMotion motion{{}, {}, {0, 0, 7.0 * kPi}};
  EXPECT_LT(farthest_entry(motion.at(1.0), turned({0, 0, kPi})), 1e-14);
  EXPECT_LT(farthest_entry(motion.at(0.5), turned({0, 0, 3.5 * kPi})), 1e-14);
}

}  // namespace
}  // namespace voxshell::rigid_motion_test
