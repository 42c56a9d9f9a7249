#include "braced_contacts.h"

#include <algorithm>
#include <cstddef>

#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "solver_constants.h"

namespace voxshell::bullet {
namespace {

/// Bullet's limit of impulses that have none is 1e30 or 1e18.
constexpr btScalar kEndless = btScalar(1e15);

using Bodies = btAlignedObjectArray<btSolverBody>;

/// Half the diagonal of the body's box, m; endless if it cannot move.
btScalar radius_of(const btSolverBody& body) {
  if (!can_move(body)) return BT_LARGE_FLOAT;
  btVector3 center;
  btScalar radius = 0;
  body.m_originalBody->getCollisionShape()->getBoundingSphere(center, radius);
  return radius;
}

btScalar smaller_radius(const btSolverConstraint& row, const Bodies& bodies) {
  return std::min(radius_of(bodies[row.m_solverBodyIdA]), radius_of(bodies[row.m_solverBodyIdB]));
}

/// The largest impulse of a motor or a spring, N s; 0 of a joint that holds at any force.
btScalar strength_of(const btSolverConstraint& joint, const Bodies& bodies) {
  btScalar impulse = std::max(btFabs(joint.m_lowerLimit), btFabs(joint.m_upperLimit));
  if (joint.m_cfm > 0) impulse = std::min(impulse, btFabs(joint.m_rhs / joint.m_cfm));
  if (!(impulse < kEndless)) return 0;
  return joint.m_contactNormal1.isZero() ? impulse / smaller_radius(joint, bodies) : impulse;
}

/// The sum of what the forces, motors and springs of an island do in the step, N s.
btScalar strength_of(const SolverPools& pools) {
  btScalar sum = 0;
  for (int i = 0; i < pools.bodies->size(); ++i) {
    const btSolverBody& body = (*pools.bodies)[i];
    if (!can_move(body)) continue;
    sum += body.m_externalForceImpulse.length() / body.m_originalBody->getInvMass();
  }
  for (int i = 0; i < pools.joints->size(); ++i) {
    sum += strength_of((*pools.joints)[i], *pools.bodies);
  }
  return sum;
}

}  // namespace

void BracedContacts::find(const SolverPools& pools) {
  contacts_.clear();
  if (pools.joints->size() == 0) return;
  // Bodies that cannot move are one: none of them gives way to another.
  const auto count = static_cast<std::size_t>(pools.bodies->size());
  joined_to_.resize(count + 1);
  for (std::size_t i = 0; i <= count; ++i) {
    joined_to_[i] = i == count || can_move((*pools.bodies)[static_cast<int>(i)]) ? i : count;
  }
  for (int i = 0; i < pools.joints->size(); ++i) {
    const btSolverConstraint& joint = (*pools.joints)[i];
    joined_to_[first_of_group(joint.m_solverBodyIdA)] = first_of_group(joint.m_solverBodyIdB);
  }
  for (int i = 0; i < pools.contacts->size(); ++i) {
    const btSolverConstraint& contact = (*pools.contacts)[i];
    if (first_of_group(contact.m_solverBodyIdA) == first_of_group(contact.m_solverBodyIdB)) {
      contacts_.push_back(i);
    }
  }
}

double BracedContacts::sum_of_impulses(const SolverPools& pools) const {
  double sum = 0.0;
  for (const int i : contacts_) {
    sum += static_cast<double>(btScalar((*pools.contacts)[i].m_appliedImpulse));
  }
  return sum;
}

void BracedContacts::soften(const SolverPools& pools, const btContactSolverInfo& info) const {
  if (contacts_.empty()) return;
  const btScalar strength = strength_of(pools);
  if (!(strength > 0)) return;
  const auto contact_at = [&](int i) -> btSolverConstraint& { return (*pools.contacts)[i]; };
  for (auto begin = contacts_.begin(); begin != contacts_.end();) {
    const auto is_of_others = [&first = contact_at(*begin), &contact_at](int i) {
      return contact_at(i).m_solverBodyIdA != first.m_solverBodyIdA ||
             contact_at(i).m_solverBodyIdB != first.m_solverBodyIdB;
    };
    const auto end = std::find_if(begin, contacts_.end(), is_of_others);
    const auto pressed = std::count_if(
        begin, end, [&](int i) { return btScalar(contact_at(i).m_appliedImpulse) > 0; });
    // Those of two bodies carry together what presses them.
    const btScalar of_one = strength / static_cast<btScalar>(std::max(pressed, std::ptrdiff_t{1}));
    for (; begin != end; ++begin) {
      btSolverConstraint& contact = contact_at(*begin);
      if (contact.m_cfm > 0) continue;  // it gives way already
      const btScalar depth =
          static_cast<btScalar>(kBracedDepth) * smaller_radius(contact, *pools.bodies);
      const btScalar softness =
          contact.m_jacDiagABInv * info.m_erp2 * depth / (info.m_timeStep * of_one);
      const btScalar fraction = 1 / (1 + softness);
      contact.m_rhs *= fraction;
      contact.m_jacDiagABInv *= fraction;
      contact.m_cfm = softness * fraction;
    }
  }
}

std::size_t BracedContacts::first_of_group(int solver_body) {
  auto i = static_cast<std::size_t>(solver_body);
  while (joined_to_[i] != i) {
    joined_to_[i] = joined_to_[joined_to_[i]];
    i = joined_to_[i];
  }
  return i;
}

}  // namespace voxshell::bullet
