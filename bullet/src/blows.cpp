#include "blows.h"

#include <algorithm>

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include "contact_constants.h"

namespace voxshell::bullet {
namespace {

/// Calls visit(a, b, point) for the contacts that the solver sees.
template <class Visit>
void visit_points(btDispatcher& dispatcher, const Visit& visit) {
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
    btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(m);
    auto* const a = const_cast<btCollisionObject*>(manifold.getBody0());
    auto* const b = const_cast<btCollisionObject*>(manifold.getBody1());
    if (manifold.getNumContacts() == 0 || !dispatcher.needsResponse(a, b)) continue;
    btRigidBody* const body_a = btRigidBody::upcast(a);
    btRigidBody* const body_b = btRigidBody::upcast(b);
    if (body_a == nullptr || body_b == nullptr) continue;
    for (int i = 0; i < manifold.getNumContacts(); ++i) {
      visit(*body_a, *body_b, manifold.getContactPoint(i));
    }
  }
}

/// Of the two bodies, one of which may be in none.
int island_of(const btRigidBody& a, const btRigidBody& b) {
  return std::max(a.getIslandTag(), b.getIslandTag());
}

btScalar gap_of(const btManifoldPoint& point) { return std::max(point.getDistance(), btScalar(0)); }

/// How fast the bodies part, m/s.
btScalar speed_apart(const btRigidBody& a, const btRigidBody& b, const btManifoldPoint& point) {
  const btVector3 velocity =
      a.getVelocityInLocalPoint(point.m_positionWorldOnA - a.getCenterOfMassPosition()) -
      b.getVelocityInLocalPoint(point.m_positionWorldOnB - b.getCenterOfMassPosition());
  return velocity.dot(point.m_normalWorldOnB);
}

/// Whether the solver, which began with the velocities that the bodies have, made them part.
bool has_rebounded(const btRigidBody& a, const btRigidBody& b, const btManifoldPoint& point,
                   btScalar time_step) {
  if (!(point.m_appliedImpulse > 0) || !(point.m_combinedRestitution > 0)) return false;
  const btScalar closing = -speed_apart(a, b, point) * time_step;
  return closing > 0 && point.m_combinedRestitution * closing > gap_of(point);
}

}  // namespace

btScalar size_of(const btRigidBody& a, const btRigidBody& b) {
  btScalar size = BT_LARGE_FLOAT;
  for (const btRigidBody* body : {&a, &b}) {
    if (!(body->getInvMass() > 0)) continue;
    size = std::min(size, body->getCollisionShape()->getAngularMotionDisc());
  }
  return size;
}

bool is_passed(const btRigidBody& a, const btRigidBody& b, const btManifoldPoint& point,
               btScalar time_step, double of_size) {
  const btScalar closing = -speed_apart(a, b, point) * time_step;
  return closing > gap_of(point) + static_cast<btScalar>(of_size) * size_of(a, b);
}

void Blows::begin(btDispatcher& dispatcher, btScalar time_step) {
  found_.clear();
  kept_.clear();
  changed_.clear();
  islands_.clear();
  visit_points(dispatcher, [&](btRigidBody& a, btRigidBody& b, btManifoldPoint& point) {
    if (gCalculateCombinedRestitutionCallback(&a, &b) > 0) let_part(a, b, point, time_step);
  });
}

void Blows::find(btDispatcher& dispatcher, std::span<btRigidBody* const> faster,
                 btScalar time_step) {
  const auto is_faster = [&](const btRigidBody& body) {
    return std::ranges::binary_search(faster, &body);
  };
  found_.clear();
  islands_.clear();
  for (const Blow& blow : kept_) islands_.push_back(island_of(*blow.a, *blow.b));
  visit_points(dispatcher,
               [&](const btRigidBody& a, const btRigidBody& b, const btManifoldPoint& point) {
                 if (!has_rebounded(a, b, point, time_step)) return;
                 if (is_faster(a) || is_faster(b)) islands_.push_back(island_of(a, b));
               });
  if (islands_.empty()) return;
  std::ranges::sort(islands_);
  visit_points(dispatcher, [&](btRigidBody& a, btRigidBody& b, btManifoldPoint& point) {
    if (!std::ranges::binary_search(islands_, island_of(a, b))) return;
    found_.push_back({&a, &b, &point, point.m_appliedImpulse, point.m_appliedImpulseLateral1,
                      point.m_appliedImpulseLateral2});
  });
}

bool Blows::restore(btScalar time_step) {
  give_back();
  const bool has_come_back = std::ranges::any_of(changed_, [&](const Changed& changed) {
    return is_passed(*changed.a, *changed.b, *changed.point, time_step, kReturnedOfSize);
  });
  changed_.clear();
  return has_come_back;
}

void Blows::keep(btDispatcher& dispatcher, btScalar time_step) {
  for (const Blow& blow : found_) let_return(blow, time_step);
  // What was found after the solution, too.
  visit_points(dispatcher, [&](btRigidBody& a, btRigidBody& b, btManifoldPoint& point) {
    if (reach(a) || reach(b)) let_part(a, b, point, time_step);
  });
  for (const Blow& blow : found_) {
    blow.point->m_appliedImpulse = 0;
    blow.point->m_appliedImpulseLateral1 = 0;
    blow.point->m_appliedImpulseLateral2 = 0;
  }
  kept_.insert(kept_.end(), found_.begin(), found_.end());
}

/// Lets bodies rebound that have come back through their gap. Others only stop at each other: the
/// contact's restitution is for the approach from before the step.
void Blows::let_return(const Blow& blow, btScalar time_step) {
  btManifoldPoint& point = *blow.point;
  const btScalar closing = -speed_apart(*blow.a, *blow.b, point) * time_step;
  if (!(closing > 0)) return;
  changed_.push_back({blow.a, blow.b, &point, point.getDistance(), point.m_combinedRestitution});
  const btScalar gap = gap_of(point);
  const btScalar restitution = gCalculateCombinedRestitutionCallback(blow.a, blow.b);
  point.m_combinedRestitution = closing > gap ? restitution + gap / closing : btScalar(0);
}

/// Lets bodies that part come back, and faster.
void Blows::let_part(const btRigidBody& a, const btRigidBody& b, btManifoldPoint& point,
                     btScalar time_step) {
  const btScalar opening = speed_apart(a, b, point) * time_step;
  if (!(opening > 0)) return;
  changed_.push_back({&a, &b, &point, point.getDistance(), point.m_combinedRestitution});
  point.setDistance(gap_of(point) + static_cast<btScalar>(kReturnOfParting) * opening);
}

void Blows::give_back() {
  for (const Changed& changed : changed_) {
    changed.point->setDistance(changed.distance);
    changed.point->m_combinedRestitution = changed.restitution;
  }
}

void Blows::stop(btDispatcher& dispatcher) {
  give_back();
  changed_.clear();
  visit_points(dispatcher, [&](btRigidBody& a, btRigidBody& b, btManifoldPoint& point) {
    if (!reach(a) && !reach(b)) return;
    changed_.push_back({&a, &b, &point, point.getDistance(), point.m_combinedRestitution});
    point.m_combinedRestitution = 0;
  });
}

bool Blows::reach(const btRigidBody& body) const {
  return std::ranges::binary_search(islands_, body.getIslandTag());
}

void Blows::finish() {
  give_back();
  for (const Blow& blow : kept_) {
    blow.point->m_appliedImpulse += blow.normal;
    blow.point->m_appliedImpulseLateral1 += blow.lateral_1;
    blow.point->m_appliedImpulseLateral2 += blow.lateral_2;
  }
}

}  // namespace voxshell::bullet
