#pragma once

#include <unordered_map>

#include <BulletCollision/CollisionShapes/btCollisionShape.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace voxshell::bullet {

/// Whether a body of that radius is at another place, as far as sleeping is concerned: some point
/// of it has moved by more than a two hundredth of the radius.
bool has_moved(const btTransform& from, const btTransform& to, btScalar radius);

/// A Bullet dynamics world in which bodies fall asleep only if they stay where they are.
///
/// Bullet lets bodies sleep after two seconds below 0.8 m/s and 1 rad/s: a cube that slides without
/// friction stops, and so does a pendulum at its turning point. It also lets a body that wakes with
/// its island sleep again as soon as the others have left: knocked out from under another, a cube
/// leaves it in midair. In this world, the two seconds start again whenever a body moves or wakes.
/// docs/decisions/0048-sleep-is-rest.md.
template <class World = btDiscreteDynamicsWorld>
class SleepyWorld : public World {
 public:
  using World::World;

  void removeRigidBody(btRigidBody* body) override {
    places_.erase(body);
    World::removeRigidBody(body);
  }

 protected:
  void updateActivationState(btScalar time_step) override {
    for (int i = 0; i < this->m_nonStaticRigidBodies.size(); ++i) {
      btRigidBody& body = *this->m_nonStaticRigidBodies[i];
      if (body.getActivationState() == ISLAND_SLEEPING) continue;
      if (moves(body)) body.setDeactivationTime(0);
      if (body.getActivationState() == WANTS_DEACTIVATION &&
          body.getDeactivationTime() < gDeactivationTime) {
        body.setActivationState(ACTIVE_TAG);
      }
    }
    World::updateActivationState(time_step);
  }

 private:
  bool moves(const btRigidBody& body) {
    const btTransform& here = body.getWorldTransform();
    const auto [place, is_new] = places_.try_emplace(&body, here);
    btVector3 center;
    btScalar radius = 0;
    body.getCollisionShape()->getBoundingSphere(center, radius);
    if (is_new || !has_moved(place->second, here, radius)) return is_new;
    place->second = here;
    return true;
  }

  /// Where bodies were when their time of rest began.
  std::unordered_map<const btRigidBody*, btTransform> places_;
};

}  // namespace voxshell::bullet
