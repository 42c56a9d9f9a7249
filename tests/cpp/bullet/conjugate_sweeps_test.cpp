#include "conjugate_sweeps.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "support/island.h"

namespace voxshell::bullet::conjugate_sweeps_test {
namespace {

using namespace test_support;

constexpr int kBodies = 20;
constexpr double kMass = 2.0;

/// Bodies one on another, all of which fall. Each contact carries what is above it.
class Tower {
 public:
  Tower() {
    const int ground = island_.add_body(0.0);
    int below = ground;
    for (int i = 0; i < kBodies; ++i) {
      const int body = island_.add_body(kMass);
      // The ground holds the lowest; the others fall with those below them.
      island_.add_contact(body, below).m_rhs *= scalar(i == 0 ? 1.0 : 0.0);
      below = body;
    }
  }

  /// From row to row, as the solver does it.
  void sweep() {
    for (int i = 0; i < island_.contacts.size(); ++i) {
      btSolverConstraint& row = island_.contacts[i];
      btSolverBody& a = (*island_.pools().bodies)[row.m_solverBodyIdA];
      btSolverBody& b = (*island_.pools().bodies)[row.m_solverBodyIdB];
      const btScalar missing = row.m_rhs - added_velocity(row, a, b) * row.m_jacDiagABInv;
      const btScalar impulse = std::max(btScalar(row.m_appliedImpulse) + missing, btScalar(0));
      set_impulse(row, a, b, impulse);
    }
  }

  /// How much faster than the ground the highest body still falls, relative to its fall.
  double error() { return 1.0 - island_.velocity(kBodies).z / kFall; }
  const btConstraintArray& contacts() const { return island_.contacts; }
  double velocity(int body) { return island_.velocity(body).z; }
  SolverPools pools() { return island_.pools(); }

 private:
  Island island_;
};

TEST(ConjugateSweeps, ReachTheTopOfATowerInFewerSweeps) {
  constexpr int kSweeps = 60;
  Tower plain;
  for (int i = 0; i < kSweeps; ++i) plain.sweep();
  Tower conjugate;
  ConjugateSweeps sweeps;
  sweeps.begin(conjugate.pools());
  for (int i = 0; i < kSweeps; ++i) {
    if (i > 0) sweeps.go_on(conjugate.pools());
    conjugate.sweep();
  }
  EXPECT_GT(plain.error(), 0.1);
  EXPECT_LT(std::abs(conjugate.error()), 0.1 * plain.error());
}

TEST(ConjugateSweeps, KeepVelocitiesThatTheImpulsesGive) {
  Tower tower;
  ConjugateSweeps sweeps;
  sweeps.begin(tower.pools());
  for (int i = 0; i < 10; ++i) {
    tower.sweep();
    sweeps.go_on(tower.pools());
    for (int body = 1; body <= kBodies; ++body) {
      const double from_below = Island::impulse_of(tower.contacts()[body - 1]);
      const double from_above = body < kBodies ? Island::impulse_of(tower.contacts()[body]) : 0.0;
      EXPECT_NEAR(tower.velocity(body), (from_below - from_above) / kMass,
                  kIsDouble ? 1e-15 : 1e-6);
    }
  }
}

TEST(ConjugateSweeps, LeaveASolutionAsItIs) {
  Tower tower;
  for (int i = 0; i < 5000; ++i) tower.sweep();
  const double before = tower.velocity(kBodies);
  ConjugateSweeps sweeps;
  sweeps.begin(tower.pools());
  for (int i = 0; i < 10; ++i) {
    tower.sweep();
    sweeps.go_on(tower.pools());
  }
  EXPECT_NEAR(tower.velocity(kBodies), before, kIsDouble ? 1e-12 : 1e-5);
}

}  // namespace
}  // namespace voxshell::bullet::conjugate_sweeps_test
