#pragma once

#include <algorithm>

#include <BulletCollision/CollisionDispatch/btCollisionWorld.h>

namespace voxshell::bullet::test_support {

/// The greatest depth that a contact test reports, meters; -1 where there is no contact.
struct DeepestResult : btCollisionWorld::ContactResultCallback {
  btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper*, int, int,
                           const btCollisionObjectWrapper*, int, int) override {
    depth = std::max(depth, -static_cast<double>(point.getDistance()));
    ++count;
    return 0;
  }
  double depth = -1.0;
  int count = 0;
};

}  // namespace voxshell::bullet::test_support
