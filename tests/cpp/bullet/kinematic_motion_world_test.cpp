#include "voxshell/bullet/kinematic_motion_world.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <LinearMath/btDefaultMotionState.h>
#include <gtest/gtest.h>

#include "support/world.h"
#include "voxshell/bullet/coulomb_solver.h"

namespace voxshell::bullet::kinematic_motion_world_test {
namespace {

using namespace test_support;

/// A plate that the user moves, with a cube of 0.1 m at rest on it.
template <class World>
struct Lift {
  WorldOf<World, CoulombSolver> world;
  btRigidBody& plate;
  btRigidBody& cube;

  Lift()
      : plate(world.add(
            world.template make<btBoxShape>(btVector3(scalar(0.5), scalar(0.5), scalar(0.05))), 0,
            {{}, {0, 0, -0.05}})),
        cube(world.add(
            world.template make<btBoxShape>(btVector3(scalar(0.05), scalar(0.05), scalar(0.05))), 1,
            {{}, {0, 0, 0.05}})) {
    plate.setCollisionFlags(plate.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    for (btRigidBody* body : {&plate, &cube}) body->setActivationState(DISABLE_DEACTIVATION);
  }

  void move_plate(double x, double z) {
    plate.setWorldTransform(
        btTransform(btMatrix3x3::getIdentity(), btVector3(scalar(x), 0, scalar(z - 0.05))));
  }
  double gap() const {
    return static_cast<double>(cube.getWorldTransform().getOrigin().z() -
                               plate.getWorldTransform().getOrigin().z()) -
           0.1;
  }
};

/// The largest gap and depth, meters, between a lift that goes up and down at a meter per second
/// and its cargo.
template <class World>
std::pair<double, double> ride(int rate) {
  Lift<World> lift;
  const double step = 1.0 / rate;
  double gap = 0.0;
  double depth = 0.0;
  for (int i = 1; i <= rate; ++i) {
    const double time = i * step;
    lift.move_plate(0.0, 0.2 * std::sin(5.0 * time));  // at most half of gravity
    lift.world.step(1, step);
    gap = std::max(gap, lift.gap());
    depth = std::max(depth, -lift.gap());
  }
  return {gap, depth};
}

TEST(KinematicMotion, CarriesCargoWithoutAGap) {
  for (const int rate : {1000, 200, 60, 30}) {
    SCOPED_TRACE(rate);
    const auto [gap, depth] = ride<KinematicMotionWorld<>>(rate);
    EXPECT_LT(gap, 5e-4);
    EXPECT_LT(depth, 5e-4);
  }
  const auto [gap, depth] = ride<btDiscreteDynamicsWorld>(60);
  EXPECT_GT(gap, 0.01);
}

TEST(KinematicMotion, TurnsCargoRoundWithoutDrift) {
  for (const int rate : {200, 60}) {
    SCOPED_TRACE(rate);
    Lift<KinematicMotionWorld<>> lift;
    lift.world.world.getSolverInfo().m_solverMode |=
        SOLVER_USE_2_FRICTION_DIRECTIONS | SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION;
    lift.plate.setFriction(1);
    lift.cube.setFriction(scalar(0.5));
    constexpr double kRadius = 0.3;  // meters
    constexpr double kSpin = 3.0;    // rad/s; the cube slides from 4.0 on
    lift.cube.getWorldTransform().getOrigin().setX(scalar(kRadius));
    lift.cube.setLinearVelocity(btVector3(0, scalar(kSpin * kRadius), 0));
    lift.cube.setAngularVelocity(btVector3(0, 0, scalar(kSpin)));
    for (int i = 1; i <= 5 * rate; ++i) {
      const double angle = kSpin * i / rate;
      lift.plate.getWorldTransform().setRotation(btQuaternion(btVector3(0, 0, 1), scalar(angle)));
      lift.world.step(1, 1.0 / rate);
    }
    const btVector3& place = lift.cube.getWorldTransform().getOrigin();
    EXPECT_NEAR(std::hypot(static_cast<double>(place.x()), static_cast<double>(place.y())), kRadius,
                2e-3);
  }
}

TEST(KinematicMotion, EndsAtThePoseThatWasSet) {
  Lift<KinematicMotionWorld<>> lift;
  for (int i = 1; i <= 10; ++i) {
    lift.move_plate(0.01 * i, 0.02 * i);
    const btTransform set = lift.plate.getWorldTransform();
    lift.world.step(1, 0.01);
    EXPECT_TRUE(lift.plate.getWorldTransform() == set);
    EXPECT_NEAR(static_cast<double>(lift.plate.getLinearVelocity().x()), 1.0, 1e-3);
    EXPECT_NEAR(static_cast<double>(lift.plate.getLinearVelocity().z()), 2.0, 1e-3);
  }
  lift.world.step(1, 0.01);
  EXPECT_EQ(lift.plate.getLinearVelocity().length2(), 0);
}

TEST(KinematicMotion, IsSpreadOverTheStepsOfACall) {
  Lift<KinematicMotionWorld<>> lift;
  lift.move_plate(0.0, 0.04);
  EXPECT_EQ(lift.world.world.stepSimulation(scalar(0.0401), 4, scalar(0.01)), 4);
  EXPECT_NEAR(lift.gap(), 0.0, 5e-4);
  EXPECT_NEAR(static_cast<double>(lift.plate.getWorldTransform().getOrigin().z()), -0.01, 1e-6);
}

TEST(KinematicMotion, FollowsAMotionState) {
  Lift<KinematicMotionWorld<>> lift;
  btDefaultMotionState state(lift.plate.getWorldTransform());
  lift.plate.setMotionState(&state);
  state.m_graphicsWorldTrans.getOrigin().setZ(scalar(-0.04));
  lift.world.step(1, 0.01);
  EXPECT_EQ(lift.plate.getWorldTransform().getOrigin().z(), scalar(-0.04));
  EXPECT_NEAR(static_cast<double>(lift.plate.getLinearVelocity().z()), 1.0, 1e-3);
  lift.plate.setMotionState(nullptr);
}

// A fast paddle hits a ball that it is far from before the step and far from after it.
TEST(KinematicMotion, MeetsWhatIsInBetween) {
  WorldOf<KinematicMotionWorld<>, CoulombSolver> world({}, {0, 0, 0});
  btRigidBody& paddle =
      world.add(world.make<btBoxShape>(btVector3(scalar(0.02), scalar(0.5), scalar(0.5))), 0,
                {{}, {-0.5, 0, 0}});
  paddle.setCollisionFlags(paddle.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
  paddle.setActivationState(DISABLE_DEACTIVATION);
  world.add(world.make<btSphereShape>(scalar(0.05)), 1);
  paddle.setWorldTransform(btTransform(btMatrix3x3::getIdentity(), btVector3(scalar(0.5), 0, 0)));
  world.step(1, 0.01);
  EXPECT_EQ(world.world.getPairCache()->getNumOverlappingPairs(), 1);
}

TEST(KinematicMotion, ForgetsABodyThatIsRemoved) {
  Lift<KinematicMotionWorld<>> lift;
  lift.move_plate(0.0, 0.04);
  lift.world.world.setInternalTickCallback(
      [](btDynamicsWorld* world, btScalar) {
        if (world->getNumCollisionObjects() > 1) {
          world->removeRigidBody(btRigidBody::upcast(world->getCollisionObjectArray()[0]));
        }
      },
      nullptr, true);
  lift.world.step(3, 0.01);
  EXPECT_EQ(lift.world.world.getNumCollisionObjects(), 1);
}

}  // namespace
}  // namespace voxshell::bullet::kinematic_motion_world_test
