#pragma once

#include <vector>

#include <BulletCollision/BroadphaseCollision/btBroadphaseInterface.h>
#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace voxshell::bullet {

/// Looks along the motion that the solver has found for bodies that it made fast.
///
/// CCD looks along the velocity from before the step. A motor that starts beside a wall, a force
/// with a lever and a blow of another body move places within the step that were at rest before
/// it, and these end in bodies that they had no contact with.
/// docs/decisions/0063-motion-is-checked.md.
class CheckedMotion {
 public:
  /// Call it before the solver, with the world's bodies.
  void begin(const btAlignedObjectArray<btRigidBody*>& bodies);

  /// Call it after the solver. If contacts are found that the solver does not know, bodies are as
  /// they were in begin(), and the contacts are in manifolds: solve again. Else bodies are as the
  /// solver left them.
  bool find_contacts(btBroadphaseInterface& broadphase, btDispatcher& dispatcher,
                     const btDispatcherInfo& info);

  /// A body that the solver has made fast.
  struct Faster {
    btRigidBody* body;
    btScalar displacement;  ///< of its fastest place within the step, in sizes of the body
  };

 private:
  struct State {
    btTransform world_from_body;
    btVector3 linear_velocity;
    btVector3 angular_velocity;

    static State of(const btRigidBody& body);
    void put_on(btRigidBody& body) const;
  };
  struct Checked {
    btRigidBody* body;
    State before;
    State solved;
    btVector3 force;
    btVector3 torque;
  };

  static btScalar displacement_if_faster(const Checked& checked, btScalar time_step);

  std::vector<Checked> all_;
  std::vector<Faster> faster_;  ///< by address
};

/// A Bullet dynamics world that checks the solver's motion, and solves again where it leads into
/// bodies.
template <class World = btDiscreteDynamicsWorld>
class CheckedMotionWorld : public World {
 public:
  using World::World;

 protected:
  void solveConstraints(btContactSolverInfo& info) override {
    checked_.begin(this->m_nonStaticRigidBodies);
    World::solveConstraints(info);
    if (!checked_.find_contacts(*this->getBroadphase(), *this->getDispatcher(),
                                this->getDispatchInfo())) {
      return;
    }
    this->calculateSimulationIslands();
    World::solveConstraints(info);
  }

 private:
  CheckedMotion checked_;
};

}  // namespace voxshell::bullet
