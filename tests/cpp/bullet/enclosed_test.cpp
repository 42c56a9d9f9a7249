#include <gtest/gtest.h>

#include "support/models.h"
#include "support/world.h"

namespace voxshell::bullet::enclosed_test {
namespace {

using namespace test_support;

/// A small ball with many points inside of a static cube with few.
class Enclosed : public testing::TestWithParam<ContactMode> {
 protected:
  Enclosed() : world({.mode = GetParam(), .margin = 0}, {}) {}

  void add_ball(const Vec3& at) {
    static const auto model = build_model(voxshell::test_support::make_icosphere(0.02, 3), 0.001);
    ball = &world.add_model(model, 1.0, {{}, at});
  }
  void add_cube() { cube = &world.add_model(cube_model(), 0.0); }

  TestWorld world;
  btRigidBody* ball = nullptr;
  btRigidBody* cube = nullptr;
};

INSTANTIATE_TEST_SUITE_P(In, Enclosed,
                         testing::Values(ContactMode::kRegular, ContactMode::kSegmented));

TEST_P(Enclosed, ABodyInsideOneWithFewerPointsIsInContactInEitherOrder) {
  for (const bool ball_first : {true, false}) {
    if (ball_first) add_ball({0.05, 0.0, 0.0});
    add_cube();
    if (!ball_first) add_ball({0.05, 0.0, 0.0});
    world.world.performDiscreteCollisionDetection();
    const auto points = world.points();
    ASSERT_FALSE(points.empty());
    for (const btManifoldPoint* point : points) {
      EXPECT_LT(static_cast<double>(point->getDistance()), -0.02);
    }
    world.world.removeRigidBody(ball);
    world.world.removeRigidBody(cube);
  }
}

TEST_P(Enclosed, ABodyThatLeavesIsInContactAllTheWay) {
  // First the ball's points are in the cube, then some of the cube's in the ball.
  add_cube();
  add_ball({});
  for (int i = 0; i <= 130; ++i) {
    const double x = 0.001 * i;
    ball->setWorldTransform(to_bullet(Pose{{}, {x, 0, 0}}));
    world.world.performDiscreteCollisionDetection();
    if (x < 0.112) {
      EXPECT_FALSE(world.points().empty()) << x;
    }
    if (x > 0.1205) {
      EXPECT_TRUE(world.points().empty()) << x;
      EXPECT_EQ(world.dispatcher.getNumManifolds(), 0);
    }
    for (const btManifoldPoint* point : world.points()) {
      EXPECT_LE(static_cast<double>(point->getDistance()), 0.0);
    }
  }
}

TEST(CoarseGround, HoldsASmallFineBodyThatFitsBetweenItsPoints) {
  namespace meshes = voxshell::test_support;
  constexpr double kHalf = 0.25;
  const auto ground =
      build_model(meshes::moved(meshes::make_box({20.0, 20.0, 1.0}), {0, 0, -1.0}), 1.0);
  const auto cube = build_model(meshes::make_box({kHalf, kHalf, kHalf}), 0.02);
  ASSERT_LT(ground->shell().size(), cube->shell().size());
  TestWorld world;
  world.add_model(ground, 0.0);
  const btRigidBody& body = world.add_model(cube, 1.0, {{}, {0.07, 0.04, kHalf + 0.1}});
  world.step(400);
  const Vec3 at = from_bullet(body.getWorldTransform().getOrigin());
  EXPECT_NEAR(at.z, kHalf, 0.01);
  EXPECT_LT(static_cast<double>(body.getAngularVelocity().length()), 0.01);
}

}  // namespace
}  // namespace voxshell::bullet::enclosed_test
