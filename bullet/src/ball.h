#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>

#include "voxshell/bullet/convert.h"

namespace voxshell::bullet {

/// World frame.
struct Ball {
  Vec3 center;
  double radius;  ///< meters

  /// About all of the object, as its shape says.
  static Ball about(const btCollisionObjectWrapper& wrap) {
    const btCollisionShape& shape = *wrap.getCollisionShape();
    btVector3 center;
    btScalar radius = 0;
    shape.getBoundingSphere(center, radius);
    // That of its box.
    if (shape.getShapeType() == SPHERE_SHAPE_PROXYTYPE) {
      radius = static_cast<const btSphereShape&>(shape).getRadius();
    }
    return {from_bullet(wrap.getWorldTransform() * center), static_cast<double>(radius)};
  }
};

}  // namespace voxshell::bullet
