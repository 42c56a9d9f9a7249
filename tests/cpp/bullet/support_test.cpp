#include "support.h"

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <gtest/gtest.h>

#include "pair_step.h"
#include "support/models.h"
#include "support/two_bodies.h"
#include "support/world.h"
#include "voxshell/bullet/coulomb_solver.h"
#include "voxshell/bullet/parallel_dispatcher.h"

namespace voxshell::bullet::support_test {
namespace {

using namespace test_support;

constexpr double kStep = 1.0 / 30.0;
constexpr double kGravityOfStep = 9.81 * kStep;

/// A world whose dispatcher tells what carries bodies.
class Supporting {
 public:
  Supporting() { world.world.getSolverInfo().m_minimumSolverBatchSize = 1; }

  void step(int count) {
    for (int i = 0; i < count; ++i) world.world.stepSimulation(scalar(kStep), 0);
    support.read(world.dispatcher);
  }

  WorldOf<btDiscreteDynamicsWorld, CoulombSolver> world;
  Support support;
};

TEST(Support, IsWhatCarriesABody) {
  Supporting of;
  of.world.add_model(slab_model(), 0);
  const double top = slab_model()->bounds().upper.z - cube_model()->bounds().lower.z;
  btRigidBody& cube = of.world.add_model(cube_model(), 2.0, {{}, {0, 0, top}});
  of.step(30);
  const Support::Push push = of.support.of(cube);
  EXPECT_NEAR(push.velocity.z, kGravityOfStep, 0.01 * kGravityOfStep);
  EXPECT_NEAR(std::hypot(push.velocity.x, push.velocity.y), 0.0, 0.01 * kGravityOfStep);
  EXPECT_NEAR(push.load, kGravityOfStep, 0.02 * kGravityOfStep);
  const double radius = cube_model()->bounds().upper.z;
  EXPECT_NEAR(radius * length(push.angular_velocity), 0.0, 0.02 * kGravityOfStep);
}

TEST(Support, OfABodyBelowAnotherIsItsOwnWeight) {
  Supporting of;
  of.world.add_model(slab_model(), 0);
  const double side = cube_model()->bounds().upper.z - cube_model()->bounds().lower.z;
  const double top = slab_model()->bounds().upper.z - cube_model()->bounds().lower.z;
  btRigidBody& below = of.world.add_model(cube_model(), 2.0, {{}, {0, 0, top}});
  of.world.add_model(cube_model(), 6.0, {{}, {0, 0, top + side}});
  of.step(60);
  const Support::Push push = of.support.of(below);
  EXPECT_NEAR(push.velocity.z, kGravityOfStep, 0.02 * kGravityOfStep);
  EXPECT_NEAR(push.load, 7.0 * kGravityOfStep, 0.1 * kGravityOfStep);  // 4 up, 3 down
}

TEST(Support, IsNothingOfWhatFalls) {
  Supporting of;
  btRigidBody& cube = of.world.add_model(cube_model(), 1.0);
  of.step(3);
  EXPECT_EQ(length(of.support.of(cube).velocity), 0.0);
  btRigidBody stranger(1.0, nullptr, cube.getCollisionShape());
  EXPECT_EQ(length(of.support.of(stranger).velocity), 0.0);
}

/// A cube that gravity would move farther in a step than CCD allows.
class Resting {
 public:
  Resting()
      : slab(of.world.add_model(slab_model(), 0)),
        cube(of.world.add_model(cube_model(), 1.0, {{}, {0, 0, top()}})),
        bodies(cube, slab) {
    of.step(60);
    // As at the start of a step.
    cube.applyGravity();
  }

  static double top() { return slab_model()->bounds().upper.z - cube_model()->bounds().lower.z; }
  PairStep step(const Support* support) const {
    return describe_step(bodies.pair, {}, kStep, 0.0, support);
  }

  Supporting of;
  btRigidBody& slab;
  btRigidBody& cube;
  TwoBodies bodies;
};

TEST(PairStep, WhatIsCarriedDoesNotFall) {
  const Resting scene;
  const PairStep falls = scene.step(nullptr);
  EXPECT_FALSE(falls.is_supported);
  EXPECT_GT(falls.farthest_displacement, 0.9 * kGravityOfStep * kStep);
  const PairStep lies = scene.step(&scene.of.support);
  EXPECT_TRUE(lies.is_supported);
  EXPECT_LT(lies.farthest_displacement, 0.01 * kGravityOfStep * kStep);
  EXPECT_EQ(lies.margin, lies.rest_margin);
  EXPECT_FALSE(lies.uses_ccd);
}

TEST(PairStep, WhatMovesIsNotCarried) {
  Resting scene;
  scene.cube.setLinearVelocity(btVector3(scalar(0.1), 0, 0));
  EXPECT_FALSE(scene.step(&scene.of.support).is_supported);
}

TEST(PairStep, ABlowDoesNotCarry) {
  Supporting of;
  btRigidBody& slab = of.world.add_model(slab_model(), 0);
  btRigidBody& cube = of.world.add_model(cube_model(), 1.0, {{}, {0, 0, Resting::top() + 0.001}});
  cube.setLinearVelocity(btVector3(0, 0, -1));
  TwoBodies bodies(cube, slab);
  of.step(1);
  ASSERT_LT(std::abs(cube.getLinearVelocity().z()), 0.5);
  cube.setLinearVelocity(btVector3(0, 0, 0));
  cube.applyGravity();
  EXPECT_FALSE(describe_step(bodies.pair, {}, kStep, 0.0, &of.support).is_supported);
}

}  // namespace
}  // namespace voxshell::bullet::support_test
