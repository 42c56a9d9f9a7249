#include "voxshell/bullet/carried_normals.h"

#include <cstddef>

#include "compound_algorithm.h"

namespace voxshell::bullet {
namespace {

/// Negative for objects that are in no world.
int id_of(const btCollisionObject& object) {
  const btBroadphaseProxy* const proxy = object.getBroadphaseHandle();
  return proxy != nullptr ? proxy->m_uniqueId : -1;
}

}  // namespace

void CarriedNormals::carry(btDispatcher& dispatcher, const btCollisionObjectArray& objects) {
  for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
    turn(*dispatcher.getManifoldByIndexInternal(i));
  }
  known_.resize(static_cast<std::size_t>(objects.size()));
  for (int i = 0; i < objects.size(); ++i) {
    known_[static_cast<std::size_t>(i)] = {id_of(*objects[i]),
                                           objects[i]->getWorldTransform().getBasis()};
  }
}

void CarriedNormals::turn(btPersistentManifold& manifold) const {
  const btCollisionObject& body = *manifold.getBody1();
  const auto place = static_cast<std::size_t>(body.getWorldArrayIndex());
  if (manifold.getNumContacts() == 0 || place >= known_.size()) return;
  const Known& known = known_[place];
  const btMatrix3x3& basis = body.getWorldTransform().getBasis();
  if (known.id != id_of(body) || known.basis == basis) return;
  if (has_model(*body.getCollisionShape()) || has_model(*manifold.getBody0()->getCollisionShape()))
    return;
  const btMatrix3x3 turned = basis * known.basis.transpose();
  for (int i = 0; i < manifold.getNumContacts(); ++i) {
    btVector3& normal = manifold.getContactPoint(i).m_normalWorldOnB;
    normal = (turned * normal).normalized();
  }
}

}  // namespace voxshell::bullet
