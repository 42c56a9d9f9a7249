#pragma once

#include <vector>

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include "voxshell/pose.h"

namespace voxshell::bullet {

/// What contacts did to the velocities of bodies in the last step. A body that lies on something
/// does not fall in the next step either, but a pair of bodies cannot tell: what supports the body
/// may be a third one. Decision 59.
class Support {
 public:
  /// Reads the impulses that a dispatcher's manifolds have from the last step, before the contacts
  /// of this one replace them.
  void read(btDispatcher& dispatcher);

  /// What a body of the dispatcher's world got from its contacts, without rolling friction. World
  /// frame.
  struct Push {
    Vec3 velocity;          ///< m/s
    Vec3 angular_velocity;  ///< rad/s
    double load = 0.0;  ///< the sum of what all contacts gave alone, whatever its direction, m/s
  };
  Push of(const btCollisionObject& body) const;

 private:
  void add(const btCollisionObject& body, const btVector3& impulse, const btVector3& at);

  std::vector<Push> pushes_;  ///< by the bodies' places in their world
};

}  // namespace voxshell::bullet
