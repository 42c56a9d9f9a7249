#include "voxshell/bullet/carried_contacts.h"

#include <cstddef>
#include <optional>

#include "compound_algorithm.h"

namespace voxshell::bullet {
namespace {

/// Negative for objects that are in no world.
int id_of(const btCollisionObject& object) {
  const btBroadphaseProxy* const proxy = object.getBroadphaseHandle();
  return proxy != nullptr ? proxy->m_uniqueId : -1;
}

}  // namespace

void CarriedContacts::renew(btDispatcher& dispatcher, const btCollisionObjectArray& objects) {
  for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
    btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(i);
    if (manifold.getNumContacts() == 0) continue;
    const btCollisionObject& a = *manifold.getBody0();
    const btCollisionObject& b = *manifold.getBody1();
    if (has_model(*a.getCollisionShape()) || has_model(*b.getCollisionShape())) continue;
    turn(manifold);
    manifold.refreshContactPoints(a.getWorldTransform(), b.getWorldTransform());
  }
  known_.resize(static_cast<std::size_t>(objects.size()));
  for (int i = 0; i < objects.size(); ++i) {
    known_[static_cast<std::size_t>(i)] = {id_of(*objects[i]),
                                           objects[i]->getWorldTransform().getBasis()};
  }
}

/// How a body has turned since the last call; null where that is not known, or not at all.
std::optional<btMatrix3x3> CarriedContacts::turn_of(const btCollisionObject& body) const {
  const auto place = static_cast<std::size_t>(body.getWorldArrayIndex());
  if (place >= known_.size() || known_[place].id != id_of(body)) return std::nullopt;
  const btMatrix3x3& basis = body.getWorldTransform().getBasis();
  if (basis == known_[place].basis) return std::nullopt;
  return basis * known_[place].basis.transpose();
}

void CarriedContacts::turn(btPersistentManifold& manifold) const {
  const auto of_a = turn_of(*manifold.getBody0());
  const auto of_b = turn_of(*manifold.getBody1());
  if (!of_a || !of_b) return;
  // The trace is 1 plus twice the cosine of the angle.
  const auto trace = [](const btMatrix3x3& m) { return m[0][0] + m[1][1] + m[2][2]; };
  const btMatrix3x3& turned = trace(*of_a) >= trace(*of_b) ? *of_a : *of_b;
  for (int i = 0; i < manifold.getNumContacts(); ++i) {
    btVector3& normal = manifold.getContactPoint(i).m_normalWorldOnB;
    normal = (turned * normal).normalized();
  }
}

}  // namespace voxshell::bullet
