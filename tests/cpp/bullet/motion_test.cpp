#include "motion.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/two_bodies.h"
#include "support/world.h"

namespace voxshell::bullet::motion_test {
namespace {

using namespace test_support;

constexpr double kStep = 1.0 / 30.0;
constexpr Vec3 kPlace{0.03, -0.02, -0.04};

/// Two balls that fly past each other and turn.
struct TwoBalls {
  TwoBalls()
      : a(world.add_model(ball_model(), 1, {{}, {0, 0, 0.3}})),
        b(world.add_model(ball_model(), 1, {{}, {0.1, 0, 0}})),
        bodies(a, b) {
    a.setLinearVelocity(btVector3(1, -2, 0.5));
    b.setLinearVelocity(btVector3(-1, 0, 2));
    a.setAngularVelocity(btVector3(3, 20, -7));
    b.setAngularVelocity(btVector3(-11, 4, 9));
    step = bodies.step(kStep);
  }

  /// Where a place of the shell is after a fraction of the step, as the field's body sees it.
  Vec3 from_poses(double fraction) const {
    const Vec3 in_field = step.field_from_shell_after(fraction).transform_point(kPlace);
    return step.field_from_shell.inverse().transform_point(in_field);
  }

  TestWorld world{{}, {0, 0, 0}};
  btRigidBody& a;
  btRigidBody& b;
  TwoBodies bodies;
  PairStep step{};
};

TEST(Path, LeadsToWhereTheBodiesMoveThePlace) {
  const TwoBalls balls;
  const Path path(balls.step.motion, kPlace, kStep);
  for (const double fraction : {0.0, 0.3, 1.0}) {
    EXPECT_NEAR(length(path.at(fraction) - balls.from_poses(fraction)), 0.0, 1e-12) << fraction;
  }
}

TEST(Path, IsThatOfTheOtherBodyReversed) {
  const TwoBalls balls;
  const Path path(balls.step.motion.reversed(), kPlace, kStep);
  const Pose then = balls.step.field_from_shell_after(0.7).inverse();
  const Vec3 in_field = balls.step.field_from_shell.transform_point(kPlace);
  EXPECT_NEAR(length(path.at(0.7) - then.transform_point(in_field)), 0.0, 1e-12);
}

TEST(Path, IsNoLongerThanItSays) {
  const TwoBalls balls;
  const Path path(balls.step.motion, kPlace, kStep);
  double along = 0.0;
  for (int i = 0; i < 100; ++i) along += length(path.at(0.01 * (i + 1)) - path.at(0.01 * i));
  EXPECT_LE(along, path.length());
  EXPECT_GE(along, 0.3 * path.length());
}

TEST(Path, TurnsDirectionsWithTheBody) {
  const TwoBalls balls;
  const Path path(balls.step.motion, kPlace, kStep);
  const Path from_center(balls.step.motion, balls.step.motion.own.center, kStep);
  const Vec3 arm = kPlace - balls.step.motion.own.center;
  const Vec3 turned = path.at(0.4) - from_center.at(0.4);
  EXPECT_NEAR(length(turned - path.turned_at(0.4, arm)), 0.0, 1e-12);
}

TEST(Path, IsStraightWhereNothingTurns) {
  TwoBalls balls;
  balls.a.setAngularVelocity(btVector3(0, 0, 0));
  balls.b.setAngularVelocity(btVector3(0, 0, 0));
  balls.step = balls.bodies.step(kStep);
  const Path path(balls.step.motion, kPlace, kStep);
  const Vec3 middle = 0.5 * (path.at(0.0) + path.at(1.0));
  EXPECT_NEAR(length(path.at(0.5) - middle), 0.0, 1e-15);
  EXPECT_NEAR(length(path.at(1.0) - path.at(0.0)), path.length(), 1e-15);
}

}  // namespace
}  // namespace voxshell::bullet::motion_test
