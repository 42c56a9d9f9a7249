#include "braced_contacts.h"

#include <cmath>
#include <memory>
#include <vector>

#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include "solver_constants.h"
#include "support/world.h"

namespace voxshell::bullet::braced_contacts_test {
namespace {

using namespace test_support;

constexpr double kSide = 0.5;                         // m
const double kRadius = std::sqrt(3.0) / 2.0 * kSide;  // half the diagonal
constexpr double kForce = 20.0;                       // N, of gravity on a body of 2 kg
constexpr double kMotor = 30.0;                       // N
constexpr double kStep = 0.01;                        // s
constexpr double kPressed = 3.0;                      // N s

/// Cubes in a row, and joints and contacts along it.
class Island {
 public:
  int add_body(double mass) {
    originals_.push_back(
        std::make_unique<btRigidBody>(scalar(mass), nullptr, &shape_, btVector3(1, 1, 1)));
    btSolverBody& body = bodies_.expandNonInitializing();
    body.m_originalBody = originals_.back().get();
    body.m_externalForceImpulse.setZero();
    return bodies_.size() - 1;
  }
  void push(int body, double force) {
    bodies_[body].m_externalForceImpulse = {
        scalar(force * kStep) * originals_[static_cast<std::size_t>(body)]->getInvMass(), 0, 0};
  }
  void add_joint(int a, int b, double limit = 1e30) {
    btSolverConstraint& row = add_row(joints_, a, b);
    row.m_lowerLimit = scalar(-limit);
    row.m_upperLimit = scalar(limit);
  }
  void add_contact(int a, int b, double impulse = kPressed) {
    add_row(contacts_, a, b).m_appliedImpulse = scalar(impulse);
  }

  SolverPools pools() { return {&bodies_, &joints_, &contacts_, &friction_, &rolling_}; }
  double soften(int contact) {
    BracedContacts braced;
    braced.find(pools());
    btContactSolverInfo info;
    info.m_timeStep = scalar(kStep);
    braced.soften(pools(), info);
    const btSolverConstraint& row = contacts_[contact];
    // Of an impulse, m/s per N s.
    return static_cast<double>(row.m_cfm / row.m_jacDiagABInv / info.m_erp2);
  }
  double pressed() {
    BracedContacts braced;
    braced.find(pools());
    return braced.sum_of_impulses(pools());
  }

 private:
  btSolverConstraint& add_row(btConstraintArray& rows, int a, int b) {
    btSolverConstraint& row = rows.expandNonInitializing();
    row.m_solverBodyIdA = a;
    row.m_solverBodyIdB = b;
    row.m_contactNormal1.setValue(1, 0, 0);
    row.m_jacDiagABInv = 1;
    row.m_rhs = 0;
    row.m_cfm = 0;
    return row;
  }

  btBoxShape shape_{btVector3(1, 1, 1) * scalar(kSide / 2.0)};
  std::vector<std::unique_ptr<btRigidBody>> originals_;
  btAlignedObjectArray<btSolverBody> bodies_;
  btConstraintArray joints_, contacts_, friction_, rolling_;
};

/// m/s per N s.
double softness_at(double force) { return kBracedDepth * kRadius / (force * kStep * kStep); }

TEST(BracedContacts, AreThoseOfBodiesThatJointsConnect) {
  Island island;
  const int wall = island.add_body(0.0);
  const int floor = island.add_body(0.0);
  const int door = island.add_body(2.0);
  const int handle = island.add_body(1.0);
  const int free = island.add_body(1.0);
  island.add_contact(door, floor);
  island.add_contact(handle, floor);
  island.add_contact(free, floor);
  island.add_contact(free, handle);
  EXPECT_EQ(island.pressed(), 0.0);
  island.add_joint(handle, door);
  EXPECT_EQ(island.pressed(), 0.0);
  island.add_joint(door, wall);
  EXPECT_EQ(island.pressed(), 2 * kPressed);
}

TEST(BracedContacts, GiveWayByASmallDepthAtWhatForcesCanPress) {
  Island island;
  const int floor = island.add_body(0.0);
  const int door = island.add_body(2.0);
  const int load = island.add_body(1.0);
  island.add_joint(door, floor);
  island.add_contact(door, floor);
  island.add_contact(load, door);
  EXPECT_EQ(island.soften(0), 0.0) << "though nothing presses";
  island.push(door, kForce);
  EXPECT_NEAR(island.soften(0), softness_at(kForce), 1e-6 * softness_at(kForce));
  EXPECT_EQ(island.soften(1), 0.0);
}

TEST(BracedContacts, CountMotors) {
  Island island;
  const int floor = island.add_body(0.0);
  const int door = island.add_body(2.0);
  island.add_joint(door, floor);
  island.add_joint(door, floor, kMotor * kStep);
  island.add_contact(door, floor);
  island.push(door, kForce);
  const double force = kForce + kMotor;
  EXPECT_NEAR(island.soften(0), softness_at(force), 1e-6 * softness_at(force));
}

/// When each gave way for itself, a finger with 37 contacts at its tip stuck to the table.
TEST(BracedContacts, OfTwoBodiesGiveWayTogether) {
  Island island;
  const int floor = island.add_body(0.0);
  const int door = island.add_body(2.0);
  const int handle = island.add_body(1.0);
  island.add_joint(door, floor);
  island.add_joint(handle, floor);
  for (int i = 0; i < 4; ++i) island.add_contact(door, floor);
  island.add_contact(door, floor, 0.0);
  island.add_contact(handle, floor);
  island.push(door, kForce);
  const double of_one = softness_at(kForce);
  for (const int contact : {0, 3, 4}) {
    EXPECT_NEAR(island.soften(contact), 4.0 * of_one, 4e-6 * of_one) << contact;
  }
  EXPECT_NEAR(island.soften(5), of_one, 1e-6 * of_one) << "of other bodies";
}

}  // namespace
}  // namespace voxshell::bullet::braced_contacts_test
