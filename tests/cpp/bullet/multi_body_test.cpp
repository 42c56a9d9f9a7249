#include "support/multi_body.h"

#include <algorithm>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "support/drop.h"
#include "support/ground.h"
#include "support/models.h"
#include "support/random.h"
#include "support/world.h"

namespace voxshell::bullet::multi_body_test {
namespace {

using namespace test_support;
using voxshell::test_support::Random;

class MultiBody : public testing::TestWithParam<std::tuple<Ground, ContactMode>> {
 protected:
  MultiBody() : world({.mode = std::get<1>(GetParam())}) {
    ground = &add_ground(world, std::get<0>(GetParam()));
    ground->setFriction(1);
    ground->setRestitution(1);
  }

  MultiBodyWorld world;
  btRigidBody* ground;
};

INSTANTIATE_TEST_SUITE_P(
    OnGrounds, MultiBody,
    testing::Combine(testing::Values(Ground::kPlane, Ground::kBox, Ground::kModel),
                     testing::Values(ContactMode::kRegular, ContactMode::kSegmented)),
    [](const auto& tested) {
      return std::string(to_string(std::get<0>(tested.param))) +
             (std::get<1>(tested.param) == ContactMode::kRegular ? "Regular" : "Segmented");
    });

TEST_P(MultiBody, RigidBodiesOfItsWorldComeToRest) {
  btRigidBody& body =
      add_at_principal_frame(world, blob_model(), 1, {Random(51).rotation(), {0, 0, 0.3}});
  body.setFriction(scalar(0.8));
  body.setRollingFriction(scalar(0.005));
  body.setDamping(0, scalar(0.05));
  body.setActivationState(DISABLE_DEACTIVATION);
  // This world's solver has friction in two directions, with which bodies rest less calmly.
  expect_calm_landing(world, body, 0.4);
}

TEST_P(MultiBody, ABaseComesToRest) {
  Random random(54);
  int rocking = 0;
  for (const auto& model :
       {cube_model(), blob_model(), torus_model(), cube_model(), blob_model(), torus_model()}) {
    const BodyFrame frame = compute_principal_frame(model->solid_mass_properties());
    auto& shape = world.make<ModelShape>(model, frame.model_from_body.inverse());
    Tree tree(world, Tree::Base::kFree, {&shape}, {random.rotation(), {0, 0, 0.3}});
    tree.body.setCanSleep(false);
    tree.enter_world();
    tree.colliders[0]->setRollingFriction(scalar(0.005));
    const Lying lying = expect_true_landing_and_lie(world, tree);
    constexpr double kRocking = 0.1;  // rad/s
    EXPECT_LT(lying.fastest_turn, std::max(kRocking, kCalm));
    EXPECT_LT(lying.drift, 1e-3);
    if (!lying.is_calm()) ++rocking;
  }
  // Bullet starts the impulses of multibodies from zero: one in fifty rocks for ever.
  EXPECT_LE(rocking, 1);
}

TEST_P(MultiBody, ALinkOnASlideComesToRest) {
  auto& hook = world.make<btSphereShape>(scalar(0.05));
  auto& shape = world.make<ModelShape>(blob_model());
  Tree tree(world, Tree::Base::kFixed, {&hook, &shape}, {{}, {0, 0, 1.0}});
  tree.body.setupPrismatic(0, 1, Tree::inertia_of(shape), -1, btQuaternion::getIdentity(),
                           btVector3(0, 0, 1), btVector3(0, 0, scalar(-0.6)), btVector3(0, 0, 0),
                           true);
  tree.body.setCanSleep(false);
  tree.enter_world();
  tree.colliders[1]->setRollingFriction(scalar(0.005));
  expect_calm_landing(world, tree);
}

TEST_P(MultiBody, CubesOnAHingeComeToRest) {
  auto& cube = world.make<ModelShape>(cube_model());
  Tree tree(world, Tree::Base::kFree, {&cube, &cube}, {{}, {-0.12, 0, 0.3}});
  tree.body.setupRevolute(0, 1, Tree::inertia_of(cube), -1, btQuaternion::getIdentity(),
                          btVector3(0, 1, 0), to_bullet(Vec3{0.12, 0, 0}),
                          to_bullet(Vec3{0.12, 0, 0}), true);
  tree.body.setCanSleep(false);
  tree.body.setJointPos(0, scalar(-0.3));
  tree.enter_world();
  expect_calm_landing(world, tree);
  EXPECT_NEAR(static_cast<double>(tree.body.getBasePos().z()), kCubeHalf, 0.002);
  EXPECT_NEAR(static_cast<double>(place_of(tree).z()), kCubeHalf, 0.002);
}

// Bullet starts the impulses of multibodies from zero: its ten iterations leave some per cent too
// much speed.
TEST_P(MultiBody, ABaseReboundsAsItsRestitutionSays) {
  world.world.getSolverInfo().m_numIterations = 30;
  for (const double restitution : {1.0, 0.9, 0.5, 0.0}) {
    auto& shape = world.make<ModelShape>(ball_model());
    Tree tree(world, Tree::Base::kFree, {&shape}, {{}, {0, 0, kBallRadius + 0.513}});
    tree.body.setCanSleep(false);
    tree.enter_world();
    tree.colliders[0]->setRestitution(scalar(restitution));
    double top = kBallRadius;
    bool rises = false;
    for (int i = 0; i < 800; ++i) {
      world.step(1, 1.0 / 500.0);
      const auto speed = static_cast<double>(tree.body.getBaseVel().z());
      rises = rises || speed > 0.02;
      if (rises && speed < 0.0) break;
      if (rises) top = std::max(top, static_cast<double>(place_of(tree).z()));
    }
    const double square = restitution * restitution;
    EXPECT_NEAR((top - kBallRadius) / 0.513, square, 0.02 * square + 0.001) << restitution;
  }
}

// Bullet looks for the pairs of multibodies where they are, not where they will be: what moves by
// more than its size in a step needs bounds of that size.
TEST_P(MultiBody, IsStoppedAtAnySpeedWithinItsBounds) {
  Random random(54);
  for (const double speed : {5.0, 50.0}) {
    for (int i = 0; i < 4; ++i) {
      auto& shape = world.make<ModelShape>(blob_model());
      shape.setMargin(scalar(speed / 60.0));
      Tree tree(world, Tree::Base::kFree, {&shape}, {random.rotation(), {0, 0, 0.7}});
      tree.enter_world();
      tree.body.setBaseVel(to_bullet(Vec3{0, 0, -speed}));
      ASSERT_GT(lowest_over(world, tree, 60, 0.9), 0.0) << "speed " << speed << ", throw " << i;
    }
  }
}

TEST_P(MultiBody, SleepsAndWakesWhenPushed) {
  auto& shape = world.make<ModelShape>(cube_model());
  Tree tree(world, Tree::Base::kFree, {&shape}, {{}, {0, 0, 0.13}});
  tree.enter_world();
  for (int i = 0; i < 2000 && tree.body.isAwake(); ++i) world.step(1);
  ASSERT_FALSE(tree.body.isAwake());
  const btVector3 asleep = place_of(tree);
  world.step(50);
  EXPECT_EQ(place_of(tree), asleep);
  btRigidBody& hammer = world.add_model(ball_model(), 5, {{}, {0.4, 0, kBallRadius}});
  hammer.setLinearVelocity(btVector3(-3, 0, 0));
  world.step(100);
  EXPECT_TRUE(tree.body.isAwake());
  EXPECT_LT(place_of(tree).x(), scalar(-0.05));
}

}  // namespace
}  // namespace voxshell::bullet::multi_body_test
