#pragma once

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionShapes/btCollisionShape.h>

#include "voxshell/bullet/convert.h"

namespace voxshell::bullet {

/// World frame.
struct Ball {
  Vec3 centre;
  double radius;  ///< metres

  /// About all of the object, as its shape says.
  static Ball about(const btCollisionObjectWrapper& wrap) {
    btVector3 centre;
    btScalar radius = 0;
    wrap.getCollisionShape()->getBoundingSphere(centre, radius);
    return {from_bullet(wrap.getWorldTransform() * centre), static_cast<double>(radius)};
  }
};

}  // namespace voxshell::bullet
