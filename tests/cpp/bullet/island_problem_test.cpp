#include "island_problem.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <vector>

#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include "solver_constants.h"
#include "support/island.h"
#include "support/random.h"
#include "support/world.h"

namespace voxshell::bullet::island_problem_test {
namespace {

using namespace test_support;
using Sliding = IslandProblem::Sliding;
using voxshell::test_support::Random;

constexpr double kTolerance = kIsDouble ? 1e-7 : 1e-5;

/// Of two places, by Cramer's rule. The body's axes of inertia are aslant, so that a push turns it
/// about all of them.
TEST(IslandProblem, StopsTwoPlacesOfABodyByItsWholeTensorOfInertia) {
  constexpr double kMass = 2.0;
  constexpr Vec3 kInertia{0.2, 0.3, 0.4};
  constexpr Vec3 kUp{0, 0, 1};
  Random random(3);
  for (int i = 0; i < 10; ++i) {
    const Matrix3 rotation = random.rotation();
    const std::array levers{random.in_cube(0.5), random.in_cube(0.5)};
    const auto turned_by = [&](const Vec3& torque) {
      const Vec3 own = rotation.transposed() * torque;
      return rotation * Vec3{own.x / kInertia.x, own.y / kInertia.y, own.z / kInertia.z};
    };
    const auto answer = [&](std::size_t at, std::size_t pushed) {
      return 1.0 / kMass + dot(cross(levers[at], kUp), turned_by(cross(levers[pushed], kUp)));
    };
    const double determinant = answer(0, 0) * answer(1, 1) - answer(0, 1) * answer(1, 0);
    const std::array impulses{kFall * (answer(1, 1) - answer(0, 1)) / determinant,
                              kFall * (answer(0, 0) - answer(1, 0)) / determinant};
    Island island;
    const int ground = island.add_body(0.0);
    const int body = island.add_body(kMass, kInertia, rotation);
    for (const Vec3& lever : levers) {
      island.add_row(island.joints, body, ground, kUp, kFall, lever);
    }
    island.solve(5);
    Vec3 torque;
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_NEAR(Island::impulse_of(island.joints[static_cast<int>(k)]), impulses[k],
                  10 * kTolerance);
      torque = torque + impulses[k] * cross(levers[k], kUp);
    }
    EXPECT_NEAR(island.velocity(body).z, (impulses[0] + impulses[1]) / kMass, 10 * kTolerance);
    EXPECT_LT(length(island.turning(body) - turned_by(torque)), 20 * kTolerance);
    EXPECT_EQ(length(island.velocity(ground)), 0.0);
  }
}

TEST(IslandProblem, SharesAJointsVelocityByMassAsFarAsItIsHard) {
  constexpr std::array<std::array<double, 2>, 3> kLimitsAndSoftness{
      {{10.0, 0.0}, {0.5, 0.0}, {10.0, 1.5}}};
  for (const auto& [limit, softness] : kLimitsAndSoftness) {
    Island island;
    const int light = island.add_body(1.0);
    const int heavy = island.add_body(3.0);
    btSolverConstraint& row = island.add_joint(light, heavy, {1, 0, 0}, 1.0);
    row.m_upperLimit = scalar(limit);
    row.m_cfm = scalar(softness) * row.m_jacDiagABInv;
    island.solve(3);
    const double impulse = std::min(limit, 1.0 / (1.0 + 1.0 / 3.0 + softness));
    EXPECT_NEAR(Island::impulse_of(island.joints[0]), impulse, kTolerance);
    EXPECT_NEAR(island.velocity(light).x, impulse, kTolerance);
    EXPECT_NEAR(island.velocity(heavy).x, -impulse / 3.0, kTolerance);
  }
}

/// A body of 2 kg that falls and slides over the ground.
struct Slide : Island {
  explicit Slide(double fastest) : speed(fastest) {
    const int ground = add_body(0.0);
    body = add_body(kMass);
    add_contact(body, ground, kFriction);
    add_friction(body, ground, {1, 0, 0}, 0.6 * speed);
    add_friction(body, ground, {0, 1, 0}, -0.8 * speed);
  }
  double pressed() const { return impulse_of(contacts[0]); }

  static constexpr double kMass = 2.0;
  static constexpr double kFriction = 0.5;
  int body;
  double speed;
};

TEST(IslandProblem, KeepsWhatSlidesFromOpeningWhereItIsCorrected) {
  constexpr double kSpeed = 0.8;
  Slide slide(kSpeed);
  slide.solve(20, Sliding::kIgnored);
  // It opens at friction times the speed at which it goes on sliding.
  const double speed_up = (kFall + Slide::kFriction * kSpeed) / (1.0 + 0.25);
  EXPECT_NEAR(slide.pressed(), Slide::kMass * speed_up, 10 * kTolerance);
  EXPECT_GT(slide.error(), 0.1);
  slide.solve(20, Sliding::kCorrected);
  EXPECT_NEAR(slide.pressed(), Slide::kMass * kFall, 10 * kTolerance);
  const double braked = Slide::kFriction * kFall;
  EXPECT_LT(length(slide.velocity(slide.body) - Vec3{-0.6 * braked, 0.8 * braked, kFall}),
            10 * kTolerance);
  EXPECT_LT(slide.error(), 10 * kTolerance);
}

TEST(IslandProblem, StopsWhatFrictionCanHold) {
  constexpr double kSpeed = 0.9 * Slide::kFriction * kFall;
  Slide slide(kSpeed);
  slide.solve(5);
  EXPECT_LT(length(slide.velocity(slide.body) - Vec3{-0.6 * kSpeed, 0.8 * kSpeed, kFall}),
            kTolerance);
}

TEST(IslandProblem, BrakesRollingByTheLeverAtWhichItsContactIsPressed) {
  constexpr double kInertia = 0.05;
  constexpr double kLever = 0.01;
  constexpr double kMost = kLever * 2.0 * kFall / kInertia;  // rad/s
  for (const double turning : {3.0 * kMost, -3.0 * kMost, 0.5 * kMost}) {
    Island island;
    const int ground = island.add_body(0.0);
    const int ball = island.add_body(2.0, {kInertia, kInertia, kInertia});
    // Another contact, so that the rolling row's is not the first.
    island.add_contact(island.add_body(7.0), ground);
    island.add_contact(ball, ground);
    island.add_rolling(ball, ground, {1, 0, 0}, turning, kLever);
    island.solve(5);
    const double expected = -std::copysign(std::min(std::abs(turning), kMost), turning);
    EXPECT_NEAR(island.turning(ball).x, expected, 20 * kTolerance) << turning;
  }
}

TEST(IslandProblem, MissesWhatTheWorstRowMisses) {
  Island island;
  const int ground = island.add_body(0.0);
  const int body = island.add_body(5.0);
  island.add_contact(body, ground);
  EXPECT_NEAR(island.error(), kFall, kTolerance);
  island.add_joint(body, ground, {1, 0, 0}, -3 * kFall);
  EXPECT_NEAR(island.error(), 3 * kFall, kTolerance);
  island.solve(5);
  EXPECT_LT(island.error(), kTolerance);
}

TEST(IslandProblem, ChangesNothingWithoutAnAnswer) {
  Island island;
  const int ground = island.add_body(0.0);
  const int body = island.add_body(5.0);
  island.add_contact(body, ground).m_appliedImpulse = scalar(0.2);
  island.add_joint(body, ground, {1, 0, 0}, 1.0).m_rhs = std::numeric_limits<btScalar>::quiet_NaN();
  IslandProblem problem;
  ASSERT_TRUE(problem.prepare(island.pools()));
  EXPECT_FALSE(problem.solve(island.pools(), 1e4, Sliding::kCorrected));
  EXPECT_EQ(btScalar(island.contacts[0].m_appliedImpulse), scalar(0.2));
  EXPECT_EQ(btScalar(island.joints[0].m_appliedImpulse), btScalar(0));
  EXPECT_EQ(length(island.velocity(body)), 0.0);
}

TEST(IslandProblem, IsForWhatMovesAndIsNarrow) {
  Island fixed;
  fixed.add_contact(fixed.add_body(0.0), fixed.add_body(0.0));
  EXPECT_FALSE(fixed.pays());
  // The matrix of ten bodies, all of which touch each other, is full: 60^3 / 6 multiplications.
  constexpr int kBodies = 10;
  static_assert(60 * 60 * 60 / 6 > kMostCost);
  Island heap, tower, robot;
  for (int i = 0; i < kBodies; ++i) {
    for (Island* island : {&heap, &tower, &robot}) island->add_body(1.0);
    if (i > 0) tower.add_contact(i, i - 1);
    for (int k = 0; k < i; ++k) heap.add_contact(i, k);
    for (int k = 0; k < i; ++k) robot.add_joint(i, k, {1, 0, 0}, 0.0);
  }
  EXPECT_FALSE(heap.pays());
  EXPECT_TRUE(tower.pays());
  EXPECT_TRUE(robot.pays());
}

TEST(IslandProblem, IsSmallUpToADozenBodiesBesideThoseOfJoints) {
  Island island;
  int last = island.add_body(0.0);
  for (std::size_t i = 0; i < kFewBodies; ++i) last = island.add_body(1.0);
  island.pays();
  EXPECT_TRUE(island.is_small());
  const int hinged = island.add_body(1.0);
  island.pays();
  EXPECT_FALSE(island.is_small());
  for (std::size_t i = 1; i <= kRowsOfJoint; ++i) {
    island.add_joint(hinged, last, {1, 0, 0}, 0.0);
    island.pays();
    EXPECT_EQ(island.is_small(), i == kRowsOfJoint) << i;
  }
}

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

}  // namespace
}  // namespace voxshell::bullet::island_problem_test
