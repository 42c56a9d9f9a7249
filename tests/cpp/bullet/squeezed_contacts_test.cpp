#include "squeezed_contacts.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include "solver_constants.h"
#include "support/world.h"
#include "voxshell/bullet/coulomb_solver.h"
#include "voxshell/bullet/kinematic_motion_world.h"

namespace voxshell::bullet::squeezed_contacts_test {
namespace {

using namespace test_support;

// ---- rows
// ----------------------------------------------------------------------------------------

constexpr double kStep = 1.0 / 200.0;
constexpr int kSweeps = 10;
constexpr double kSpeed = 0.04;  // m/s: of 1 mm at the default ERP of 0.2

/// What Bullet's solver sets up for spheres of 1 m that overlap, and their split impulses.
class Island {
 public:
  int add_fixed() { return add_body(0.0); }
  int add_driven() {
    const int body = add_body(0.0);
    originals_.back()->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
    bodies_[body].m_originalBody = originals_.back().get();
    return body;
  }
  int add_body(double mass) {
    originals_.push_back(std::make_unique<btRigidBody>(scalar(mass), nullptr, &shape_,
                                                       btVector3(1, 1, 1) * scalar(mass)));
    btSolverBody& body = bodies_.expandNonInitializing();
    body.m_originalBody = mass > 0.0 ? originals_.back().get() : nullptr;
    const btScalar inverse = originals_.back()->getInvMass();
    body.internalSetInvMass({inverse, inverse, inverse});
    body.m_linearFactor.setValue(1, 1, 1);
    body.m_angularFactor.setValue(1, 1, 1);
    body.m_pushVelocity.setZero();
    body.m_turnVelocity.setZero();
    body.m_angularVelocity.setZero();
    return bodies_.size() - 1;
  }

  /// @param normal Toward a.
  /// @param speed That the contact asks for, m/s.
  void add_contact(int a, int b, const btVector3& normal, double speed) {
    btSolverConstraint& row = contacts_.expandNonInitializing();
    row.m_solverBodyIdA = a;
    row.m_solverBodyIdB = b;
    row.m_contactNormal1 = normal;
    row.m_contactNormal2 = -normal;
    for (btVector3* turn : {&row.m_relpos1CrossNormal, &row.m_relpos2CrossNormal,
                            &row.m_angularComponentA, &row.m_angularComponentB}) {
      turn->setZero();
    }
    row.m_jacDiagABInv =
        1 / (bodies_[a].internalGetInvMass().x() + bodies_[b].internalGetInvMass().x());
    row.m_rhs = 0;
    row.m_rhsPenetration = scalar(speed) * row.m_jacDiagABInv;
    row.m_cfm = 0;
    row.m_appliedPushImpulse = 0;
    row.m_originalContactPoint = &point_;
    row.m_frictionIndex = 0;
  }

  void sweep(int sweeps) {
    for (int i = 0; i < sweeps * contacts_.size(); ++i) {
      btSolverConstraint& row = contacts_[i % contacts_.size()];
      btSolverBody& a = bodies_[row.m_solverBodyIdA];
      btSolverBody& b = bodies_[row.m_solverBodyIdB];
      const btScalar before = row.m_appliedPushImpulse;
      const btScalar missing =
          row.m_rhsPenetration -
          row.m_contactNormal1.dot(a.m_pushVelocity - b.m_pushVelocity) * row.m_jacDiagABInv;
      const btScalar change = std::max(before + missing, btScalar(0)) - before;
      row.m_appliedPushImpulse = before + change;
      a.internalApplyPushImpulse(row.m_contactNormal1 * a.internalGetInvMass(), {0, 0, 0}, change);
      b.internalApplyPushImpulse(row.m_contactNormal2 * b.internalGetInvMass(), {0, 0, 0}, change);
    }
  }

  void soften() {
    btContactSolverInfo info;
    info.m_timeStep = scalar(kStep);
    SqueezedContacts().soften({&bodies_, &joints_, &contacts_, &friction_, &rolling_}, info);
  }

  /// Presses a body from both sides, and softens what is squeezed.
  void squeeze(int body, int by) {
    add_contact(body, by, {1, 0, 0}, kSpeed);
    add_contact(body, by, {-1, 0, 0}, kSpeed);
    sweep(kSweeps);
    soften();
  }

  /// Of the contacts that give way, N: with nothing in motion. Without the sign of their normals.
  double force(int first, int end) const {
    double sum = 0.0;
    for (int i = first; i < end; ++i) {
      sum += static_cast<double>(contacts_[i].m_rhs / contacts_[i].m_cfm) / kStep;
    }
    return sum;
  }

  bool gives_way(int contact) const { return contacts_[contact].m_cfm > 0; }
  const btSolverConstraint& contact(int i) const { return contacts_[i]; }
  const btSolverBody& body(int i) const { return bodies_[i]; }

 private:
  btSphereShape shape_{1};
  btManifoldPoint point_;
  std::vector<std::unique_ptr<btRigidBody>> originals_;
  btAlignedObjectArray<btSolverBody> bodies_;
  btConstraintArray joints_;
  btConstraintArray contacts_;
  btConstraintArray friction_;
  btConstraintArray rolling_;
};

TEST(SqueezedContacts, GiveWayWithAForceThatGoesWithDepth) {
  Island island;
  const int fixed = island.add_driven();
  const int body = island.add_body(2.0);
  island.squeeze(body, fixed);
  ASSERT_TRUE(island.gives_way(0));
  ASSERT_TRUE(island.gives_way(1));
  // Two contacts of one pair: each takes half of mass * frequency^2 * depth.
  constexpr double kDepth = 1e-3;
  EXPECT_NEAR(island.force(0, 1), 0.5 * 2.0 * kSqueezeFrequency * kSqueezeFrequency * kDepth, 1.0);
  EXPECT_EQ(btScalar(island.contact(0).m_appliedPushImpulse), 0);
  EXPECT_NEAR(static_cast<double>(island.body(body).m_pushVelocity.length()), 0.0, 1e-6);
}

TEST(SqueezedContacts, ForceIsThatOfAPairHoweverManyContactsItHas) {
  const auto force = [](int contacts) {
    Island island;
    const int left = island.add_driven();
    const int right = island.add_fixed();
    const int body = island.add_body(2.0);
    for (int i = 0; i < contacts; ++i) island.add_contact(body, left, {1, 0, 0}, kSpeed);
    // Contacts that hardly touch count for little.
    for (int i = 0; i < contacts; ++i) island.add_contact(body, left, {1, 0, 0}, 1e-3 * kSpeed);
    island.add_contact(body, right, {-1, 0, 0}, kSpeed);
    island.sweep(kSweeps);
    island.soften();
    return island.force(0, 2 * contacts);
  };
  EXPECT_NEAR(force(100) / force(1), 1.0, 1e-3);
}

/// Such a body began there, or has wedged itself in.
TEST(SqueezedContacts, WhatIsBetweenFixedBodiesStaysRigid) {
  Island island;
  const int fixed = island.add_fixed();
  const int body = island.add_body(2.0);
  island.squeeze(body, fixed);
  EXPECT_FALSE(island.gives_way(0));
}

TEST(SqueezedContacts, WhatCanBePushedOutStaysRigid) {
  Island island;
  const int fixed = island.add_driven();
  const int body = island.add_body(2.0);
  island.add_contact(body, fixed, {0, 0, 1}, kSpeed);
  island.sweep(kSweeps);
  const btSolverConstraint before = island.contact(0);
  island.soften();
  EXPECT_FALSE(island.gives_way(0));
  EXPECT_EQ(island.contact(0).m_rhsPenetration, before.m_rhsPenetration);
  EXPECT_EQ(btScalar(island.contact(0).m_appliedPushImpulse),
            btScalar(before.m_appliedPushImpulse));
}

/// Ten sweeps leave the split impulses of both of these far from solved.
TEST(SqueezedContacts, TellsAHeavyLoadFromASqueeze) {
  for (const bool is_squeezed : {false, true}) {
    SCOPED_TRACE(is_squeezed);
    Island island;
    const int fixed = island.add_driven();
    const int light = island.add_body(1.0);
    const int heavy = is_squeezed ? island.add_driven() : island.add_body(1000.0);
    island.add_contact(light, fixed, {0, 0, 1}, kSpeed);
    island.add_contact(heavy, light, {0, 0, 1}, kSpeed);
    island.sweep(kSweeps);
    island.soften();
    EXPECT_EQ(island.gives_way(0), is_squeezed);
    EXPECT_EQ(island.gives_way(1), is_squeezed);
  }
}

TEST(SqueezedContacts, WhatLiesInANarrowGrooveStaysRigid) {
  Island island;
  const int fixed = island.add_driven();
  const int body = island.add_body(1.0);
  const btScalar slope = scalar(1.3);  // of the walls, rad
  island.add_contact(body, fixed, {btSin(slope), 0, btCos(slope)}, kSpeed);
  island.add_contact(body, fixed, {-btSin(slope), 0, btCos(slope)}, kSpeed);
  island.sweep(kSweeps);
  island.soften();
  EXPECT_FALSE(island.gives_way(0));
  EXPECT_FALSE(island.gives_way(1));
}

TEST(SqueezedContacts, LeavesOtherBodiesOfTheIslandRigid) {
  Island island;
  const int fixed = island.add_driven();
  const int squeezed = island.add_body(1.0);
  const int neighbor = island.add_body(1.0);
  island.add_contact(squeezed, fixed, {1, 0, 0}, kSpeed);
  island.add_contact(squeezed, fixed, {-1, 0, 0}, kSpeed);
  island.add_contact(neighbor, fixed, {0, 0, 1}, kSpeed);
  island.sweep(kSweeps);
  island.soften();
  EXPECT_TRUE(island.gives_way(0));
  EXPECT_FALSE(island.gives_way(2));
}

// ---- worlds
// --------------------------------------------------------------------------------------

/// How far cubes in a row of `count` come down, meters, in a second after two kinematic fingers
/// have closed on them, each a millimeter too far.
double slip(int count, int rate) {
  WorldOf<KinematicMotionWorld<>, CoulombSolver> world;
  world.world.getSolverInfo().m_solverMode |=
      SOLVER_USE_2_FRICTION_DIRECTIONS | SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION;
  world.world.getSolverInfo().m_minimumSolverBatchSize = 1;
  constexpr double kHalf = 0.03;
  auto& cube = world.make<btBoxShape>(btVector3(1, 1, 1) * scalar(kHalf));
  const auto x_of = [&](int i) { return (2 * i - count + 1) * kHalf; };
  std::vector<btRigidBody*> bodies;
  for (int i = -1; i <= count; ++i) {
    const bool is_finger = i < 0 || i == count;
    bodies.push_back(&world.add(cube, is_finger ? 0.0 : 0.2, {{}, {x_of(i), 0, 0}}));
    bodies.back()->setFriction(scalar(0.7));
    bodies.back()->setActivationState(DISABLE_DEACTIVATION);
    if (!is_finger) continue;
    bodies.back()->setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
  }
  const auto press = [&](double depth) {
    bodies.front()->getWorldTransform().getOrigin().setX(scalar(x_of(-1) + depth));
    bodies.back()->getWorldTransform().getOrigin().setX(scalar(x_of(count) - depth));
  };
  for (int i = 1; i <= 10; ++i) {
    press(1e-4 * i);
    world.step(1, 1.0 / rate);
  }
  const double before = height(*bodies[1]);
  world.step(rate, 1.0 / rate);
  return before - height(*bodies[1]);
}

TEST(SqueezedContacts, KinematicFingersHoldARow) {
  for (const int rate : {1000, 200, 60, 30}) {
    for (const int count : {1, 3}) {
      SCOPED_TRACE(testing::Message() << count << " at " << rate << " Hz");
      EXPECT_LT(std::abs(slip(count, rate)), 5e-4);
    }
  }
}

}  // namespace
}  // namespace voxshell::bullet::squeezed_contacts_test
