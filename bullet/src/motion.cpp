#include "motion.h"

#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>
#include <LinearMath/btAlignedObjectArray.h>

#include "voxshell/bullet/convert.h"

namespace voxshell::bullet {
namespace {

Motion of_link(const btMultiBodyLinkCollider& collider) {
  const btMultiBody& body = *collider.m_multiBody;
  btAlignedObjectArray<btVector3> angular;
  btAlignedObjectArray<btVector3> linear;
  angular.resize(body.getNumLinks() + 1);
  linear.resize(body.getNumLinks() + 1);
  body.compTreeLinkVelocities(&angular[0], &linear[0]);
  const btTransform& world_from_link = collider.getWorldTransform();
  const int link = collider.m_link + 1;  // the base is the first
  return {from_bullet(world_from_link.getOrigin()),
          from_bullet(world_from_link.getBasis() * linear[link]),
          from_bullet(world_from_link.getBasis() * angular[link]),
          {},
          0.0};
}

}  // namespace

Motion Motion::of(const btCollisionObject& object, double time_step) {
  if (const auto* collider = btMultiBodyLinkCollider::upcast(&object)) {
    if (collider->m_multiBody != nullptr) return of_link(*collider);
  }
  const btRigidBody* body = btRigidBody::upcast(&object);
  if (body == nullptr) return {};
  const auto inverse_mass = static_cast<double>(body->getInvMass());
  return {from_bullet(body->getCenterOfMassPosition()), from_bullet(body->getLinearVelocity()),
          from_bullet(body->getAngularVelocity()),
          time_step * inverse_mass * from_bullet(body->getTotalForce()), inverse_mass};
}

}  // namespace voxshell::bullet
