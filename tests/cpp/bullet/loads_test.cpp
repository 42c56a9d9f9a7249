#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "island_problem.h"
#include "solver_constants.h"
#include "support/models.h"
#include "support/world.h"
#include "velocity_newton.h"
#include "voxshell/bullet/coulomb_solver.h"

namespace voxshell::bullet {
namespace {

using namespace test_support;

using CoulombWorld = WorldOf<btDiscreteDynamicsWorld, CoulombSolver>;

constexpr double kGravity = 9.81;  // m/s2

void prepare(CoulombWorld& world) {
  world.world.getSolverInfo().m_solverMode |=
      SOLVER_USE_2_FRICTION_DIRECTIONS | SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION;
  world.world.getSolverInfo().m_minimumSolverBatchSize = 1;
}

// ---- Newton's method
// -----------------------------------------------------------------------------

/// Bodies of given masses on one line; each stands on the one below, the first one on the ground.
std::vector<VelocityRow> make_column(const std::vector<double>& masses, double fall) {
  std::vector<VelocityRow> rows;
  for (std::size_t i = 0; i < masses.size(); ++i) {
    VelocityRow row;
    row.is_contact = true;
    row.body_a = static_cast<int>(i);
    row.along_a[2] = 1.0 / std::sqrt(masses[i]);
    row.unit_impulse = masses[i];
    if (i > 0) {
      row.body_b = static_cast<int>(i) - 1;
      row.along_b[2] = -1.0 / std::sqrt(masses[i - 1]);
      row.unit_impulse = 1.0 / (1.0 / masses[i] + 1.0 / masses[i - 1]);
    } else {
      row.target = fall;
    }
    rows.push_back(row);
  }
  return rows;
}

TEST(VelocityNewton, FindsWhatEachContactOfAColumnCarries) {
  const std::vector<double> masses{1.0, 1000.0, 1.0, 50.0};
  constexpr double kFall = 0.1;  // m/s
  std::vector<VelocityRow> rows = make_column(masses, kFall);
  VelocityNewton newton;
  newton.prepare(masses.size(), rows);
  for (int i = 0; i < 10; ++i) newton.solve(rows, 1e4, 20);
  double carried = 0.0;
  for (std::size_t i = masses.size(); i-- > 0;) {
    carried += masses[i] * kFall;
    EXPECT_NEAR(rows[i].impulse, carried, 1e-6 * carried) << i;
  }
}

TEST(VelocityNewton, MeasuresTheVelocityThatImpulsesMiss) {
  constexpr double kFall = 0.1;  // m/s
  std::vector<VelocityRow> rows = make_column({1.0, 1000.0}, kFall);
  VelocityNewton newton;
  newton.prepare(2, rows);
  EXPECT_DOUBLE_EQ(newton.error(rows), kFall);
  // The lower body is stopped, and the heavy one falls on.
  rows[0].impulse = kFall;
  EXPECT_DOUBLE_EQ(newton.error(rows), kFall);
  for (int i = 0; i < 10; ++i) newton.solve(rows, 1e4, 20);
  EXPECT_LT(newton.error(rows), 1e-9);
  rows[0].impulse = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(newton.error(rows) < kFall);
}

TEST(VelocityNewton, LeavesOpenWhatPullsAndKeepsFrictionInItsCone) {
  VelocityRow normal;
  normal.is_contact = true;
  normal.friction_rows = 2;
  normal.friction = 0.5;
  normal.body_a = 0;
  normal.along_a[2] = 1.0;
  normal.unit_impulse = 1.0;
  VelocityRow along_x = normal;
  along_x.is_contact = false;
  along_x.along_a = {1.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  along_x.friction_rows = 0;
  VelocityRow along_y = along_x;
  along_y.along_a = {0.0, 1.0, 0.0, 0.0, 0.0, 0.0};
  const auto solve = [&](double up, double x, double y) {
    std::array rows{normal, along_x, along_y};
    rows[0].target = up;
    rows[1].target = x;
    rows[2].target = y;
    VelocityNewton newton;
    newton.prepare(1, rows);
    EXPECT_TRUE(newton.solve(rows, 1e4, 20));
    return std::array{rows[0].impulse, rows[1].impulse, rows[2].impulse};
  };
  EXPECT_EQ(solve(-1.0, 0.0, 0.0), (std::array{0.0, 0.0, 0.0}));
  const auto sticking = solve(1.0, 0.3, 0.3);
  EXPECT_NEAR(sticking[1], 0.3, 1e-3);
  const auto sliding = solve(1.0, 3.0, 4.0);
  EXPECT_NEAR(std::hypot(sliding[1], sliding[2]), 0.5 * sliding[0], 1e-9);
  EXPECT_NEAR(sliding[2] / sliding[1], 4.0 / 3.0, 1e-6);
}

/// A contact that gives way, at rest and sliding: v + softness * impulse is its target.
TEST(VelocityNewton, GivesWayAlongTheNormalAlone) {
  constexpr double kSoftness = 3.0;
  VelocityRow normal;
  normal.is_contact = true;
  normal.friction_rows = 1;
  normal.friction = 0.5;
  normal.body_a = 0;
  normal.along_a[2] = 1.0;
  normal.unit_impulse = 1.0 / (1.0 + kSoftness);
  normal.softness = kSoftness;
  normal.target = 2.0;
  VelocityRow along_x = normal;
  along_x.is_contact = false;
  along_x.along_a = {1.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  along_x.friction_rows = 0;
  along_x.softness = 0.0;
  for (const double aside : {0.2, 5.0}) {
    std::array rows{normal, along_x};
    rows[1].target = aside;
    VelocityNewton newton;
    newton.prepare(1, rows);
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(newton.solve(rows, 1e4, 20));
    EXPECT_LT(newton.error(rows), 1e-9);
    // Of 1 kg: velocities are impulses. What slides also opens by friction times its speed.
    const double sliding = aside - rows[1].impulse;
    EXPECT_NEAR(rows[0].impulse * (1.0 + kSoftness), 2.0 + 0.5 * sliding, 1e-6);
    EXPECT_NEAR(rows[1].impulse, std::min(aside, 0.5 * rows[0].impulse), 1e-6);
  }
}

/// Bodies of 1 kg on top of each other, with many contacts of scattered normals between each two.
std::vector<VelocityRow> make_rubble(int bodies, int contacts_each, unsigned seed) {
  std::minstd_rand random(seed);
  const auto draw = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(random()) / std::minstd_rand::max();
  };
  std::vector<VelocityRow> rows;
  for (int i = 0; i < bodies * contacts_each; ++i) {
    const int above = i / contacts_each;
    const Vec3 lever{draw(-1.5, 1.5), draw(-1.5, 1.5), draw(-1.0, 1.0)};
    const Vec3 normal = normalized(Vec3{draw(-1.0, 1.0), draw(-1.0, 1.0), draw(0.1, 1.0)});
    const Vec3 across = normalized(cross(normal, Vec3{1.0, 0.3, 0.2}));
    const double target = draw(-3.0, 0.3);
    const double impulse = draw(0.0, 1.0);
    for (const Vec3& along : {normal, across, cross(normal, across)}) {
      VelocityRow& row = rows.emplace_back();
      const Vec3 turn = cross(lever, along);
      row.body_a = above;
      row.along_a = {along.x, along.y, along.z, turn.x, turn.y, turn.z};
      double answer = dot(along, along) + dot(turn, turn);
      if (above > 0) {
        row.body_b = above - 1;
        const Vec3 turn_b = cross(lever + Vec3{0.0, 0.0, 2.0}, along);
        row.along_b = {-along.x, -along.y, -along.z, -turn_b.x, -turn_b.y, -turn_b.z};
        answer += dot(along, along) + dot(turn_b, turn_b);
      }
      row.unit_impulse = 1.0 / answer;
    }
    VelocityRow& first = rows[rows.size() - 3];
    first.is_contact = true;
    first.friction_rows = 2;
    first.friction = 1.0;
    first.target = target;
    first.impulse = impulse;
    first.unit_impulse = std::min({first.unit_impulse, rows[rows.size() - 2].unit_impulse,
                                   rows[rows.size() - 1].unit_impulse});
  }
  return rows;
}

/// The velocities at which a solve ends are to be those that its impulses give. Otherwise each
/// solve begins farther from the solution than the one before.
TEST(VelocityNewton, ErrorsOfHundredsOfContactsDoNotGrowFromSolveToSolve) {
  constexpr int kBodies = 8;
  for (const unsigned seed : {1U, 2U, 3U}) {
    SCOPED_TRACE(seed);
    std::vector<VelocityRow> rows = make_rubble(kBodies, 150, seed);
    VelocityNewton newton;
    newton.prepare(kBodies, rows);
    for (const double stiffness : {6.4e3, 1e4, 1e4, 1e4}) {
      EXPECT_TRUE(newton.solve(rows, stiffness, kMostNewtonSteps));
      EXPECT_LT(newton.error(rows), 0.5);  // m/s: contacts that slide may open
    }
  }
}

TEST(VelocityNewton, ChangesNoImpulseWhereStepsDoNotSuffice) {
  std::vector<VelocityRow> rows = make_rubble(8, 150, 1);
  const std::vector<VelocityRow> before = rows;
  VelocityNewton newton;
  newton.prepare(8, rows);
  EXPECT_FALSE(newton.solve(rows, 1e4, 2));
  for (std::size_t i = 0; i < rows.size(); ++i) EXPECT_EQ(rows[i].impulse, before[i].impulse);
}

// ---- states of a solve
// --------------------------------------------------------------------------

TEST(SolverState, BringsBackVelocitiesAfterImpulsesOfAnySize) {
  btRigidBody original(1, nullptr, nullptr);
  btAlignedObjectArray<btSolverBody> bodies;
  for (int i = 0; i < 2; ++i) {
    btSolverBody& body = bodies.expandNonInitializing();
    body.m_originalBody = &original;
    body.internalGetDeltaLinearVelocity().setZero();
    body.internalGetDeltaAngularVelocity().setZero();
    body.m_linearFactor.setValue(1, 1, 1);
    body.m_angularFactor.setValue(1, 1, 1);
    body.internalSetInvMass({scalar(0.3), scalar(0.3), scalar(0.3)});
  }
  btConstraintArray joints;
  btConstraintArray contacts;
  btConstraintArray friction;
  btConstraintArray rolling;
  btSolverConstraint& row = contacts.expandNonInitializing();
  row.m_contactNormal1.setValue(0, 0, 1);
  row.m_contactNormal2.setValue(0, 0, -1);
  row.m_angularComponentA.setValue(1, 0, 0);
  row.m_angularComponentB.setValue(0, 1, 0);
  row.m_appliedImpulse = 0;
  row.m_jacDiagABInv = 1;
  const SolverPools pools{&bodies, &joints, &contacts, &friction, &rolling};
  set_impulse(row, bodies[0], bodies[1], scalar(0.7));
  const btVector3 linear = bodies[0].getDeltaLinearVelocity();
  const btVector3 angular = bodies[1].getDeltaAngularVelocity();
  ASSERT_NE(linear.z(), 0);
  ASSERT_NE(angular.y(), 0);
  SolverState state;
  state.read(pools);
  set_impulse(row, bodies[0], bodies[1], scalar(1e22));
  state.write(pools);
  EXPECT_EQ(btScalar(row.m_appliedImpulse), scalar(0.7));
  EXPECT_EQ(bodies[0].getDeltaLinearVelocity(), linear);
  EXPECT_EQ(bodies[1].getDeltaAngularVelocity(), angular);
}

// ---- worlds
// --------------------------------------------------------------------------------------

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
}  // namespace voxshell::bullet
