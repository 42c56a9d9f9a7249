#pragma once

#include <memory>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btBroadphaseInterface.h>
#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "voxshell/bullet/coulomb_solver.h"

namespace voxshell::bullet {

class Blows;
class SolvedMotionSearch;
class StepEnd;

/// Looks along the motion that the solver has found for bodies that it made fast, and for bodies
/// that turn into each other.
///
/// CCD looks along the velocity from before the step. A motor that starts beside a wall, a force
/// with a lever and a blow of another body move places within the step that were at rest before
/// it, and these end in bodies that they had no contact with
/// (docs/decisions/0063-motion-is-checked.md). Bodies that have contacts may turn into each other
/// (docs/decisions/0066-bodies-that-turn-into-each-other.md). What rebounds several times within a
/// step is passed on from wall to wall (docs/decisions/0068-rebounds-within-a-step.md).
class CheckedMotion {
 public:
  CheckedMotion();
  ~CheckedMotion();
  CheckedMotion(const CheckedMotion&) = delete;
  CheckedMotion& operator=(const CheckedMotion&) = delete;

  /// Call it before the solver, with the world's bodies.
  void begin(const btAlignedObjectArray<btRigidBody*>& bodies, btDispatcher& dispatcher,
             btScalar time_step);

  /// Call it after the solver, until it returns false. While contacts are found that the solver
  /// does not know, they are in manifolds, and bodies are as in begin(), with the velocities that
  /// blows have given them: solve again. Else bodies are as the solver left them.
  ///
  /// @param solver  The world's, between its begin_step() and end_step(); or null where that is
  ///        another one: motors, springs and limits of joints then give again, in each solution,
  ///        what they gave before.
  bool find_contacts(btBroadphaseInterface& broadphase, btDispatcher& dispatcher,
                     const btDispatcherInfo& info, CoulombSolver* solver);

  /// Call it once bodies have moved. Those that would have hit more within the step than it was
  /// solved for have stopped at what they would have hit next, and get back their velocities.
  void release();

  /// Forgets contacts that find_contacts() added to those of a pair. Call it before the next step
  /// looks for contacts, and before a body is removed.
  void drop_added();

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
    State start;  ///< of the last solution: before, with blows
    State solved;
    btVector3 force;
    btVector3 torque;
    bool is_faster;  ///< in any solution of the step

    /// Where the step begins, as the solver has it move.
    State go_on() const;
  };

  /// What the last solution took from a body.
  struct Stopped {
    btRigidBody* body;
    btVector3 linear;
    btVector3 angular;
  };

  static bool is_faster(const Checked& checked, btScalar time_step);
  bool is_unfinished(btBroadphaseInterface& broadphase, btDispatcher& dispatcher,
                     const btDispatcherInfo& info, CoulombSolver* solver);
  void continue_from_last(btScalar time_step, CoulombSolver* solver);
  void find_stopped(btScalar time_step);
  bool find_turned(btBroadphaseInterface& broadphase, btDispatcher& dispatcher,
                   const btDispatcherInfo& info);

  std::vector<Checked> all_;
  std::vector<Stopped> stopped_;
  std::vector<btRigidBody*> faster_;  ///< bodies that the solver made fast
  std::vector<btRigidBody*> faster_by_address_;
  std::vector<const btRigidBody*> continued_;  ///< those that begin the next solution with blows
  std::unique_ptr<Blows> blows_;
  std::unique_ptr<SolvedMotionSearch> search_;
  std::unique_ptr<StepEnd> step_end_;
  int solutions_ = 0;           ///< of the step
  int solutions_of_turns_ = 0;  ///< of these, with contacts of bodies that turn
};

/// A Bullet dynamics world that checks the solver's motion, and solves again where it leads into
/// bodies.
template <class World = btDiscreteDynamicsWorld>
class CheckedMotionWorld : public World {
 public:
  using World::World;

  void removeRigidBody(btRigidBody* body) override {
    checked_.drop_added();
    World::removeRigidBody(body);
  }
  void removeCollisionObject(btCollisionObject* object) override {
    checked_.drop_added();
    World::removeCollisionObject(object);
  }

 protected:
  void solveConstraints(btContactSolverInfo& info) override {
    checked_.begin(this->m_nonStaticRigidBodies, *this->getDispatcher(), info.m_timeStep);
    auto* const solver = dynamic_cast<CoulombSolver*>(this->getConstraintSolver());
    if (solver != nullptr) solver->begin_step();
    World::solveConstraints(info);
    while (checked_.find_contacts(*this->getBroadphase(), *this->getDispatcher(),
                                  this->getDispatchInfo(), solver)) {
      this->calculateSimulationIslands();
      World::solveConstraints(info);
    }
    if (solver != nullptr) solver->end_step();
  }

  void predictUnconstraintMotion(btScalar time_step) override {
    checked_.drop_added();
    World::predictUnconstraintMotion(time_step);
  }

  void integrateTransforms(btScalar time_step) override {
    World::integrateTransforms(time_step);
    checked_.release();
  }

 private:
  CheckedMotion checked_;
};

}  // namespace voxshell::bullet
