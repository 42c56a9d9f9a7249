#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>

namespace voxshell::bullet {

/// A shape of an object at a pose, as Bullet's algorithms take it. It refers to all three.
inline btCollisionObjectWrapper wrap_object(const btCollisionObject& object,
                                            const btCollisionShape& shape,
                                            const btTransform& world_from_shape) {
  return {nullptr, &shape, &object, world_from_shape, -1, -1};
}

/// An object where it is.
inline btCollisionObjectWrapper wrap_object(const btCollisionObject& object) {
  return wrap_object(object, *object.getCollisionShape(), object.getWorldTransform());
}

}  // namespace voxshell::bullet
