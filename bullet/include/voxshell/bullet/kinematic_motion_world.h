#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace voxshell::bullet {

/// A Bullet dynamics world in which kinematic bodies move during a step, as dynamic bodies do.
///
/// Bullet puts a kinematic body at its new pose before it searches for contacts, and gives it the
/// velocity of the displacement that lies behind it. What touches it then moves on by the same
/// displacement: cargo hovers over a lift that rises at 1 m/s by 17 mm at 60 Hz, and enters a
/// floor that descends. In this world, a kinematic body is where it was when contacts are searched
/// and solved, has the velocity that takes it to its new pose, and is there at the end of the step.
/// docs/decisions/0055-kinematic-bodies-move-during-the-step.md.
template <class World = btDiscreteDynamicsWorld>
class KinematicMotionWorld : public World {
 public:
  using World::World;

  void removeRigidBody(btRigidBody* body) override {
    std::erase_if(moves_, [&](const Move& move) { return move.body == body; });
    World::removeRigidBody(body);
  }

  void updateAabbs() override {
    World::updateAabbs();
    for (const Move& move : moves_) cover(move);
  }

 protected:
  void saveKinematicState(btScalar seconds) override {
    moves_.clear();
    for (int i = 0; i < this->m_collisionObjects.size(); ++i) {
      btRigidBody* const body = btRigidBody::upcast(this->m_collisionObjects[i]);
      if (body == nullptr || !body->isKinematicObject() ||
          body->getActivationState() == ISLAND_SLEEPING) {
        continue;
      }
      moves_.push_back({body, body->getInterpolationWorldTransform(), seconds});
    }
    World::saveKinematicState(seconds);
    for (Move& move : moves_) {
      const btTransform start = std::exchange(move.end, move.body->getWorldTransform());
      place(*move.body, start);
    }
    std::erase_if(moves_,
                  [](const Move& move) { return move.end == move.body->getWorldTransform(); });
  }

  void integrateTransforms(btScalar time_step) override {
    World::integrateTransforms(time_step);
    for (Move& move : moves_) {
      btTransform there = move.end;
      if (!move.ends_within(time_step)) move.body->predictIntegratedTransform(time_step, there);
      place(*move.body, there);
    }
    std::erase_if(moves_, [&](const Move& move) { return move.ends_within(time_step); });
    for (Move& move : moves_) move.seconds_left -= time_step;
  }

 private:
  struct Move {
    btRigidBody* body;
    btTransform end;  ///< while velocities are computed, where it was
    btScalar seconds_left;

    /// Up to rounding.
    bool ends_within(btScalar seconds) const { return seconds_left < btScalar(1.5) * seconds; }
  };

  static void place(btRigidBody& body, const btTransform& world_from_body) {
    body.setWorldTransform(world_from_body);
    body.setInterpolationWorldTransform(world_from_body);
  }

  /// Lets the body be found along all of its displacement.
  void cover(const Move& move) {
    const btCollisionShape& shape = *move.body->getCollisionShape();
    btVector3 low, high, low_of_end, high_of_end, center;
    btScalar radius = 0;
    shape.getAabb(move.body->getWorldTransform(), low, high);
    shape.getAabb(move.end, low_of_end, high_of_end);
    low.setMin(low_of_end);
    high.setMax(high_of_end);
    // A point that turns is off the chord of its arc.
    shape.getBoundingSphere(center, radius);
    const btScalar turn = move.body->getAngularVelocity().length() * move.seconds_left;
    const btScalar off =
        (center.length() + radius) * (1 - std::cos(std::min(btScalar(0.5) * turn, SIMD_PI)));
    const btScalar margin = off + gContactBreakingThreshold;
    this->getBroadphase()->setAabb(move.body->getBroadphaseHandle(),
                                   low - btVector3(margin, margin, margin),
                                   high + btVector3(margin, margin, margin), this->getDispatcher());
  }

  std::vector<Move> moves_;  ///< not yet at their ends
};

}  // namespace voxshell::bullet
