#include "support.h"

#include <cstddef>

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "voxshell/bullet/convert.h"

namespace voxshell::bullet {

void Support::read(btDispatcher& dispatcher) {
  pushes_.clear();
  for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
    const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(m);
    for (int i = 0; i < manifold.getNumContacts(); ++i) {
      const btManifoldPoint& point = manifold.getContactPoint(i);
      const btVector3 impulse = point.m_appliedImpulse * point.m_normalWorldOnB +
                                point.m_appliedImpulseLateral1 * point.m_lateralFrictionDir1 +
                                point.m_appliedImpulseLateral2 * point.m_lateralFrictionDir2;
      add(*manifold.getBody0(), impulse, point.getPositionWorldOnA());
      add(*manifold.getBody1(), -impulse, point.getPositionWorldOnB());
    }
  }
}

void Support::add(const btCollisionObject& body, const btVector3& impulse, const btVector3& at) {
  const btRigidBody* const rigid = btRigidBody::upcast(&body);
  if (rigid == nullptr || !(rigid->getInvMass() > 0) || body.getWorldArrayIndex() < 0) return;
  const auto place = static_cast<std::size_t>(body.getWorldArrayIndex());
  if (place >= pushes_.size()) pushes_.resize(place + 1);
  Push& push = pushes_[place];
  const btVector3 torque = (at - rigid->getCenterOfMassPosition()).cross(impulse);
  push.velocity = push.velocity + from_bullet(rigid->getInvMass() * impulse);
  push.load += static_cast<double>(rigid->getInvMass() * impulse.length());
  push.angular_velocity =
      push.angular_velocity + from_bullet(rigid->getInvInertiaTensorWorld() * torque);
}

Support::Push Support::of(const btCollisionObject& body) const {
  const auto place = static_cast<std::size_t>(body.getWorldArrayIndex());
  return place < pushes_.size() ? pushes_[place] : Push{};
}

}  // namespace voxshell::bullet
