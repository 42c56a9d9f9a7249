#include <algorithm>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/world.h"
#include "voxshell/bullet/coulomb_solver.h"

namespace voxshell::bullet::loads_test {
namespace {

using namespace test_support;

using CoulombWorld = WorldOf<btDiscreteDynamicsWorld, CoulombSolver>;

constexpr double kGravity = 9.81;  // m/s2

void prepare(CoulombWorld& world) {
  world.world.getSolverInfo().m_solverMode |=
      SOLVER_USE_2_FRICTION_DIRECTIONS | SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION;
  world.world.getSolverInfo().m_minimumSolverBatchSize = 1;
}

/// How far the lower one of two cubes on a slab moves in a second, meters.
double squeeze(double upper_mass, int rate, SolverEffort effort) {
  CoulombWorld world;
  CoulombSolver solver(effort);
  world.world.setConstraintSolver(&solver);
  prepare(world);
  world.add_model(slab_model(), 0).setFriction(1);
  btRigidBody& lower = world.add_model(cube_model(), 1, {{}, {0, 0, 0.1}});
  btRigidBody& upper = world.add_model(cube_model(), upper_mass, {{}, {0, 0, 0.3}});
  lower.setFriction(scalar(0.7));
  upper.setFriction(scalar(0.7));
  const btVector3 start = lower.getWorldTransform().getOrigin();
  world.step(rate, 1.0 / rate);
  return (lower.getWorldTransform().getOrigin() - start).length();
}

TEST(Loads, CubesCarryAThousandTimesTheirMass) {
  for (const int rate : {200, 60, 30}) {
    for (const double mass : {0.001, 100.0, 1000.0}) {
      SCOPED_TRACE(testing::Message() << rate << " Hz, " << mass << " kg");
      EXPECT_LT(squeeze(mass, rate, SolverEffort::kAsNeeded), 5e-4);
    }
  }
}

TEST(Loads, FixedEffortDoesNoMoreThanTheIterationsGiven) {
  EXPECT_GT(squeeze(1000.0, 60, SolverEffort::kFixed), 1e-3);
}

TEST(Loads, StepTheSameWayOnEveryRun) {
  EXPECT_EQ(squeeze(1000.0, 60, SolverEffort::kAsNeeded),
            squeeze(1000.0, 60, SolverEffort::kAsNeeded));
}

// ---- moving surfaces
// -----------------------------------------------------------------------------

TEST(SurfaceVelocity, TakesACubeAlongAfterVOverMuG) {
  constexpr double kSpeed = 0.5;
  constexpr double kFriction = 0.2;
  for (const int rate : {1000, 200, 60, 30}) {
    SCOPED_TRACE(rate);
    CoulombSolver solver;
    CoulombWorld world;
    world.world.setConstraintSolver(&solver);
    prepare(world);
    btRigidBody& belt = world.add_model(slab_model(), 0);
    belt.setCollisionFlags(belt.getCollisionFlags() | btCollisionObject::CF_KINEMATIC_OBJECT);
    belt.setActivationState(DISABLE_DEACTIVATION);
    belt.setFriction(1);
    solver.set_surface_velocity(belt, {scalar(kSpeed), 0, 0});
    btRigidBody& cube = world.add_model(cube_model(), 1, {{}, {0, 0, 0.1}});
    cube.setFriction(scalar(kFriction));
    for (int i = 1; i <= rate * 2 / 5; ++i) {
      world.step(1, 1.0 / rate);
      const double expected = std::min(kFriction * kGravity * i / rate, kSpeed);
      EXPECT_NEAR(cube.getLinearVelocity().x(), expected, 0.02 * kSpeed);
    }
    solver.set_surface_velocity(belt, {0, 0, 0});
    world.step(rate, 1.0 / rate);
    EXPECT_NEAR(cube.getLinearVelocity().x(), 0.0, 1e-3);
  }
}

}  // namespace
}  // namespace voxshell::bullet::loads_test
