#include "squeezed_contacts.h"

#include <algorithm>

#include <BulletCollision/NarrowPhaseCollision/btManifoldPoint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "solver_constants.h"

namespace voxshell::bullet {
namespace {

btScalar split_impulse(const btSolverConstraint& contact) {
  return btScalar(contact.m_appliedPushImpulse);
}

/// Whether the user moves the body.
bool is_driven(const btSolverBody& body) {
  return body.m_originalBody != nullptr && body.m_originalBody->isKinematicObject();
}

bool has_driven_body(const SolverPools& pools) {
  for (int i = 0; i < pools.bodies->size(); ++i) {
    if (is_driven((*pools.bodies)[i])) return true;
  }
  return false;
}

/// m/s, along the normal.
btScalar split_velocity(const btSolverConstraint& contact) {
  return contact.m_jacDiagABInv > 0 ? contact.m_rhsPenetration / contact.m_jacDiagABInv
                                    : btScalar(0);
}

/// One past the last of the contacts from `begin` on that are of the same bodies.
int end_of_pair(const btConstraintArray& contacts, int begin) {
  int end = begin;
  while (end < contacts.size() &&
         contacts[end].m_solverBodyIdA == contacts[begin].m_solverBodyIdA &&
         contacts[end].m_solverBodyIdB == contacts[begin].m_solverBodyIdB) {
    ++end;
  }
  return end;
}

/// Over how many equally deep contacts the force between two bodies would be spread. Depth goes
/// with the velocity of split impulses.
btScalar spread_of(const btConstraintArray& contacts, int begin, int end) {
  btScalar sum = 0;
  btScalar sum_of_squares = 0;
  for (int i = begin; i < end; ++i) {
    const btScalar velocity = split_velocity(contacts[i]);
    sum += velocity;
    sum_of_squares += velocity * velocity;
  }
  return sum_of_squares > 0 ? sum * sum / sum_of_squares : btScalar(1);
}

/// Takes the contact's split impulse from both bodies.
void release(btSolverConstraint& contact, btSolverBody& a, btSolverBody& b) {
  const btScalar impulse = split_impulse(contact);
  a.internalApplyPushImpulse(contact.m_contactNormal1 * a.internalGetInvMass(),
                             contact.m_angularComponentA, -impulse);
  b.internalApplyPushImpulse(contact.m_contactNormal2 * b.internalGetInvMass(),
                             contact.m_angularComponentB, -impulse);
  contact.m_appliedPushImpulse = 0;
}

/// Lets the contact aim at a fraction of the velocity of its split impulse, and give way by
/// `softness` times the velocity that its impulse would give it.
void soften(btSolverConstraint& contact, btScalar aim, btScalar softness) {
  const btScalar fraction = 1 / (1 + softness);
  contact.m_rhs = (contact.m_rhs + aim * contact.m_rhsPenetration) * fraction;
  contact.m_rhsPenetration = 0;
  contact.m_jacDiagABInv *= fraction;
  contact.m_cfm = softness * fraction;
}

/// Lets friction compare velocities at one place. Bullet does so at the surfaces of both bodies,
/// which are apart by the depth: bodies that turn together seem to slide.
void share_place(const SolverPools& pools, const btSolverConstraint& contact) {
  const auto& point = *static_cast<const btManifoldPoint*>(contact.m_originalContactPoint);
  const btSolverBody& a = (*pools.bodies)[contact.m_solverBodyIdA];
  const btSolverBody& b = (*pools.bodies)[contact.m_solverBodyIdB];
  const btVector3 change =
      btScalar(0.5) * (a.m_angularVelocity + b.m_angularVelocity)
                          .cross(point.m_positionWorldOnB - point.m_positionWorldOnA);
  const int rows = pools.friction->size() / pools.contacts->size();
  for (int i = 0; i < rows; ++i) {
    btSolverConstraint& row = (*pools.friction)[contact.m_frictionIndex + i];
    row.m_rhs -= row.m_contactNormal1.dot(change) * row.m_jacDiagABInv;
  }
}

}  // namespace

void SqueezedContacts::soften(const SolverPools& pools, const btContactSolverInfo& info) {
  if (!has_driven_body(pools)) return;
  join_bodies(pools);
  sum_contacts(pools);
  sum_bodies(pools);
  const btScalar angle = static_cast<btScalar>(kSqueezeFrequency) * info.m_timeStep;
  const btScalar aim =
      std::min(static_cast<btScalar>(kSqueezeRate) * info.m_timeStep / info.m_erp2, btScalar(1));
  const btScalar softness = aim * info.m_erp2 / (angle * angle);
  for (int i = 0; i < pools.contacts->size();) {
    const btSolverConstraint& first = (*pools.contacts)[i];
    const int a = first.m_solverBodyIdA;
    const int b = first.m_solverBodyIdB;
    const int end = end_of_pair(*pools.contacts, i);
    if (!is_squeezed(a, pools) && !is_squeezed(b, pools)) {
      i = end;
      continue;
    }
    const btScalar spread = spread_of(*pools.contacts, i, end);
    for (; i < end; ++i) {
      btSolverConstraint& contact = (*pools.contacts)[i];
      release(contact, (*pools.bodies)[a], (*pools.bodies)[b]);
      bullet::soften(contact, aim, spread * softness);
      share_place(pools, contact);
    }
  }
}

void SqueezedContacts::join_bodies(const SolverPools& pools) {
  bodies_.clear();
  for (std::size_t i = 0; i < static_cast<std::size_t>(pools.bodies->size()); ++i) {
    bodies_.push_back({.joined_to = i});
  }
  for (int i = 0; i < pools.contacts->size(); ++i) {
    const btSolverConstraint& contact = (*pools.contacts)[i];
    const int a = contact.m_solverBodyIdA;
    const int b = contact.m_solverBodyIdB;
    if (!(split_impulse(contact) > 0) || !can_move((*pools.bodies)[a]) ||
        !can_move((*pools.bodies)[b])) {
      continue;
    }
    bodies_[first_of_group(a)].joined_to = first_of_group(b);
  }
}

void SqueezedContacts::sum_contacts(const SolverPools& pools) {
  for (int i = 0; i < pools.contacts->size(); ++i) {
    const btSolverConstraint& contact = (*pools.contacts)[i];
    const btScalar impulse = split_impulse(contact);
    if (!(impulse > 0)) continue;
    const auto add = [&](int solver_body, const btVector3& linear, const btVector3& angular) {
      const btSolverBody& source = (*pools.bodies)[solver_body];
      if (!can_move(source)) return false;
      Body& body = bodies_[static_cast<std::size_t>(solver_body)];
      body.work +=
          impulse * (linear.dot(source.m_pushVelocity) + angular.dot(source.m_turnVelocity));
      return true;
    };
    const int a = contact.m_solverBodyIdA;
    const int b = contact.m_solverBodyIdB;
    const bool moves_a = add(a, contact.m_contactNormal1, contact.m_relpos1CrossNormal);
    const bool moves_b = add(b, contact.m_contactNormal2, contact.m_relpos2CrossNormal);
    Group& group = bodies_[first_of_group(moves_a ? a : b)].group;
    group.asked += impulse * split_velocity(contact);
    if (!moves_a || !moves_b) group.support += impulse;
    if (is_driven((*pools.bodies)[a]) || is_driven((*pools.bodies)[b])) group.is_driven = true;
  }
}

void SqueezedContacts::sum_bodies(const SolverPools& pools) {
  for (int i = 0; i < pools.bodies->size(); ++i) {
    const btSolverBody& source = (*pools.bodies)[i];
    if (!can_move(source)) continue;
    const btScalar work = std::max(bodies_[static_cast<std::size_t>(i)].work, btScalar(0));
    Group& group = bodies_[first_of_group(i)].group;
    group.done += work;
    group.momentum += btSqrt(work / source.m_originalBody->getInvMass());
  }
}

std::size_t SqueezedContacts::first_of_group(int solver_body) {
  auto i = static_cast<std::size_t>(solver_body);
  while (bodies_[i].joined_to != i) {
    bodies_[i].joined_to = bodies_[bodies_[i].joined_to].joined_to;
    i = bodies_[i].joined_to;
  }
  return i;
}

bool SqueezedContacts::is_squeezed(int solver_body, const SolverPools& pools) {
  if (!can_move((*pools.bodies)[solver_body])) return false;
  const Group& group = bodies_[first_of_group(solver_body)].group;
  return group.is_driven && group.done < static_cast<btScalar>(kSqueezedWork) * group.asked &&
         group.momentum < static_cast<btScalar>(kSqueezedMomentum) * group.support;
}

}  // namespace voxshell::bullet
