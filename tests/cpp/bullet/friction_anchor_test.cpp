#include "friction_anchor.h"

#include <vector>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/two_bodies.h"

namespace voxshell::bullet::friction_anchor_test {
namespace {

using namespace test_support;

/// A cube that lies on a plane, moved along it by `slip`, and a point under its corner.
struct CubeOnPlane {
  explicit CubeOnPlane(double slip, const Vec3& velocity = {})
      : plane(world.add(world.make<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0)),
        cube(world.add_model(cube_model(), 1, {{}, {slip, 0, kCubeHalf}})) {
    cube.setLinearVelocity(to_bullet(velocity));
    step = bodies.step();
  }

  TestWorld world;
  btRigidBody& plane;
  btRigidBody& cube;
  TwoBodies bodies{cube, plane};
  PairStep step{};
  std::vector<Contact> contacts{{0, 0.0f, {0.1f, 0.1f, -0.1f}, {0, 0, 1}}};
};

TEST(FrictionAnchor, TakesHoldOfBodiesThatRest) {
  const CubeOnPlane scene(0.0);
  const Hold hold = renew_hold(scene.step, scene.contacts, {});
  ASSERT_TRUE(hold.b_from_a);
  EXPECT_EQ(length(slip_of(scene.step, hold, scene.contacts[0])), 0.0);
}

TEST(FrictionAnchor, TakesNoHoldOfBodiesThatMove) {
  const CubeOnPlane scene(0.0, {0.5, 0, 0});
  EXPECT_FALSE(renew_hold(scene.step, scene.contacts, {}).b_from_a);
  EXPECT_FALSE(renew_hold(scene.step, {}, {}).b_from_a);
}

TEST(FrictionAnchor, MeasuresSlipsWhileItHolds) {
  const CubeOnPlane start(0.0);
  const Hold before = renew_hold(start.step, start.contacts, {});
  const double slip = 0.01 * start.step.rest_margin;
  const CubeOnPlane moved(slip);
  const Hold hold = renew_hold(moved.step, moved.contacts, before.b_from_a);
  EXPECT_LT(length(hold.b_from_a->translation - before.b_from_a->translation), 1e-12);
  EXPECT_NEAR(slip_of(moved.step, hold, moved.contacts[0]).x, slip, 1e-3 * slip + 1e-8);
}

TEST(FrictionAnchor, LetsGoOfBodiesThatHaveSlid) {
  const CubeOnPlane start(0.0);
  const Hold before = renew_hold(start.step, start.contacts, {});
  const CubeOnPlane moved(0.5 * start.step.rest_margin);
  const Hold hold = renew_hold(moved.step, moved.contacts, before.b_from_a);
  ASSERT_TRUE(hold.b_from_a);
  EXPECT_GT(length(hold.b_from_a->translation - before.b_from_a->translation), 1e-5);
  EXPECT_EQ(length(slip_of(moved.step, hold, moved.contacts[0])), 0.0);
}

}  // namespace
}  // namespace voxshell::bullet::friction_anchor_test
