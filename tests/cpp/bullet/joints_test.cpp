#include <algorithm>
#include <cmath>
#include <memory>

#include <BulletCollision/CollisionDispatch/btGhostObject.h>
#include <BulletDynamics/Vehicle/btRaycastVehicle.h>
#include <gtest/gtest.h>

#include "support/drop.h"
#include "support/ground.h"
#include "support/models.h"
#include "support/world.h"

namespace voxshell::bullet::joints_test {
namespace {

using namespace test_support;

class Joints : public testing::TestWithParam<ContactMode> {
 protected:
  Joints() : world({.mode = GetParam()}) {}
  ~Joints() override {
    while (world.world.getNumConstraints() > 0) {
      world.world.removeConstraint(world.world.getConstraint(0));
    }
  }

  btRigidBody& add_awake(const std::shared_ptr<const Model>& model, double mass, const Pose& pose) {
    btRigidBody& body = world.add_model(model, mass, pose);
    body.setFriction(scalar(0.8));
    body.setActivationState(DISABLE_DEACTIVATION);
    return body;
  }

  TestWorld world;
};

INSTANTIATE_TEST_SUITE_P(Modes, Joints,
                         testing::Values(ContactMode::kRegular, ContactMode::kSegmented));

// Two cubes side by side, a hinge along y between their upper edges: a lid on the ground.
TEST_P(Joints, AHingeHoldsTwoModelsThatFall) {
  add_ground(world, Ground::kModel).setFriction(1);
  btRigidBody& left = add_awake(cube_model(), 1, {{}, {-0.11, 0, 0.3}});
  btRigidBody& right = add_awake(cube_model(), 1, {{}, {0.11, 0, 0.3}});
  btHingeConstraint hinge(left, right, to_bullet(Vec3{0.11, 0, 0.1}),
                          to_bullet(Vec3{-0.11, 0, 0.1}), btVector3(0, 1, 0), btVector3(0, 1, 0));
  world.world.addConstraint(&hinge, /*disableCollisionsBetweenLinkedBodies=*/true);
  for (int i = 0; i < 600; ++i) {
    world.step(1);
    const btVector3 pin_left = left.getWorldTransform() * to_bullet(Vec3{0.11, 0, 0.1});
    const btVector3 pin_right = right.getWorldTransform() * to_bullet(Vec3{-0.11, 0, 0.1});
    ASSERT_LT((pin_left - pin_right).length(), scalar(0.003)) << "step " << i;
  }
  EXPECT_NEAR(height(left), kCubeHalf, 0.001);
  EXPECT_NEAR(height(right), kCubeHalf, 0.001);
  EXPECT_LT(turn_of(left), 0.05);
  world.world.removeConstraint(&hinge);
}

// A motor presses a model through another one against a third.
TEST_P(Joints, ASliderPressesModelsAgainstAWall) {
  world.world.setGravity(btVector3(0, 0, 0));
  world.add_model(cube_model(), 0, {{}, {0.5, 0, 0}});
  btRigidBody& ram = add_awake(cube_model(), 1, {});
  const Matrix3 upright{{0, 0, 1}, {0, 1, 0}, {-1, 0, 0}};
  btRigidBody& ring = add_awake(torus_model(), 1, {upright, {0.2, 0, 0}});
  btSliderConstraint slider(ram, btTransform::getIdentity(), /*useLinearReferenceFrameA=*/false);
  slider.setLowerLinLimit(-1);
  slider.setUpperLinLimit(1);
  slider.setPoweredLinMotor(true);
  slider.setMaxLinMotorForce(20);
  slider.setTargetLinMotorVelocity(scalar(-0.5));  // of the world against the ram
  world.world.addConstraint(&slider);
  world.step(800);
  // 0.5 without half a cube, the ring's thickness of 0.06 and half a cube.
  EXPECT_NEAR(static_cast<double>(place_of(ram).x()), 0.24, 0.003);
  EXPECT_NEAR(static_cast<double>(place_of(ring).x()), 0.37, 0.003);
  EXPECT_LT(deepest_of(world), 0.002);
  EXPECT_LT(ram.getLinearVelocity().length(), scalar(0.01));
  world.world.removeConstraint(&slider);
}

// A pendulum of a model swings against a model and comes to hang on it.
TEST_P(Joints, APendulumStopsAtAModel) {
  world.add_model(cube_model(), 0, {{}, {0.2, 0, 0}});
  btRigidBody& ball = add_awake(ball_model(), 1, {{}, {-0.5, 0, 0.6}});
  btPoint2PointConstraint rope(ball, to_bullet(Vec3{0.5, 0, 0}));
  world.world.addConstraint(&rope);
  for (int i = 0; i < 2000; ++i) {
    world.step(1);
    const btVector3 hook = ball.getWorldTransform() * to_bullet(Vec3{0.5, 0, 0});
    ASSERT_LT((hook - to_bullet(Vec3{0, 0, 0.6})).length(), scalar(0.02)) << "step " << i;
    ASSERT_LT(place_of(ball).x(), scalar(0.002)) << "step " << i;
  }
  EXPECT_NEAR(static_cast<double>(place_of(ball).x()), 0.0, 0.002);
  EXPECT_NEAR(height(ball), 0.1, 0.01);
  world.world.removeConstraint(&rope);
}

// Its wheels are rays, which see models' triangles: those of the chassis, too, if they start
// within.
TEST(Vehicle, DrivesOverABumpThatIsAModel) {
  TestWorld world;
  add_ground(world, Ground::kModel).setFriction(1);
  static const auto bump = build_model(voxshell::test_support::make_torus(0.3, 0.05, 48, 16), 0.01);
  world.add_model(bump, 0, {{}, {0, 0, -0.02}}).setFriction(1);
  static const auto board = build_model(voxshell::test_support::make_box({0.15, 0.08, 0.02}), 0.01);
  btRigidBody& chassis = world.add_model(board, 20, {{}, {-0.8, 0, 0.12}});
  chassis.setActivationState(DISABLE_DEACTIVATION);

  btDefaultVehicleRaycaster raycaster(&world.world);
  btRaycastVehicle::btVehicleTuning tuning;
  tuning.m_suspensionStiffness = 60;
  tuning.m_suspensionDamping = 6;
  tuning.m_maxSuspensionForce = 1000;
  btRaycastVehicle vehicle(tuning, &chassis, &raycaster);
  vehicle.setCoordinateSystem(/*right=*/1, /*up=*/2, /*forward=*/0);
  for (const double x : {0.13, -0.13}) {
    for (const double y : {0.08, -0.08}) {
      vehicle.addWheel(to_bullet(Vec3{x, y, -0.021}), btVector3(0, 0, -1), btVector3(0, -1, 0),
                       scalar(0.05), scalar(0.05), tuning, x > 0);
    }
  }
  world.world.addAction(&vehicle);
  world.step(200);
  EXPECT_NEAR(height(chassis), 0.08, 0.02);
  for (int wheel = 0; wheel < vehicle.getNumWheels(); ++wheel) {
    EXPECT_TRUE(vehicle.getWheelInfo(wheel).m_raycastInfo.m_isInContact) << wheel;
  }
  const double level = height(chassis);
  double top = level;
  for (int i = 0; i < 2000 && place_of(chassis).x() < scalar(0.7); ++i) {
    for (int wheel = 0; wheel < 4; ++wheel) {
      vehicle.applyEngineForce(vehicle.getCurrentSpeedKmHour() < scalar(3) ? 10 : 0, wheel);
    }
    world.step(1);
    top = std::max(top, height(chassis));
  }
  EXPECT_GT(place_of(chassis).x(), scalar(0.69));  // over both sides of the ring
  EXPECT_GT(top, level + 0.005);
  EXPECT_LT(top, level + 0.04);
  world.world.removeAction(&vehicle);
}

TEST(Kinematic, ATableThatMovesCarriesAModelAlong) {
  for (const ContactMode mode : {ContactMode::kRegular, ContactMode::kSegmented}) {
    TestWorld world({.mode = mode});
    btRigidBody& table = world.add_model(slab_model(), 0);
    table.setCollisionFlags(table.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    table.setActivationState(DISABLE_DEACTIVATION);
    table.setFriction(1);
    btRigidBody& cube = world.add_model(cube_model(), 1, {{}, {0, 0, kCubeHalf}});
    cube.setFriction(scalar(0.8));
    cube.setActivationState(DISABLE_DEACTIVATION);
    // There and back over 0.4 m in 4 s, in a circle: at most 1 m/s2, an eighth of what holds it.
    for (int i = 1; i <= 800; ++i) {
      const double angle = 2 * 3.14159265358979 * i / 800.0;
      table.setWorldTransform(
          to_bullet(Pose{{}, {0.2 * (1 - std::cos(angle)), 0.2 * std::sin(angle), 0.0}}));
      world.step(1);
      const btVector3 apart = place_of(cube) - place_of(table);
      ASSERT_LT(std::hypot(apart.x(), apart.y()), scalar(0.01)) << "step " << i;
      ASSERT_NEAR(apart.z(), kCubeHalf, 0.001);
    }
  }
}

TEST(Trigger, AGhostThatIsAModelKnowsWhoIsInIt) {
  TestWorld world({}, {0, 0, 0});
  btGhostPairCallback callback;
  world.broadphase.getOverlappingPairCache()->setInternalGhostPairCallback(&callback);
  btPairCachingGhostObject ghost;
  ghost.setCollisionShape(&world.make<ModelShape>(torus_model()));
  ghost.setCollisionFlags(btCollisionObject::CF_NO_CONTACT_RESPONSE);
  world.world.addCollisionObject(&ghost, btBroadphaseProxy::SensorTrigger,
                                 btBroadphaseProxy::AllFilter);
  static const auto pea = build_model(voxshell::test_support::make_icosphere(0.02, 3), 0.002);
  // Along the ring's axis it passes the hole, beside it the ring: both lie in the ghost's bounds.
  for (const double x : {0.0, 0.1}) {
    btRigidBody& body = world.add_model(pea, 1, {{}, {x, 0, 0.3}});
    body.setLinearVelocity(btVector3(0, 0, -2));
    int near = 0;
    int touching = 0;
    for (int i = 0; i < 60; ++i) {
      world.step(1);
      near += ghost.getNumOverlappingObjects() > 0;
      touching += !world.points().empty();
    }
    EXPECT_GT(near, 5) << x;
    if (x > 0.0) {
      EXPECT_GT(touching, 3);
    } else {
      EXPECT_EQ(touching, 0);
    }
    EXPECT_NEAR(height(body), -0.3, 1e-3);  // nothing held it up
    world.world.removeRigidBody(&body);
  }
  world.world.removeCollisionObject(&ghost);
}

TEST(Islands, SleepAloneAndWakeTogether) {
  for (const ContactMode mode : {ContactMode::kRegular, ContactMode::kSegmented}) {
    TestWorld world({.mode = mode});
    add_ground(world, Ground::kModel).setFriction(1);
    btRigidBody* cubes[4];
    for (int i = 0; i < 4; ++i) {  // two piles of two
      const Vec3 at{i < 2 ? -0.5 : 0.5, 0, kCubeHalf + (i % 2) * 2 * kCubeHalf};
      cubes[i] = &world.add_model(cube_model(), 1, {{}, at});
      cubes[i]->setFriction(scalar(0.8));
    }
    const auto are_asleep = [&](int first) {
      return cubes[first]->getActivationState() == ISLAND_SLEEPING &&
             cubes[first + 1]->getActivationState() == ISLAND_SLEEPING;
    };
    for (int i = 0; i < 2000 && !(are_asleep(0) && are_asleep(2)); ++i) world.step(1);
    ASSERT_TRUE(are_asleep(0) && are_asleep(2));
    EXPECT_EQ(cubes[0]->getIslandTag(), cubes[1]->getIslandTag());
    EXPECT_NE(cubes[0]->getIslandTag(), cubes[2]->getIslandTag());

    // A ball on the one pile wakes both of its cubes, and neither of the other.
    btRigidBody& ball = world.add_model(ball_model(), 1, {{}, {-0.48, 0, 0.55}});
    bool woke = false;
    for (int i = 0; i < 100 && !woke; ++i) {
      world.step(1);
      woke = cubes[0]->isActive() && cubes[1]->isActive();
    }
    EXPECT_TRUE(woke);
    EXPECT_TRUE(are_asleep(2));
    // With the ball gone they sleep again.
    world.world.removeRigidBody(&ball);
    for (int i = 0; i < 2000 && !are_asleep(0); ++i) world.step(1);
    EXPECT_TRUE(are_asleep(0));
    EXPECT_NEAR(height(*cubes[1]), 3 * kCubeHalf, 0.001);
  }
}

}  // namespace
}  // namespace voxshell::bullet::joints_test
