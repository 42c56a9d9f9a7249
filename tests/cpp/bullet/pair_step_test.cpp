#include "pair_step.h"

#include <limits>
#include <optional>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/two_bodies.h"
#include "support/world.h"

namespace voxshell::bullet::pair_step_test {
namespace {

using namespace test_support;

constexpr double kStep = 1.0 / 200.0;

/// A ball over a plane at z = 0.
struct BallOverPlane {
  BallOverPlane()
      : plane(world.add(world.make<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0)),
        ball(world.add_model(ball_model(), 2, {{}, {0, 0, 0.3}})) {}

  PairStep step(const ContactSettings& settings = {}, double time_step = kStep) {
    return bodies.emplace(ball, plane).step(time_step, settings);  // of the last one alone
  }

  TestWorld world;
  btRigidBody& plane;
  btRigidBody& ball;
  std::optional<TwoBodies> bodies;
};

TEST(PairStep, SaysHowFarTheBodiesMove) {
  BallOverPlane scene;
  scene.ball.setLinearVelocity(btVector3(0, 0, -3));
  scene.ball.setAngularVelocity(btVector3(0, 7, 0));
  const PairStep step = scene.step();
  // Every place of the ball; gravity has not been applied yet.
  EXPECT_NEAR(step.farthest_displacement, (3 + 7 * kBallRadius) * kStep, 0.02 * kStep);
  EXPECT_NEAR(step.ball.radius, kBallRadius, 1e-3);
  EXPECT_EQ(step.motion_a.inverse_mass, 0.5);
}

TEST(PairStep, UsesCcdBeyondTheThreshold) {
  BallOverPlane scene;
  scene.ball.setLinearVelocity(btVector3(0, 0, -1));  // 5 mm a step
  const auto with_threshold = [&](double threshold) {
    return scene.step({.ccd_motion_threshold = threshold});
  };
  EXPECT_TRUE(with_threshold(0.0049).uses_ccd);
  EXPECT_FALSE(with_threshold(0.0051).uses_ccd);
  EXPECT_FALSE(with_threshold(std::numeric_limits<double>::infinity()).uses_ccd);
  // By default, a 200th of the longest side.
  EXPECT_TRUE(scene.step({}, 0.00103).uses_ccd);
  EXPECT_FALSE(scene.step({}, 0.00098).uses_ccd);
}

TEST(PairStep, LooksFartherWithCcd) {
  BallOverPlane scene;
  EXPECT_EQ(scene.step().margin, scene.step().rest_margin);
  scene.ball.setLinearVelocity(btVector3(0, 0, -10));
  const PairStep fast = scene.step();
  EXPECT_GE(fast.margin, fast.farthest_displacement);
  EXPECT_NEAR(fast.rest_margin, 1e-3 * 2 * kBallRadius, 1e-5);
}

TEST(PairStep, IsStillWhereItsEnergyLiftsItByLittle) {
  BallOverPlane scene;
  const double weight = 9.81 * kStep;  // per kg
  scene.ball.applyCentralForce(btVector3(0, 0, scalar(-9.81 * 2)));
  EXPECT_NEAR(length(scene.step().motion_a.velocity_of_forces), weight, 1e-6);
  EXPECT_TRUE(scene.step().is_still);
  const double speed = std::sqrt(2 * 9.81 * 0.15 * scene.step().rest_margin);
  scene.ball.setLinearVelocity(btVector3(scalar(0.99 * speed), 0, 0));
  EXPECT_TRUE(scene.step().is_still);
  scene.ball.setLinearVelocity(btVector3(scalar(1.01 * speed), 0, 0));
  EXPECT_FALSE(scene.step().is_still);
}

TEST(PairStep, KnowsWhereTheBodiesWillBe) {
  BallOverPlane scene;
  scene.ball.setLinearVelocity(btVector3(1, 2, -3));
  const PairStep step = scene.step();
  const Pose start = step.field_from_shell_after(0.0);
  const Pose middle = step.field_from_shell_after(0.5);
  EXPECT_LT(length(start.translation - step.field_from_shell.translation), 1e-7);
  EXPECT_LT(length(middle.translation - start.translation - 0.5 * kStep * Vec3{1, 2, -3}), 1e-7);
}

}  // namespace
}  // namespace voxshell::bullet::pair_step_test
