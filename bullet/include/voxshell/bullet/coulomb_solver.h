#pragma once

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>

namespace voxshell::bullet {

/// Bullet's sequential impulse solver with Coulomb's friction at every contact point.
///
/// The stock solver updates the friction of a point only while the point's normal impulse is
/// positive, so a point that is unloaded in a later iteration keeps the friction of the earlier
/// ones, and it bounds the friction along each of two directions alone. Here:
///   - a point without normal impulse has no friction, and no rolling or spinning friction;
///   - the friction of a point is at most friction times its normal impulse, in whichever direction
///     (a circular cone), and opposes sliding;
///   - rolling and spinning friction grow with the normal impulse without an upper limit;
///   - friction withstands torques of the same step (btRigidBody::applyTorque()).
/// Works in place of btSequentialImpulseConstraintSolver with every solver mode of it, one friction
/// direction included, in worlds without multibodies. docs/decisions/0031-coulomb-solver.md.
class CoulombSolver : public btSequentialImpulseConstraintSolver {
 protected:
  void convertContacts(btPersistentManifold** manifolds, int manifold_count,
                       const btContactSolverInfo& info) override;

  btScalar solveSingleIteration(int iteration, btCollisionObject** bodies, int body_count,
                                btPersistentManifold** manifolds, int manifold_count,
                                btTypedConstraint** constraints, int constraint_count,
                                const btContactSolverInfo& info, btIDebugDraw* drawer) override;

 private:
  void shuffle(btAlignedObjectArray<int>& order);
  void complete_rows(btConstraintArray& rows) const;
  void warm_start_friction(const btContactSolverInfo& info);
  btScalar solve_joints(int iteration);
  void solve_obsolete(btTypedConstraint** constraints, int count, btScalar time_step);
  btScalar solve_normal(const btSolverConstraint& contact);
  btScalar solve_friction(const btSolverConstraint& contact, bool has_two_directions);
  btScalar solve_rolling_friction();
  btScalar solve_row(btSolverConstraint& row, btScalar bound);
  btScalar solve_disc(btSolverConstraint& row_1, btSolverConstraint& row_2, btScalar bound);
};

}  // namespace voxshell::bullet
