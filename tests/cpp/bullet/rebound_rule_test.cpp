#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "rebound.h"
#include "support/models.h"
#include "support/two_bodies.h"

namespace voxshell::bullet::rebound_rule_test {
namespace {

constexpr double kStep = 1.0 / 100.0;
constexpr double kGravity = 9.81;  // m/s^2

PairStep make_step(double restitution, double owed_energy = 0.0) {
  PairStep step{};
  step.time_step = kStep;
  step.restitution = restitution;
  step.owed_energy = owed_energy;
  step.motion_a.inverse_mass = 0.5;
  return step;
}

Impact impact(double gap, double approach) {
  return {gap, approach, kGravity * kStep, kGravity * kStep, approach * approach};
}

/// What Bullet's integration keeps of a body that rises at `speed`, J/kg: it adds gravity to the
/// velocity and then moves.
double energy_of(double speed, double height) {
  return 0.5 * speed * speed + kGravity * height - 0.5 * kGravity * kStep * speed;
}

TEST(ReboundRule, WithoutAGapIsRestitutionTimesApproach) {
  const Rebound rebound = rebound_of(make_step(0.6), impact(-0.001, 2.0));
  EXPECT_DOUBLE_EQ(rebound.speed, 1.2);
  EXPECT_EQ(rebound.owed_energy, 0.0);
}

TEST(ReboundRule, AfterAGapHasTheEnergyOfAReboundAtTheSurface) {
  for (const double restitution : {1.0, 0.9, 0.5}) {
    for (const double gap : {0.001, 0.005, 0.015}) {
      constexpr double kSpeed = 2.0;
      const Rebound rebound = rebound_of(make_step(restitution), impact(gap, kSpeed));
      const double after = energy_of(rebound.speed, gap + rebound.speed * kStep);
      EXPECT_GT(rebound.speed, 0.0);
      EXPECT_NEAR(after, restitution * restitution * energy_of(-kSpeed, gap), 1e-9)
          << restitution << ", gap " << gap;
    }
  }
}

TEST(ReboundRule, OwesEnergyWhereTheApexIsBelowTheStart) {
  constexpr double kGap = 0.019;
  const Rebound rebound = rebound_of(make_step(0.1), impact(kGap, 2.0));
  EXPECT_DOUBLE_EQ(rebound.speed, -kGap / kStep);
  EXPECT_GT(rebound.owed_energy, 0.0);
  // The next step pays it.
  const Rebound next = rebound_of(make_step(0.1, rebound.owed_energy), impact(0.0, 0.0));
  EXPECT_GT(next.speed, 0.0);
  EXPECT_EQ(next.owed_energy, 0.0);
}

TEST(ReboundRule, TellsTheSolverWhatItAimsAt) {
  const PairStep step = make_step(0.5);
  const Impact first_impact = impact(0.005, 2.0);
  const SolverRebound rebound = rebound_for_solver(step, 2, first_impact);
  // The solver aims at restitution * approach - gap / time step.
  EXPECT_NEAR(rebound.restitution * 2.0 - 0.005 / kStep, rebound_of(step, first_impact).speed,
              1e-12);
  EXPECT_GT(rebound.first_impulse, 0.0);
}

TEST(ReboundRule, LeavesTheMotionOfABlow) {
  test_support::TestWorld world({}, {0, 0, 0});
  const auto cube = test_support::build_by_tolerance({0.05, 0.05, 0.05});
  btRigidBody& hit = world.add_model(cube, 2, {});
  btRigidBody& hits = world.add_model(cube, 1, {{}, {0, 0, 0.11}});
  hit.setRestitution(1);
  hits.setRestitution(btScalar(0.5));
  hits.setLinearVelocity({1, 0, -2});
  const test_support::TwoBodies bodies(hits, hit);
  const PairStep step = bodies.step(kStep);
  ASSERT_TRUE(step.pair->shell_is_a);
  // A gap of 1 cm, beside the middle of the cube: half of the step is over when it is closed.
  const std::vector<Contact> contacts{{0, -0.01f, {0.02f, 0, -0.05f}, {0, 0, 1}}};
  const auto after = find_motion_after(step, find_first_touch(step, contacts), contacts);
  ASSERT_TRUE(after);
  EXPECT_NEAR(after->fraction, 0.5, 1e-6);
  const Vec3 speed = after->motion.velocity_at({0.02, 0, -0.05});
  EXPECT_NEAR(speed.z, 1.0, 1e-5);
  EXPECT_GT(length(after->motion.angular_velocity), 1.0);
  EXPECT_FALSE(find_motion_after(step, find_first_touch(step, {}), {}));
}

TEST(ReboundRule, ContactsThatDoNotReboundOnlyStopApproaching) {
  const SolverRebound later = rebound_for_solver(make_step(0.5), 0, impact(0.010, 2.0));
  EXPECT_EQ(later.restitution, 0.0);
  EXPECT_EQ(later.first_impulse, 0.0);
}

TEST(ReboundRule, PointsThatPartKeepTheRestitutionOfTheBodies) {
  const SolverRebound parting = rebound_for_solver(make_step(0.7), 1, impact(0.001, -1.0));
  EXPECT_EQ(parting.restitution, 0.7);
  EXPECT_EQ(parting.first_impulse, 0.0);
}

TEST(ReboundRule, TheFirstTouchIsThatOfTheSoonestContact) {
  PairStep step = make_step(0.5);
  step.motion.velocity = {0, 0, -1};
  const std::vector<Contact> contacts{
      {1, -0.004f, {}, {0, 0, 1}}, {2, -0.002f, {}, {0, 0, 1}}, {3, -0.001f, {}, {0, 0, -1}}};
  const FirstTouch first = find_first_touch(step, contacts);
  EXPECT_NEAR(first.time, 0.002, 1e-9);
  EXPECT_TRUE(first.includes(step, impact_of(step, contacts[1])));
  EXPECT_FALSE(first.includes(step, impact_of(step, contacts[0])));  // 20 % of the step later
  EXPECT_FALSE(first.includes(step, impact_of(step, contacts[2])));  // parts
  EXPECT_FALSE(find_first_touch(step, {}).includes(step, impact_of(step, contacts[2])));
}

TEST(ReboundRule, ContactsThatDoNotTouchWithinTheStepDoNotRebound) {
  PairStep step = make_step(0.5);
  step.motion.velocity = {0, 0, -1};
  // The solver sees it because a turn might bring it nearer. Gravity pulls away from it.
  step.motion.velocity_of_forces = {0, 0, kGravity * kStep};
  step.motion.velocity_of_fall = step.motion.velocity_of_forces;
  const std::vector<Contact> contacts{{1, -0.03f, {}, {0, 0, 1}}};
  const FirstTouch first = find_first_touch(step, contacts);
  EXPECT_FALSE(first.includes(step, impact_of(step, contacts[0])));
  Rebounding rebounding;
  rebounding.find(step, first, contacts);
  EXPECT_EQ(rebounding.count_with(1), 0u);
}

/// How many of the contacts of a cube of 10 cm with a fixed one rebound with each. It flies at 1
/// m/s along each axis, and a contact of a gap of 1 mm is closed after a tenth of the step.
std::vector<std::size_t> counts_of(const std::vector<Contact>& contacts, const btVector3& velocity,
                                   double restitution = 0.5) {
  test_support::TestWorld world({}, {0, 0, 0});
  const auto cube = test_support::build_by_tolerance({0.05, 0.05, 0.05});
  btRigidBody& fixed = world.add_model(cube, 0, {});
  btRigidBody& flies = world.add_model(cube, 1, {{}, {0, 0, 0.11}});
  fixed.setRestitution(1);
  flies.setRestitution(btScalar(restitution));
  flies.setLinearVelocity(velocity);
  const test_support::TwoBodies bodies(flies, fixed);
  const PairStep step = bodies.step(kStep);
  Rebounding rebounding;
  rebounding.find(step, find_first_touch(step, contacts), contacts);
  std::vector<std::size_t> counts;
  for (const Contact& contact : contacts) counts.push_back(rebounding.count_with(contact.id));
  return counts;
}

constexpr Vec3f kLow{0, 0, -0.05f};
constexpr Vec3f kAside{-0.05f, 0, 0};
using Counts = std::vector<std::size_t>;

TEST(ReboundRule, ABodyReboundsFromEachWallOfACorner) {
  const std::vector<Contact> corner{{1, -0.001f, kLow, {0, 0, 1}}, {2, -0.006f, kAside, {1, 0, 0}}};
  EXPECT_EQ(counts_of(corner, {-1, 0, -1}), (Counts{1, 1}));
  // Nothing rebounds without restitution, and the second wall is not reached any more.
  EXPECT_EQ(counts_of(corner, {-1, 0, -1}, 0.0), (Counts{1, 0}));
}

TEST(ReboundRule, ABodyThatLiesReboundsFromAWall) {
  const std::vector<Contact> tray{{1, 0.0f, kLow, {0, 0, 1}}, {2, -0.006f, kAside, {1, 0, 0}}};
  EXPECT_EQ(counts_of(tray, {-1, 0, btScalar(-1e-9)}), (Counts{1, 1}));
}

TEST(ReboundRule, WhatTheFirstTouchTurnsAwayDoesNotRebound) {
  const Vec3f slanted{0.6f, 0, 0.8f};
  EXPECT_EQ(counts_of({{1, -0.001f, kLow, {0, 0, 1}}, {2, -0.006f, kAside, slanted}}, {-1, 0, -1}),
            (Counts{1, 0}));
  // The blow beside the middle turns the cube.
  EXPECT_EQ(counts_of({{1, -0.001f, {0.05f, 0, -0.05f}, {0, 0, 1}},
                       {2, -0.006f, {-0.05f, 0, -0.05f}, {0, 0, 1}}},
                      {0, 0, -1}),
            (Counts{1, 0}));
}

TEST(ReboundRule, AFlatLandingAtTheEndOfTheStepIsOne) {
  const std::vector<Contact> flat{{1, -0.00999f, {0.05f, 0, -0.05f}, {0, 0, 1}},
                                  {2, -0.01001f, {-0.05f, 0, -0.05f}, {0, 0, 1}}};
  EXPECT_EQ(counts_of(flat, {0, 0, -1}), (Counts{2, 2}));
}

}  // namespace
}  // namespace voxshell::bullet::rebound_rule_test
