#include <algorithm>
#include <tuple>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/world.h"

namespace voxshell::bullet::rebound_test {
namespace {

using namespace test_support;

enum class Ground { kPlane, kBox, kModel };

class Rebound : public testing::TestWithParam<std::tuple<Ground, ContactMode>> {
 protected:
  static void add_ground(TestWorld& world) {
    switch (std::get<0>(GetParam())) {
      case Ground::kPlane:
        world.add(world.make<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0)
            .setRestitution(1);
        break;
      case Ground::kBox:
        world.add(world.make<btBoxShape>(to_bullet(Vec3{0.3, 0.3, 0.05})), 0, {{}, {0, 0, -0.05}})
            .setRestitution(1);
        break;
      case Ground::kModel:
        world.add_model(slab_model(), 0).setRestitution(1);
        break;
    }
  }
};

INSTANTIATE_TEST_SUITE_P(
    Grounds, Rebound,
    testing::Combine(testing::Values(Ground::kPlane, Ground::kBox, Ground::kModel),
                     testing::Values(ContactMode::kRegular, ContactMode::kSegmented)));

/// The highest place after the first bounce over that before it, above where the ball touches,
/// dropped `drop` meters.
double rebound_ratio(TestWorld& world, btRigidBody& ball, double drop) {
  bool rises = false;
  double top = kBallRadius;
  for (int i = 0; i < 800; ++i) {
    world.step(1, 1.0 / 500.0);
    rises = rises || ball.getLinearVelocity().z() > scalar(0.02);
    if (rises && ball.getLinearVelocity().z() < 0) break;
    if (rises) top = std::max(top, height(ball));
  }
  return (top - kBallRadius) / drop;
}

TEST_P(Rebound, IsThatOfTheRestitutionFromEveryHeight) {
  for (const double restitution : {1.0, 0.9, 0.5, 0.1, 0.0}) {
    for (int phase = 0; phase < 10; ++phase) {
      TestWorld world({.mode = std::get<1>(GetParam())});
      add_ground(world);
      const double drop = 0.5 + 0.0031 * phase;
      btRigidBody& ball = world.add_model(ball_model(), 1, {{}, {0, 0, kBallRadius + drop}});
      ball.setRestitution(scalar(restitution));
      const double ratio = rebound_ratio(world, ball, drop);
      EXPECT_NEAR(ratio, restitution * restitution, 0.01 * restitution * restitution + 0.001)
          << "restitution " << restitution << ", dropped " << drop;
    }
  }
}

TEST_P(Rebound, NeverRisesAboveTheStart) {
  TestWorld world({.mode = std::get<1>(GetParam())});
  add_ground(world);
  btRigidBody& ball = world.add_model(ball_model(), 1, {{}, {0, 0, kBallRadius + 0.3}});
  ball.setRestitution(scalar(0.9));
  ball.setActivationState(DISABLE_DEACTIVATION);
  double top = 0.0;
  for (int i = 0; i < 4000; ++i) {
    world.step(1, 1.0 / 500.0);
    ASSERT_LT(height(ball), kBallRadius + 0.3) << "step " << i;
    if (i > 3500) top = std::max(top, height(ball));
  }
  EXPECT_LT(top, kBallRadius + 0.01);
}

}  // namespace
}  // namespace voxshell::bullet::rebound_test
