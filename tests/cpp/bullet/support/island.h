#pragma once

#include <memory>
#include <vector>

#include <btBulletDynamicsCommon.h>
#include <gtest/gtest.h>

#include "island_problem.h"
#include "support/world.h"
#include "voxshell/bullet/convert.h"

namespace voxshell::bullet::test_support {

inline constexpr double kFall = 0.1;  ///< m/s, by which contacts close

/// Bodies and rows as Bullet's solver sets them up for an island.
class Island {
 public:
  int add_body(double mass, const Vec3& inertia = {1, 1, 1}, const Matrix3& rotation = {}) {
    btRigidBody::btRigidBodyConstructionInfo info(scalar(mass), nullptr, nullptr,
                                                  to_bullet(inertia));
    info.m_startWorldTransform = to_bullet(Pose{rotation, {}});
    originals_.push_back(std::make_unique<btRigidBody>(info));
    btSolverBody& body = bodies_.expandNonInitializing();
    body.m_originalBody = originals_.back().get();
    body.internalSetInvMass(btVector3(1, 1, 1) * originals_.back()->getInvMass());
    body.m_linearFactor.setValue(1, 1, 1);
    body.m_angularFactor.setValue(1, 1, 1);
    body.internalGetDeltaLinearVelocity().setZero();
    body.internalGetDeltaAngularVelocity().setZero();
    return bodies_.size() - 1;
  }

  /// A row along a direction, at the end of a lever from a's center, and the velocity that it is to
  /// add.
  btSolverConstraint& add_row(btConstraintArray& rows, int a, int b, const Vec3& along,
                              double target, const Vec3& lever_a = {}) {
    return add_row(rows, a, b, along, -along, cross(lever_a, along), {}, target);
  }
  btSolverConstraint& add_joint(int a, int b, const Vec3& along, double target) {
    return add_row(joints, a, b, along, target);
  }
  btSolverConstraint& add_contact(int a, int b, double friction = 0.0) {
    btSolverConstraint& row = add_row(contacts, a, b, {0, 0, 1}, kFall);
    row.m_friction = scalar(friction);
    row.m_frictionIndex = friction_.size();
    return row;
  }
  /// Of the last contact, in one direction.
  void add_friction(int a, int b, const Vec3& along, double sliding) {
    btSolverConstraint& row = add_row(friction_, a, b, along, -sliding);
    row.m_friction = contacts[contacts.size() - 1].m_friction;
  }
  /// Of the last contact, about an axis.
  void add_rolling(int a, int b, const Vec3& axis, double turning, double lever) {
    btSolverConstraint& row = add_row(rolling, a, b, {}, {}, axis, -axis, -turning);
    row.m_friction = scalar(lever);
    row.m_frictionIndex = contacts.size() - 1;
  }

  SolverPools pools() { return {&bodies_, &joints, &contacts, &friction_, &rolling}; }
  bool pays() { return problem_.prepare(pools()); }
  bool is_small() const { return problem_.is_small(); }
  double error() {
    problem_.prepare(pools());
    return problem_.error(pools());
  }
  void solve(int times, IslandProblem::Sliding sliding = IslandProblem::Sliding::kCorrected) {
    ASSERT_TRUE(problem_.prepare(pools()));
    for (int i = 0; i < times; ++i) ASSERT_TRUE(problem_.solve(pools(), 1e4, sliding));
  }

  static double impulse_of(const btSolverConstraint& row) {
    return static_cast<double>(btScalar(row.m_appliedImpulse));
  }
  Vec3 velocity(int body) { return from_bullet(bodies_[body].internalGetDeltaLinearVelocity()); }
  Vec3 turning(int body) { return from_bullet(bodies_[body].internalGetDeltaAngularVelocity()); }

  btConstraintArray joints;
  btConstraintArray contacts;
  btConstraintArray rolling;

 private:
  btSolverConstraint& add_row(btConstraintArray& rows, int a, int b, const Vec3& linear_a,
                              const Vec3& linear_b, const Vec3& angular_a, const Vec3& angular_b,
                              double target) {
    btSolverConstraint& row = rows.expandNonInitializing();
    row.m_solverBodyIdA = a;
    row.m_solverBodyIdB = b;
    row.m_contactNormal1 = to_bullet(linear_a);
    row.m_contactNormal2 = to_bullet(linear_b);
    row.m_relpos1CrossNormal = to_bullet(angular_a);
    row.m_relpos2CrossNormal = to_bullet(angular_b);
    const btRigidBody& of_a = *bodies_[a].m_originalBody;
    const btRigidBody& of_b = *bodies_[b].m_originalBody;
    row.m_angularComponentA = of_a.getInvInertiaTensorWorld() * row.m_relpos1CrossNormal;
    row.m_angularComponentB = of_b.getInvInertiaTensorWorld() * row.m_relpos2CrossNormal;
    const btScalar answer = row.m_contactNormal1.length2() * of_a.getInvMass() +
                            row.m_contactNormal2.length2() * of_b.getInvMass() +
                            row.m_relpos1CrossNormal.dot(row.m_angularComponentA) +
                            row.m_relpos2CrossNormal.dot(row.m_angularComponentB);
    row.m_jacDiagABInv = answer > 0 ? 1 / answer : btScalar(0);
    row.m_rhs = scalar(target) * row.m_jacDiagABInv;
    row.m_cfm = 0;
    row.m_appliedImpulse = 0;
    row.m_friction = 0;
    row.m_lowerLimit = scalar(-1e10);
    row.m_upperLimit = scalar(1e10);
    return row;
  }

  IslandProblem problem_;
  std::vector<std::unique_ptr<btRigidBody>> originals_;
  btAlignedObjectArray<btSolverBody> bodies_;
  btConstraintArray friction_;
};

}  // namespace voxshell::bullet::test_support
