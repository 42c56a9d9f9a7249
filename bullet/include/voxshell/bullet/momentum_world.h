#pragma once

#include <vector>

#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "voxshell/bullet/free_rotation.h"

namespace voxshell::bullet {

/// A Bullet dynamics world in which bodies keep their angular momentum while they turn.
///
/// Bullet keeps the angular velocity instead and adds the gyroscopic torque by an implicit step,
/// which damps: a body that tumbles at 2 rad/s loses half of its energy in 30 s at 1 kHz. This
/// world clears the gyroscopic flags of all bodies. Two kinds of bodies turn as in Bullet: those
/// that cannot turn about every axis (an inverse inertia or angular factor of 0), and those that
/// turn by more than a whole turn in a step. docs/decisions/0032-angular-momentum-is-kept.md.
template <class World = btDiscreteDynamicsWorld>
class MomentumWorld : public World {
 public:
  using World::World;

 protected:
  void predictUnconstraintMotion(btScalar time_step) override {
    constexpr int kGyroscopic = BT_ENABLE_GYROSCOPIC_FORCE_EXPLICIT |
                                BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_WORLD |
                                BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_BODY;
    for (int i = 0; i < this->m_nonStaticRigidBodies.size(); ++i) {
      btRigidBody& body = *this->m_nonStaticRigidBodies[i];
      body.setFlags(body.getFlags() & ~kGyroscopic);
    }
    World::predictUnconstraintMotion(time_step);
  }

  void integrateTransforms(btScalar time_step) override {
    turns_.clear();
    for (int i = 0; i < this->m_nonStaticRigidBodies.size(); ++i) {
      btRigidBody& body = *this->m_nonStaticRigidBodies[i];
      if (!turns_freely(body)) continue;
      Turn turn{&body,
                {body.getWorldTransform().getBasis(), body.getAngularVelocity()},
                body.getAngularVelocity()};
      if (rotate_freely(turn.end, body.getInvInertiaDiagLocal(), time_step)) turns_.push_back(turn);
    }
    World::integrateTransforms(time_step);
    for (const Turn& turn : turns_) {
      // Bullet's own continuous collision detection has stopped it on its way.
      if (turn.body->getHitFraction() < 1) continue;
      btTransform world_from_body = turn.body->getWorldTransform();
      world_from_body.setBasis(turn.end.world_from_body);
      turn.body->setAngularVelocity(turn.body->getAngularVelocity() + turn.end.angular_velocity -
                                    turn.before);
      turn.body->setCenterOfMassTransform(world_from_body);
    }
  }

 private:
  struct Turn {
    btRigidBody* body;
    Rotation end;
    btVector3 before;  ///< angular velocity, rad/s
  };

  static bool turns_freely(const btRigidBody& body) {
    const btVector3& inverse = body.getInvInertiaDiagLocal();
    return body.isActive() && !body.isStaticOrKinematicObject() &&
           body.getAngularFactor() == btVector3(1, 1, 1) && inverse.x() > 0 && inverse.y() > 0 &&
           inverse.z() > 0 && !body.getAngularVelocity().isZero();
  }

  std::vector<Turn> turns_;  ///< of this step; kept for its memory
};

}  // namespace voxshell::bullet
