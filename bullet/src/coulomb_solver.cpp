#include "voxshell/bullet/coulomb_solver.h"

#include <algorithm>
#include <array>
#include <limits>

#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "braced_contacts.h"
#include "conjugate_sweeps.h"
#include "island_problem.h"
#include "solver_constants.h"
#include "squeezed_contacts.h"
#include "turning_speed.h"

namespace voxshell::bullet {
namespace {

/// The impulse that would give a row the velocity it aims at, if nothing else acted.
btScalar missing_impulse(const btSolverConstraint& row, const btSolverBody& a,
                         const btSolverBody& b) {
  return row.m_rhs - btScalar(row.m_appliedImpulse) * row.m_cfm -
         added_velocity(row, a, b) * row.m_jacDiagABInv;
}

btScalar squared(btScalar x) { return x * x; }

/// Whether the directions of friction at a point depend on its normal alone.
bool keeps_directions(const btContactSolverInfo& info) {
  constexpr int kNeeded =
      SOLVER_USE_WARMSTARTING | SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION;
  return (info.m_solverMode & kNeeded) == kNeeded;
}

/// How fast what touches turns about the normal, rad/s: as the body that the other one rides on, if
/// that one cannot be moved, or as both.
btScalar spin_of_frame(const btSolverBody& a, const btSolverBody& b, const btVector3& normal) {
  const bool moves_a = can_move(a);
  const bool moves_b = can_move(b);
  if (moves_a != moves_b) return normal.dot(moves_a ? b.m_angularVelocity : a.m_angularVelocity);
  return btScalar(0.5) * normal.dot(a.m_angularVelocity + b.m_angularVelocity);
}

bool is_empty(const btSolverConstraint& row) { return btScalar(row.m_appliedImpulse) == 0; }

}  // namespace

CoulombSolver::CoulombSolver(SolverEffort effort)
    : effort_(effort),
      problem_(std::make_unique<IslandProblem>()),
      conjugate_(std::make_unique<ConjugateSweeps>()),
      best_(std::make_unique<SolverState>()),
      of_newton_(std::make_unique<SolverState>()),
      squeezed_(std::make_unique<SqueezedContacts>()),
      braced_(std::make_unique<BracedContacts>()) {}

CoulombSolver::~CoulombSolver() = default;

/// Completes what the stock solver has set up. It leaves out the torques of this step, by which a
/// body at rest would turn at torque / inertia * time step whatever its friction. And it divides by
/// zero where bodies cannot turn: such rolling rows have nothing to do.
void CoulombSolver::complete_rows(btConstraintArray& rows) const {
  for (int i = 0; i < rows.size(); ++i) {
    btSolverConstraint& row = rows[i];
    if (!(row.m_jacDiagABInv < BT_LARGE_FLOAT)) {
      row.m_jacDiagABInv = 0;
      row.m_rhs = 0;
      continue;
    }
    const btSolverBody& a = m_tmpSolverBodyPool[row.m_solverBodyIdA];
    const btSolverBody& b = m_tmpSolverBodyPool[row.m_solverBodyIdB];
    row.m_rhs -= (row.m_relpos1CrossNormal.dot(a.m_externalTorqueImpulse) +
                  row.m_relpos2CrossNormal.dot(b.m_externalTorqueImpulse)) *
                 row.m_jacDiagABInv;
  }
}

void CoulombSolver::convertContacts(btPersistentManifold** manifolds, int manifold_count,
                                    const btContactSolverInfo& info) {
  if (!surface_velocities_.empty()) release_anchors(manifolds, manifold_count);
  btSequentialImpulseConstraintSolver::convertContacts(manifolds, manifold_count, info);
  complete_rows(m_tmpSolverContactFrictionConstraintPool);
  complete_rows(m_tmpSolverContactRollingFrictionConstraintPool);
  if (!surface_velocities_.empty()) move_surfaces();
  aim_at_middle_of_step(info.m_timeStep);
  turn_contacts();
  if (keeps_directions(info)) warm_start_friction(info);
}

/// The stock solver forgets what a row gives way by when it works out the impulse for a velocity:
/// impulses of rows that give way by more than twice what resists them diverge.
void CoulombSolver::convertJoints(btTypedConstraint** constraints, int constraint_count,
                                  const btContactSolverInfo& info) {
  btSequentialImpulseConstraintSolver::convertJoints(constraints, constraint_count, info);
  for (int i = 0; i < m_tmpSolverNonContactConstraintPool.size(); ++i) {
    btSolverConstraint& row = m_tmpSolverNonContactConstraintPool[i];
    const btScalar fraction = 1 / (1 + row.m_cfm);
    row.m_jacDiagABInv *= fraction;
    row.m_rhs *= fraction;
    row.m_cfm *= fraction;
  }
  start_from_last();
}

void CoulombSolver::begin_step() { is_in_step_ = true; }

void CoulombSolver::end_step() {
  is_in_step_ = false;
  joint_rows_.clear();
  continued_.clear();
}

btScalar CoulombSolver::solveGroupCacheFriendlyFinish(btCollisionObject** bodies, int body_count,
                                                      const btContactSolverInfo& info) {
  for (int i = 0; i < m_tmpSolverNonContactConstraintPool.size(); ++i) {
    btSolverConstraint& row = m_tmpSolverNonContactConstraintPool[i];
    row.m_appliedImpulse = btScalar(row.m_appliedImpulse) + given_[static_cast<std::size_t>(i)];
    if (!is_in_step_) continue;
    joint_rows_.push_back({static_cast<const btTypedConstraint*>(row.m_originalContactPoint),
                           btScalar(row.m_appliedImpulse)});
  }
  return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlyFinish(bodies, body_count,
                                                                            info);
}

void CoulombSolver::continue_from_last(std::span<const btRigidBody* const> bodies) {
  const auto continues = [&](const btRigidBody& body) {
    return std::ranges::binary_search(bodies, &body);
  };
  continued_.clear();
  for (const JointRow& row : joint_rows_) {
    if (continues(row.joint->getRigidBodyA()) || continues(row.joint->getRigidBodyB())) {
      continued_.push_back(row);
    }
  }
  joint_rows_.clear();
  std::ranges::stable_sort(continued_, {}, &JointRow::joint);
}

/// Takes from the limits and aims of rows that continue what they gave.
void CoulombSolver::start_from_last() {
  btConstraintArray& rows = m_tmpSolverNonContactConstraintPool;
  given_.assign(static_cast<std::size_t>(rows.size()), btScalar(0));
  if (continued_.empty()) return;
  auto next = continued_.cbegin();
  const btTypedConstraint* of = nullptr;
  for (int i = 0; i < rows.size(); ++i) {
    btSolverConstraint& row = rows[i];
    const auto* const joint = static_cast<const btTypedConstraint*>(row.m_originalContactPoint);
    if (joint != of) next = std::ranges::lower_bound(continued_, joint, {}, &JointRow::joint);
    of = joint;
    if (next == continued_.cend() || next->joint != joint) continue;
    const btScalar given = (next++)->impulse;
    row.m_lowerLimit -= given;
    row.m_upperLimit -= given;
    row.m_rhs -= given * row.m_cfm;
    given_[static_cast<std::size_t>(i)] = given;
  }
}

void CoulombSolver::set_surface_velocity(const btCollisionObject& body, const btVector3& velocity) {
  if (velocity.isZero()) {
    surface_velocities_.erase(&body);
  } else {
    surface_velocities_[&body] = velocity;
  }
}

/// Friction does not pull back to where they were what rides on a moving surface.
void CoulombSolver::release_anchors(btPersistentManifold** manifolds, int manifold_count) const {
  for (int m = 0; m < manifold_count; ++m) {
    btPersistentManifold& manifold = *manifolds[m];
    if (!surface_velocities_.contains(manifold.getBody0()) &&
        !surface_velocities_.contains(manifold.getBody1())) {
      continue;
    }
    for (int i = 0; i < manifold.getNumContacts(); ++i) {
      manifold.getContactPoint(i).m_contactPointFlags &= ~BT_CONTACT_FLAG_FRICTION_ANCHOR;
    }
  }
}

/// Lets friction aim at the velocities of surfaces.
void CoulombSolver::move_surfaces() {
  for (int i = 0; i < m_tmpSolverContactFrictionConstraintPool.size(); ++i) {
    btSolverConstraint& row = m_tmpSolverContactFrictionConstraintPool[i];
    row.m_rhs -= (row.m_contactNormal1.dot(surface_velocity(row.m_solverBodyIdA)) +
                  row.m_contactNormal2.dot(surface_velocity(row.m_solverBodyIdB))) *
                 row.m_jacDiagABInv;
  }
}

/// Lets friction hold what rides on a body that spins about the contact's normal at the velocity
/// that the body's surface has where the rider is in the middle of the step. Held at that of the
/// step's start, riders go straight on in each step, and drift off a turntable.
void CoulombSolver::aim_at_middle_of_step(btScalar time_step) {
  for (int i = 0; i < m_tmpSolverContactFrictionConstraintPool.size(); ++i) {
    btSolverConstraint& row = m_tmpSolverContactFrictionConstraintPool[i];
    const btSolverBody& a = m_tmpSolverBodyPool[row.m_solverBodyIdA];
    const btSolverBody& b = m_tmpSolverBodyPool[row.m_solverBodyIdB];
    const btVector3& normal =
        m_tmpSolverContactConstraintPool[row.m_frictionIndex].m_contactNormal1;
    const btScalar spin = spin_of_frame(a, b, normal);
    if (spin == 0) continue;
    const btVector3 change =
        (btScalar(0.5) * time_step * spin) * normal.cross(b.m_linearVelocity - a.m_linearVelocity);
    row.m_rhs -= row.m_contactNormal1.dot(change) * row.m_jacDiagABInv;
  }
}

/// Lets contacts on concave surfaces end the step with the speed apart that keeps the bodies
/// outside of these: see TurningContacts.
void CoulombSolver::turn_contacts() {
  for (int i = 0; i < m_tmpSolverContactConstraintPool.size(); ++i) {
    btSolverConstraint& row = m_tmpSolverContactConstraintPool[i];
    const auto* const point = static_cast<const btManifoldPoint*>(row.m_originalContactPoint);
    row.m_rhs += turning_speed_of(*point) * row.m_jacDiagABInv;
  }
}

/// m/s, world frame.
btVector3 CoulombSolver::surface_velocity(int solver_body) const {
  const btRigidBody* const body = m_tmpSolverBodyPool[solver_body].m_originalBody;
  const auto found = surface_velocities_.find(body);
  if (found == surface_velocities_.end()) return {0, 0, 0};
  return body->getWorldTransform().getBasis() * found->second;
}

/// Begins with the fraction that Bullet gives to normal impulses, m_warmstartingFactor, of the
/// friction of the step before, where the directions that it is along are still the same. Begun
/// with none, as in the stock solver, bodies creep down slopes and grips give way; with all of it,
/// stacks rock for seconds longer and points that pull against each other do so for ever.
void CoulombSolver::warm_start_friction(const btContactSolverInfo& info) {
  const bool has_two_directions = (info.m_solverMode & SOLVER_USE_2_FRICTION_DIRECTIONS) != 0;
  for (int i = 0; i < m_tmpSolverContactConstraintPool.size(); ++i) {
    const btSolverConstraint& contact = m_tmpSolverContactConstraintPool[i];
    const auto& point = *static_cast<const btManifoldPoint*>(contact.m_originalContactPoint);
    const btScalar impulse_1 = point.m_appliedImpulseLateral1;
    const btScalar impulse_2 = has_two_directions ? point.m_appliedImpulseLateral2 : btScalar(0);
    const btScalar length = btSqrt(squared(impulse_1) + squared(impulse_2));
    if (length == 0) continue;
    btSolverConstraint& row_1 = m_tmpSolverContactFrictionConstraintPool[contact.m_frictionIndex];
    const btScalar bound = row_1.m_friction * btScalar(contact.m_appliedImpulse);
    const btScalar fraction = std::min(bound / length, info.m_warmstartingFactor);
    btSolverBody& a = m_tmpSolverBodyPool[contact.m_solverBodyIdA];
    btSolverBody& b = m_tmpSolverBodyPool[contact.m_solverBodyIdB];
    set_impulse(row_1, a, b, fraction * impulse_1);
    if (!has_two_directions) continue;
    set_impulse(m_tmpSolverContactFrictionConstraintPool[contact.m_frictionIndex + 1], a, b,
                fraction * impulse_2);
  }
}

void CoulombSolver::solveGroupCacheFriendlySplitImpulseIterations(
    btCollisionObject** bodies, int body_count, btPersistentManifold** manifolds,
    int manifold_count, btTypedConstraint** constraints, int constraint_count,
    const btContactSolverInfo& info, btIDebugDraw* drawer) {
  btSequentialImpulseConstraintSolver::solveGroupCacheFriendlySplitImpulseIterations(
      bodies, body_count, manifolds, manifold_count, constraints, constraint_count, info, drawer);
  if (info.m_splitImpulse) squeezed_->soften(pools(), info);
}

btScalar CoulombSolver::solveGroupCacheFriendlyIterations(
    btCollisionObject** bodies, int body_count, btPersistentManifold** manifolds,
    int manifold_count, btTypedConstraint** constraints, int constraint_count,
    const btContactSolverInfo& info, btIDebugDraw* drawer) {
  if (effort_ == SolverEffort::kFixed) {
    return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlyIterations(
        bodies, body_count, manifolds, manifold_count, constraints, constraint_count, info, drawer);
  }
  solveGroupCacheFriendlySplitImpulseIterations(bodies, body_count, manifolds, manifold_count,
                                                constraints, constraint_count, info, drawer);
  solve_as_needed(
      [&](int iteration) {
        m_leastSquaresResidual =
            solveSingleIteration(iteration, bodies, body_count, manifolds, manifold_count,
                                 constraints, constraint_count, info, drawer);
        return btSqrt(m_leastSquaresResidual);
      },
      info);
  return 0;
}

/// @param sweep Solves every row once and returns the largest velocity that this changed.
template <class Sweep>
void CoulombSolver::solve_as_needed(const Sweep& sweep, const btContactSolverInfo& info) {
  const int least = std::max(info.m_numIterations, m_maxOverrideNumSolverIterations);
  const btScalar least_residual =
      btSqrt(std::max(info.m_leastSquaresResidualThreshold, btScalar(0)));
  btScalar residual = 0;
  for (int i = 0; i < least; ++i) {
    residual = sweep(i);
    if (residual <= least_residual) return;
  }
  const btScalar of_forces = velocity_of_forces();
  const btScalar reference = of_forces > 0 ? of_forces : velocity_of_aims();
  const btScalar converged = static_cast<btScalar>(kConvergedOfForces) * reference;
  if (residual <= converged || rebounds_with_friction(of_forces)) return;
  braced_->find(pools());
  braced_->soften(pools(), info);
  if (problem_->prepare(pools()) && solve_by_newton(sweep, converged, reference)) return;
  // Numbers of iterations stay below m_numIterations, from which on only joints are solved.
  if (problem_->is_small()) {
    for (int i = least; i < kMostSweeps && residual > converged; ++i) residual = sweep(0);
    return;
  }
  conjugate_->begin(pools());
  for (int i = least; i < kMostSweepsOfMany; ++i) {
    if (i > least) conjugate_->go_on(pools());
    if (sweep(0) <= converged) return;
  }
}

/// @return Whether the island is solved. If not, it is as near to it as any round has brought it.
template <class Sweep>
bool CoulombSolver::solve_by_newton(const Sweep& sweep, btScalar converged, btScalar reference) {
  const SolverPools rows = pools();
  double best = problem_->error(rows);
  const bool is_hard =
      problem_->is_small() && best > kSmallOfForces * static_cast<double>(reference);
  const int most_rounds = is_hard ? kMostRounds : kMostRoundsOfMany;
  const int most_idle_rounds = is_hard ? kMostIdleRoundsOfHard : kMostIdleRounds;
  best_->read(rows);
  const auto keep_if_better = [&](double error) {
    if (!(error < best)) return;
    best = error;
    best_->read(rows);
  };
  double stiffness = kFirstStiffness;
  int idle_rounds = 0;
  int sticking_rounds = kStickingRounds;
  const double braced = braced_->sum_of_impulses(rows);
  for (int round = 0; round < most_rounds && idle_rounds < most_idle_rounds; ++round) {
    const auto sliding = round < sticking_rounds ? IslandProblem::Sliding::kIgnored
                                                 : IslandProblem::Sliding::kCorrected;
    if (!problem_->solve(rows, stiffness, sliding)) break;
    const bool may_jam = round == 0 && !braced_->empty();
    if (may_jam && braced_->sum_of_impulses(rows) > kMostBracing * braced) {
      best_->write(rows);
      sticking_rounds = 0;
      if (!problem_->solve(rows, stiffness, IslandProblem::Sliding::kCorrected)) break;
    }
    const double before = best;
    const double of_newton = problem_->error(rows);
    keep_if_better(of_newton);
    if (of_newton <= static_cast<double>(converged)) return true;
    of_newton_->read(rows);
    for (int i = 0; i < kSweepsAfterRound; ++i) {
      if (sweep(0) <= converged) return true;
    }
    const double of_sweeps = problem_->error(rows);
    keep_if_better(of_sweeps);
    // The next round starts from its own impulses: sweeps drive light links under heavy loads
    // apart.
    of_newton_->write(rows);
    idle_rounds = best <= kProgress * before ? 0 : idle_rounds + 1;
    stiffness = std::min(kStiffnessGrowth * stiffness, kLargestStiffness);
  }
  best_->write(rows);
  return best <= static_cast<double>(converged);
}

/// Whether bodies are to leave a contact with friction faster than forces move them in the step.
/// What several contacts aim at may then be impossible: two that face each other, and hold by
/// friction, brace a body between them, and the nearer a solver comes to their aims, the more
/// energy it adds. Without friction, rebounds add none.
bool CoulombSolver::rebounds_with_friction(btScalar of_forces) const {
  for (int i = 0; i < m_tmpSolverContactConstraintPool.size(); ++i) {
    const btSolverConstraint& row = m_tmpSolverContactConstraintPool[i];
    // A contact that gives way keeps impulses finite.
    if (!(row.m_jacDiagABInv > 0) || !(row.m_friction > 0) || row.m_cfm > 0) continue;
    const btSolverBody& a = m_tmpSolverBodyPool[row.m_solverBodyIdA];
    const btSolverBody& b = m_tmpSolverBodyPool[row.m_solverBodyIdB];
    const std::array parts{
        row.m_contactNormal1.dot(a.m_linearVelocity + a.m_externalForceImpulse),
        row.m_relpos1CrossNormal.dot(a.m_angularVelocity + a.m_externalTorqueImpulse),
        row.m_contactNormal2.dot(b.m_linearVelocity + b.m_externalForceImpulse),
        row.m_relpos2CrossNormal.dot(b.m_angularVelocity + b.m_externalTorqueImpulse)};
    btScalar aim = row.m_rhs / row.m_jacDiagABInv;
    btScalar rounding = 0;
    for (const btScalar part : parts) {
      aim += part;
      rounding += kRoundingOfSpeed * btFabs(part);
    }
    if (aim > of_forces + rounding) return true;
  }
  return false;
}

/// The largest change of a body's velocity by the forces of this step, m/s.
btScalar CoulombSolver::velocity_of_forces() const {
  btScalar largest = 0;
  for (int i = 0; i < m_tmpSolverBodyPool.size(); ++i) {
    largest = std::max(largest, m_tmpSolverBodyPool[i].m_externalForceImpulse.length());
  }
  return largest;
}

/// The largest change of velocity that a row asks for before the step is solved and that its limits
/// allow, m/s. The far limit of a joint and a speculative contact ask for nothing.
btScalar CoulombSolver::velocity_of_aims() const {
  btScalar largest = 0;
  const auto add = [&](const btSolverConstraint& row, btScalar impulse) {
    if (row.m_jacDiagABInv > 0) {
      largest = std::max(largest, btFabs(impulse / row.m_jacDiagABInv));
    }
  };
  for (const btConstraintArray* rows :
       {&m_tmpSolverNonContactConstraintPool, &m_tmpSolverContactConstraintPool}) {
    for (int i = 0; i < rows->size(); ++i) {
      const btSolverConstraint& row = (*rows)[i];
      add(row, std::clamp(row.m_rhs, row.m_lowerLimit, row.m_upperLimit));
    }
  }
  // Their limits are coefficients.
  for (int i = 0; i < m_tmpSolverContactFrictionConstraintPool.size(); ++i) {
    const btSolverConstraint& row = m_tmpSolverContactFrictionConstraintPool[i];
    add(row, row.m_rhs);
  }
  return largest;
}

SolverPools CoulombSolver::pools() {
  return {&m_tmpSolverBodyPool, &m_tmpSolverNonContactConstraintPool,
          &m_tmpSolverContactConstraintPool, &m_tmpSolverContactFrictionConstraintPool,
          &m_tmpSolverContactRollingFrictionConstraintPool};
}

btScalar CoulombSolver::solveSingleIteration(
    int iteration, btCollisionObject** /*bodies*/, int /*body_count*/,
    btPersistentManifold** /*manifolds*/, int /*manifold_count*/, btTypedConstraint** constraints,
    int constraint_count, const btContactSolverInfo& info, btIDebugDraw* /*drawer*/) {
  const bool solves_contacts = iteration < info.m_numIterations;
  if ((info.m_solverMode & SOLVER_RANDMIZE_ORDER) != 0) {
    shuffle(m_orderNonContactConstraintPool);
    if (solves_contacts) shuffle(m_orderTmpConstraintPool);
  }
  btScalar residual = solve_joints(iteration);
  if (!solves_contacts) return residual;
  solve_obsolete(constraints, constraint_count, info.m_timeStep);

  const bool has_two_directions = (info.m_solverMode & SOLVER_USE_2_FRICTION_DIRECTIONS) != 0;
  // The friction of a point right after its normal impulse, whether the mode asks for it or not:
  // solved after all normal impulses, grips creep several times as fast.
  for (int i = 0; i < m_tmpSolverContactConstraintPool.size(); ++i) {
    const btSolverConstraint& contact =
        m_tmpSolverContactConstraintPool[m_orderTmpConstraintPool[i]];
    residual = std::max(residual, solve_normal(contact));
    residual = std::max(residual, solve_friction(contact, has_two_directions));
  }
  return std::max(residual, solve_rolling_friction());
}

/// Fisher and Yates' shuffle by the solver's own random numbers, as SOLVER_RANDMIZE_ORDER asks for.
void CoulombSolver::shuffle(btAlignedObjectArray<int>& order) {
  // Not the array's size, which is twice the number of contacts with two friction directions.
  const int count =
      &order == &m_orderTmpConstraintPool ? m_tmpSolverContactConstraintPool.size() : order.size();
  for (int i = 0; i < count; ++i) order.swap(i, btRandInt2(i + 1));
}

btScalar CoulombSolver::solve_joints(int iteration) {
  btScalar residual = 0;
  for (int i = 0; i < m_tmpSolverNonContactConstraintPool.size(); ++i) {
    btSolverConstraint& row =
        m_tmpSolverNonContactConstraintPool[m_orderNonContactConstraintPool[i]];
    if (iteration >= row.m_overrideNumSolverIterations) continue;
    const btScalar change = resolveSingleConstraintRowGeneric(
        m_tmpSolverBodyPool[row.m_solverBodyIdA], m_tmpSolverBodyPool[row.m_solverBodyIdB], row);
    residual = std::max(residual, squared(change));
  }
  return residual;
}

/// Constraints that solve themselves: btConeTwistConstraint may.
void CoulombSolver::solve_obsolete(btTypedConstraint** constraints, int count, btScalar time_step) {
  for (int i = 0; i < count; ++i) {
    btTypedConstraint& constraint = *constraints[i];
    if (!constraint.isEnabled()) continue;
    // Both before either is looked up: a body that is new makes the pool grow.
    const int a = getOrInitSolverBody(constraint.getRigidBodyA(), time_step);
    const int b = getOrInitSolverBody(constraint.getRigidBodyB(), time_step);
    constraint.solveConstraintObsolete(m_tmpSolverBodyPool[a], m_tmpSolverBodyPool[b], time_step);
  }
}

btScalar CoulombSolver::solve_normal(const btSolverConstraint& contact) {
  return squared(resolveSingleConstraintRowLowerLimit(m_tmpSolverBodyPool[contact.m_solverBodyIdA],
                                                      m_tmpSolverBodyPool[contact.m_solverBodyIdB],
                                                      contact));
}

btScalar CoulombSolver::solve_friction(const btSolverConstraint& contact, bool has_two_directions) {
  btSolverConstraint& row = m_tmpSolverContactFrictionConstraintPool[contact.m_frictionIndex];
  const btScalar bound = row.m_friction * std::max(btScalar(contact.m_appliedImpulse), btScalar(0));
  if (!has_two_directions) return solve_row(row, bound);
  return solve_disc(row, m_tmpSolverContactFrictionConstraintPool[contact.m_frictionIndex + 1],
                    bound);
}

/// A point's rows are the spinning one about the normal, then up to two of rolling.
btScalar CoulombSolver::solve_rolling_friction() {
  btConstraintArray& rows = m_tmpSolverContactRollingFrictionConstraintPool;
  btScalar residual = 0;
  for (int i = 0; i < rows.size();) {
    const int point = rows[i].m_frictionIndex;
    int end = i + 1;
    while (end < rows.size() && rows[end].m_frictionIndex == point) ++end;
    const btScalar impulse =
        std::max(btScalar(m_tmpSolverContactConstraintPool[point].m_appliedImpulse), btScalar(0));
    const auto bound = [&](int row) { return rows[row].m_friction * impulse; };
    residual = std::max(residual, solve_row(rows[i], bound(i)));
    if (end - i == 3) {
      residual = std::max(residual, solve_disc(rows[i + 1], rows[i + 2], bound(i + 1)));
    } else if (end - i == 2) {
      residual = std::max(residual, solve_row(rows[i + 1], bound(i + 1)));
    }
    i = end;
  }
  return residual;
}

/// Solves a row whose impulse is within plus and minus `bound`, N s.
btScalar CoulombSolver::solve_row(btSolverConstraint& row, btScalar bound) {
  if (bound == 0 && is_empty(row)) return 0;
  btSolverBody& a = m_tmpSolverBodyPool[row.m_solverBodyIdA];
  btSolverBody& b = m_tmpSolverBodyPool[row.m_solverBodyIdB];
  const btScalar impulse = btScalar(row.m_appliedImpulse) + missing_impulse(row, a, b);
  return set_impulse(row, a, b, std::clamp(impulse, -bound, bound));
}

/// Solves two rows of the same bodies whose impulses are, together, at most `bound`, N s.
///
/// Where both rows can have what they miss, they get it. Else the point slides, and its impulse is
/// that of the largest dissipation, opposite to the velocity: the fixed point of a step that is as
/// long for both rows (that of the stiffer one, for which it converges) with a projection on the
/// disc. With steps of different lengths, as rows of different levers have, friction would act
/// aside.
btScalar CoulombSolver::solve_disc(btSolverConstraint& row_1, btSolverConstraint& row_2,
                                   btScalar bound) {
  if (row_1.m_jacDiagABInv == 0) return solve_row(row_2, bound);
  if (row_2.m_jacDiagABInv == 0) return solve_row(row_1, bound);
  if (bound == 0 && is_empty(row_1) && is_empty(row_2)) return 0;
  btSolverBody& a = m_tmpSolverBodyPool[row_1.m_solverBodyIdA];
  btSolverBody& b = m_tmpSolverBodyPool[row_1.m_solverBodyIdB];
  const btScalar before_1 = row_1.m_appliedImpulse;
  const btScalar before_2 = row_2.m_appliedImpulse;
  const btScalar missing_1 = missing_impulse(row_1, a, b);
  const btScalar missing_2 = missing_impulse(row_2, a, b);
  btScalar impulse_1 = before_1 + missing_1;
  btScalar impulse_2 = before_2 + missing_2;
  if (squared(impulse_1) + squared(impulse_2) > squared(bound)) {
    const btScalar step = std::min(row_1.m_jacDiagABInv, row_2.m_jacDiagABInv);
    impulse_1 = before_1 + missing_1 * (step / row_1.m_jacDiagABInv);
    impulse_2 = before_2 + missing_2 * (step / row_2.m_jacDiagABInv);
    const btScalar length = btSqrt(squared(impulse_1) + squared(impulse_2));
    if (length > bound) {
      impulse_1 *= bound / length;
      impulse_2 *= bound / length;
    }
  }
  // Compilers for different processors evaluate the arguments of a call in different orders.
  const btScalar change_2 = set_impulse(row_2, a, b, impulse_2);
  return std::max(set_impulse(row_1, a, b, impulse_1), change_2);
}

}  // namespace voxshell::bullet
