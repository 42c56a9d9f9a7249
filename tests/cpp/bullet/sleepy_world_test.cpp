#include "voxshell/bullet/sleepy_world.h"

#include <gtest/gtest.h>

#include "support/world.h"

namespace voxshell::bullet::sleepy_world_test {
namespace {

using namespace test_support;

using Sleepy = WorldOf<SleepyWorld<>, btSequentialImpulseConstraintSolver>;

constexpr double kStep = 1.0 / 200.0;

/// A box of 0.1 m on a plane.
template <class World>
btRigidBody& add_box(World& world, double height, double friction) {
  btRigidBody& box = world.add(
      world.template make<btBoxShape>(btVector3(btScalar(0.05), btScalar(0.05), btScalar(0.05))), 1,
      {{}, {0, 0, height}});
  box.setFriction(scalar(friction));
  return box;
}

template <class World>
void add_plane(World& world) {
  world.add(world.template make<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0)
      .setFriction(1);
}

TEST(SleepyWorld, MovedBodiesAreThoseOfWhichAPointMoved) {
  const btTransform start(btQuaternion(btVector3(1, 0, 0), scalar(0.3)), btVector3(1, 2, 3));
  btTransform moved = start;
  moved.setOrigin(start.getOrigin() + btVector3(scalar(4e-4), 0, 0));
  EXPECT_FALSE(has_moved(start, moved, scalar(0.1)));
  EXPECT_TRUE(has_moved(start, moved, scalar(0.05)));
  btTransform turned = start;
  turned.setRotation(btQuaternion(btVector3(0, 0, 1), scalar(0.004)) * start.getRotation());
  EXPECT_FALSE(has_moved(start, turned, scalar(0.1)));
  turned.setRotation(btQuaternion(btVector3(0, 0, 1), scalar(0.006)) * start.getRotation());
  EXPECT_TRUE(has_moved(start, turned, scalar(0.1)));
}

TEST(SleepyWorld, LetsABodyAtRestSleepAfterTwoSeconds) {
  Sleepy world;
  add_plane(world);
  btRigidBody& box = add_box(world, 0.05, 0.5);
  world.step(380, kStep);
  EXPECT_TRUE(box.isActive());
  world.step(60, kStep);
  EXPECT_FALSE(box.isActive());
}

// In Bullet's own world it stops.
TEST(SleepyWorld, LetsASlowBodySlideOn) {
  Sleepy world;
  add_plane(world);
  btRigidBody& box = add_box(world, 0.05, 0.0);
  box.setLinearVelocity(btVector3(scalar(0.1), 0, 0));
  world.step(2000, kStep);
  EXPECT_TRUE(box.isActive());
  EXPECT_NEAR(box.getWorldTransform().getOrigin().x(), 1.0, 0.02);
}

// In Bullet's own world it hangs in midair.
TEST(SleepyWorld, LetsASleeperFallWhoseSupportLeaves) {
  Sleepy world;
  add_plane(world);
  btRigidBody& lower = add_box(world, 0.05, 0.5);
  btRigidBody& upper = add_box(world, 0.15, 0.5);
  world.step(20, kStep);
  lower.setActivationState(ISLAND_SLEEPING);
  upper.setActivationState(ISLAND_SLEEPING);
  world.step(1, kStep);
  ASSERT_FALSE(upper.isActive());
  lower.setFriction(0);
  lower.setLinearVelocity(btVector3(8, 0, 0));
  lower.activate();
  world.step(200, kStep);
  EXPECT_GT(lower.getWorldTransform().getOrigin().x(), 0.5);
  EXPECT_NEAR(upper.getWorldTransform().getOrigin().z(), 0.05, 5e-3);
}

TEST(SleepyWorld, ForgetsRemovedBodies) {
  Sleepy world;
  add_plane(world);
  btRigidBody& box = add_box(world, 0.05, 0.5);
  world.step(300, kStep);
  world.world.removeRigidBody(&box);
  world.world.addRigidBody(&box);
  box.setDeactivationTime(0);
  world.step(300, kStep);
  EXPECT_TRUE(box.isActive());
}

}  // namespace
}  // namespace voxshell::bullet::sleepy_world_test
