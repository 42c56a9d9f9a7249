#include "voxshell/bullet/carried_contacts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "support/world.h"
#include "voxshell/bullet/coulomb_solver.h"

namespace voxshell::bullet::carried_contacts_test {
namespace {

using namespace test_support;

constexpr double kRate = 200.0;
constexpr double kDegree = std::numbers::pi / 180.0;

/// Degrees at which a flat box begins to slip on a tray of Bullet's that tips at 10 degrees a
/// second.
template <class World>
double slope_of_slipping(double friction) {
  WorldOf<World, CoulombSolver> world;
  world.world.getSolverInfo().m_solverMode |=
      SOLVER_USE_2_FRICTION_DIRECTIONS | SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION;
  btRigidBody& tray = world.add(
      world.template make<btBoxShape>(btVector3(scalar(0.5), scalar(0.25), scalar(0.025))), 0,
      {{}, {0, 0, -0.025}});
  tray.setCollisionFlags(tray.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
  tray.setFriction(scalar(friction));
  btRigidBody& box = world.add(
      world.template make<btBoxShape>(btVector3(scalar(0.05), scalar(0.05), scalar(0.01))), 1,
      {{}, {0, 0, 0.01}});
  box.setFriction(1);
  for (btRigidBody* body : {&tray, &box}) body->setActivationState(DISABLE_DEACTIVATION);
  for (double degrees = 0.0; degrees < 80.0; degrees += 10.0 / kRate) {
    const btMatrix3x3 turn(btQuaternion(btVector3(0, 1, 0), scalar(degrees * kDegree)));
    tray.setWorldTransform(btTransform(turn, turn * btVector3(0, 0, scalar(-0.025))));
    world.step(1, 1.0 / kRate);
    const btVector3 on_tray = turn.transpose() * box.getWorldTransform().getOrigin();
    if (std::abs(static_cast<double>(on_tray.x())) > 0.005) return degrees;
  }
  return 80.0;
}

// In float, Bullet takes the velocity of a kinematic body that turns by 0.05 degrees from noise.
TEST(CarriedContacts, LetABoxSlipOnATippingBox) {
  if (!kIsDouble) GTEST_SKIP();
  for (const double friction : {0.1, 0.5}) {
    const double slope = std::atan(friction) / kDegree;
    // It takes two to three tenths of a second to slip by 5 mm.
    EXPECT_NEAR(slope_of_slipping<CarriedContactsWorld<>>(friction), slope + 2.5, 0.3) << friction;
  }
  EXPECT_GT(slope_of_slipping<btDiscreteDynamicsWorld>(0.5), 60.0);
}

TEST(CarriedContacts, OfOtherBodiesAtTheSamePlaceStay) {
  WorldOf<CarriedContactsWorld<>, CoulombSolver> world;
  btCollisionShape& shape = world.make<btBoxShape>(btVector3(1, 1, 1));
  world.add(shape, 0, {{}, {0, 0, -1}});
  btRigidBody& first = world.add(shape, 1, {{}, {0, 0, 1}});
  world.step(1);
  world.world.removeRigidBody(&first);
  const Matrix3 quarter{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}};
  world.add(shape, 1, {quarter, {0, 0, 1}});
  world.step(1);
  ASSERT_FALSE(world.points().empty());
  for (const btManifoldPoint* point : world.points()) {
    EXPECT_NEAR(std::abs(static_cast<double>(point->m_normalWorldOnB.z())), 1.0, 1e-5);
  }
}

/// How deep a corner of a box goes that slides over another one of Bullet's for a second at 60 Hz;
/// it begins 0.1 mm deep. Meters.
template <class World>
double depth_of_sliding_box() {
  WorldOf<World, CoulombSolver> world;
  world.add(world.template make<btBoxShape>(btVector3(10, 1, scalar(0.5))), 0, {{}, {0, 0, -0.5}})
      .setFriction(0);
  const btVector3 half(scalar(0.1), scalar(0.05), scalar(0.015));
  btRigidBody& box = world.add(world.template make<btBoxShape>(half), 1, {{}, {-4, 0, 0.0149}});
  box.setFriction(0);
  box.setLinearVelocity(btVector3(1, 0, 0));
  double deepest = 0.0;
  for (int i = 0; i < 60; ++i) {
    world.step(1, 1.0 / 60.0);
    const btVector3 down = box.getWorldTransform().getBasis().transpose() * btVector3(0, 0, -1);
    const btVector3 corner(std::copysign(half.x(), down.x()), std::copysign(half.y(), down.y()),
                           std::copysign(half.z(), down.z()));
    deepest = std::max(deepest, -static_cast<double>((box.getWorldTransform() * corner).z()));
  }
  return deepest;
}

TEST(CarriedContacts, LetNoSlidingBoxSink) {
  EXPECT_LT(depth_of_sliding_box<CarriedContactsWorld<>>(), 1e-4);
  EXPECT_GT(depth_of_sliding_box<btDiscreteDynamicsWorld>(), 5e-3);
}

}  // namespace
}  // namespace voxshell::bullet::carried_contacts_test
