#pragma once

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

#include "voxshell/bullet/seams.h"

namespace voxshell::bullet {

/// A Bullet dynamics world in which bodies slide over the seams of flush bodies.
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
