#pragma once

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include "voxshell/bullet/seams.h"

namespace voxshell::bullet {

/// A dynamics world of Bullet's in which bodies slide over the seams of others that lie flush.
template <class World = btDiscreteDynamicsWorld>
class SeamlessWorld : public World {
 public:
  using World::World;

  void performDiscreteCollisionDetection() override {
    World::performDiscreteCollisionDetection();
    seams_.correct(*this->getDispatcher(), static_cast<double>(this->getDispatchInfo().m_timeStep));
  }

 private:
  Seams seams_;
};

}  // namespace voxshell::bullet
