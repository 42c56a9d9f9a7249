#pragma once

#include <vector>

#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

namespace voxshell::bullet {

/// Keeps light links between joints that pull on them from swinging faster than steps follow.
///
/// A link under tension swings like a string: a joint that pulls outward at a lever resists each
/// turn by the force times the lever, the geometric stiffness. Solvers of velocities take forces to
/// act along their present lines for the whole step, so a swing of more than about two radians a
/// step grows until the joints come apart. Where that would be, bodies turn in the solver as if
/// they had the inertia with which they follow (Andrews, Teichmann and Kövecses 2017, Geometric
/// stiffness for real-time constrained multibody dynamics). Decision 72.
///
/// The tension is that of the last step, which a joint's feedback has: joints without one are left
/// out. Set a feedback's vectors to zero when you make it: Bullet's constructor does not.
class TautJoints {
 public:
  /// Raises inertias where needed. Call it before the solver.
  void begin(const btAlignedObjectArray<btTypedConstraint*>& joints, btScalar time_step);
  /// Puts them back.
  void end();

 private:
  struct Pulled {
    btRigidBody* body = nullptr;
    btVector3 stiffness{0, 0, 0};  ///< about its principal axes, N m
    btVector3 inverse_inertia;     ///< its own
  };

  void pull(btRigidBody& body, const btVector3& place, const btVector3& force);

  std::vector<Pulled> pulled_;  ///< by their index in the world, then those that are changed
};

/// A Bullet dynamics world with that.
template <class World = btDiscreteDynamicsWorld>
class TautJointsWorld : public World {
 public:
  using World::World;

 protected:
  void solveConstraints(btContactSolverInfo& info) override {
    taut_.begin(this->m_constraints, info.m_timeStep);
    World::solveConstraints(info);
    taut_.end();
  }

 private:
  TautJoints taut_;
};

}  // namespace voxshell::bullet
