#pragma once

#include <map>
#include <memory>
#include <span>
#include <vector>

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>

namespace voxshell::bullet {

class BracedContacts;
class IslandProblem;
class ConjugateSweeps;
class SolverState;
class SqueezedContacts;
struct SolverPools;

/// How much work CoulombSolver spends on an island in a step.
enum class SolverEffort {
  /// Exactly m_numIterations sweeps.
  kFixed,
  /// The same, and then Newton's method for the whole island until it is solved.
  kAsNeeded,
};

/// Bullet's sequential impulse solver with Coulomb friction at every contact point.
///
/// The stock solver updates the friction of a point only while the point's normal impulse is
/// positive, so a point that is unloaded in a later iteration keeps the friction of the earlier
/// ones. It also bounds the friction along each of two directions separately. In this solver:
///   - a point without normal impulse has no friction, and no rolling or spinning friction;
///   - the friction of a point is at most friction times its normal impulse, in whichever direction
///     (a circular cone), and opposes sliding;
///   - rolling and spinning friction grow with the normal impulse without an upper limit;
///   - friction resists torques of the same step (btRigidBody::applyTorque());
///   - friction holds riders on what turns
///     (docs/decisions/0057-friction-in-the-middle-of-the-step.md);
///   - round bodies keep their speed on concave surfaces, where ContactSettings say so
///     (docs/decisions/0061-contacts-turn-within-a-step.md);
///   - what is squeezed, as between two kinematic fingers, is pressed by stiff springs
///     (docs/decisions/0056-what-is-squeezed-gives-way.md);
///   - Newton's method solves islands that iterations have not solved, such as heavy bodies on
///     light ones (docs/decisions/0034-loads.md).
/// Set m_minimumSolverBatchSize of btContactSolverInfo to 1, so that Bullet does not merge islands.
/// Replaces btSequentialImpulseConstraintSolver with all of its solver modes, one friction
/// direction included, in worlds without multibodies. docs/decisions/0031-coulomb-solver.md.
class CoulombSolver : public btSequentialImpulseConstraintSolver {
 public:
  explicit CoulombSolver(SolverEffort effort = SolverEffort::kAsNeeded);
  ~CoulombSolver() override;

  /// Gives a kinematic body's surface a velocity while the body stays, as of a conveyor's belt.
  ///
  /// @param velocity m/s, in the body's frame. Friction moves bodies that touch the surface. Needs
  ///        two fixed friction directions. 0 removes the entry: call it before you delete the body.
  void set_surface_velocity(const btCollisionObject& body, const btVector3& velocity);

  /// Between these two calls, a step may be solved several times.
  void begin_step();
  void end_step();
  /// Lets joints of bodies, ascending by address, continue in the next solution of the step. These
  /// bodies begin it with the velocities that the last one gave them, so rows of their joints add
  /// to the impulses that they gave in it: a motor's limit and what a spring gives are for the
  /// step.
  void continue_from_last(std::span<const btRigidBody* const> bodies);

 protected:
  void solveGroupCacheFriendlySplitImpulseIterations(
      btCollisionObject** bodies, int body_count, btPersistentManifold** manifolds,
      int manifold_count, btTypedConstraint** constraints, int constraint_count,
      const btContactSolverInfo& info, btIDebugDraw* drawer) override;

  btScalar solveGroupCacheFriendlyIterations(btCollisionObject** bodies, int body_count,
                                             btPersistentManifold** manifolds, int manifold_count,
                                             btTypedConstraint** constraints, int constraint_count,
                                             const btContactSolverInfo& info,
                                             btIDebugDraw* drawer) override;

  void convertContacts(btPersistentManifold** manifolds, int manifold_count,
                       const btContactSolverInfo& info) override;
  void convertJoints(btTypedConstraint** constraints, int constraint_count,
                     const btContactSolverInfo& info) override;

  btScalar solveSingleIteration(int iteration, btCollisionObject** bodies, int body_count,
                                btPersistentManifold** manifolds, int manifold_count,
                                btTypedConstraint** constraints, int constraint_count,
                                const btContactSolverInfo& info, btIDebugDraw* drawer) override;
  btScalar solveGroupCacheFriendlyFinish(btCollisionObject** bodies, int body_count,
                                         const btContactSolverInfo& info) override;

 private:
  /// What a row of a joint gave in a solution, N s or N m s.
  struct JointRow {
    const btTypedConstraint* joint;
    btScalar impulse;
  };

  template <class Sweep>
  void solve_as_needed(const Sweep& sweep, const btContactSolverInfo& info);
  template <class Sweep>
  bool solve_by_newton(const Sweep& sweep, btScalar converged, btScalar reference);
  bool rebounds_with_friction(btScalar of_forces) const;
  btScalar velocity_of_forces() const;
  btScalar velocity_of_aims() const;
  SolverPools pools();
  void shuffle(btAlignedObjectArray<int>& order);
  void complete_rows(btConstraintArray& rows) const;
  void start_from_last();
  void release_anchors(btPersistentManifold** manifolds, int manifold_count) const;
  void move_surfaces();
  void aim_at_middle_of_step(btScalar time_step);
  void turn_contacts();
  btVector3 surface_velocity(int solver_body) const;
  void warm_start_friction(const btContactSolverInfo& info);
  btScalar solve_joints(int iteration);
  void solve_obsolete(btTypedConstraint** constraints, int count, btScalar time_step);
  btScalar solve_normal(const btSolverConstraint& contact);
  btScalar solve_friction(const btSolverConstraint& contact, bool has_two_directions);
  btScalar solve_rolling_friction();
  btScalar solve_row(btSolverConstraint& row, btScalar bound);
  btScalar solve_disc(btSolverConstraint& row_1, btSolverConstraint& row_2, btScalar bound);

  SolverEffort effort_;
  std::map<const btCollisionObject*, btVector3> surface_velocities_;  ///< m/s, in bodies' frames
  bool is_in_step_ = false;
  std::vector<JointRow> joint_rows_;            ///< of the last solution, as they were solved
  std::vector<JointRow> continued_;             ///< that the next one adds to, by joint
  std::vector<btScalar> given_;                 ///< of these by each joint row of an island
  std::unique_ptr<IslandProblem> problem_;      ///< kept for its memory
  std::unique_ptr<ConjugateSweeps> conjugate_;  ///< kept for its memory
  std::unique_ptr<SolverState> best_;           ///< kept for its memory
  std::unique_ptr<SolverState> of_newton_;      ///< before sweeps; the same
  std::unique_ptr<SqueezedContacts> squeezed_;  ///< kept for its memory
  std::unique_ptr<BracedContacts> braced_;      ///< kept for its memory
};

}  // namespace voxshell::bullet
