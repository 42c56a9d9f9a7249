#include "island_problem.h"

#include <algorithm>
#include <cmath>

#include <BulletDynamics/Dynamics/btRigidBody.h>

#include "solver_constants.h"

namespace voxshell::bullet {
namespace {

/// The lower triangular matrix whose product with its transpose is `matrix`, by Cholesky.
btMatrix3x3 root_of(const btMatrix3x3& matrix) {
  const auto root = [](btScalar square) { return btSqrt(std::max(square, btScalar(0))); };
  const auto over = [](btScalar x, btScalar y) { return y > 0 ? x / y : btScalar(0); };
  const btScalar xx = root(matrix[0][0]);
  const btScalar yx = over(matrix[1][0], xx);
  const btScalar zx = over(matrix[2][0], xx);
  const btScalar yy = root(matrix[1][1] - yx * yx);
  const btScalar zy = over(matrix[2][1] - zx * yx, yy);
  const btScalar zz = root(matrix[2][2] - zx * zx - zy * zy);
  return {xx, 0, 0, yx, yy, 0, zx, zy, zz};
}

/// A value of Bullet's that is relative to the row's unit impulse.
double per_unit_impulse(btScalar value, const btSolverConstraint& row) {
  return row.m_jacDiagABInv > 0 ? static_cast<double>(value / row.m_jacDiagABInv) : 0.0;
}

void change_impulse(const SolverPools& pools, btSolverConstraint& row, btScalar impulse) {
  set_impulse(row, (*pools.bodies)[row.m_solverBodyIdA], (*pools.bodies)[row.m_solverBodyIdB],
              impulse);
}

}  // namespace

bool can_move(const btSolverBody& body) {
  return body.m_originalBody != nullptr && body.m_originalBody->getInvMass() > 0;
}

AddedVelocity added_velocity(const btSolverBody& body) {
  return {body.getDeltaLinearVelocity(), body.getDeltaAngularVelocity()};
}

btScalar added_velocity(const btSolverConstraint& row, const btSolverBody& a,
                        const btSolverBody& b) {
  return row.m_contactNormal1.dot(a.getDeltaLinearVelocity()) +
         row.m_relpos1CrossNormal.dot(a.getDeltaAngularVelocity()) +
         row.m_contactNormal2.dot(b.getDeltaLinearVelocity()) +
         row.m_relpos2CrossNormal.dot(b.getDeltaAngularVelocity());
}

btScalar set_impulse(btSolverConstraint& row, btSolverBody& a, btSolverBody& b, btScalar impulse) {
  const btScalar change = impulse - btScalar(row.m_appliedImpulse);
  if (change == 0) return 0;
  row.m_appliedImpulse = impulse;
  a.internalApplyImpulse(row.m_contactNormal1 * a.internalGetInvMass(), row.m_angularComponentA,
                         change);
  b.internalApplyImpulse(row.m_contactNormal2 * b.internalGetInvMass(), row.m_angularComponentB,
                         change);
  const btScalar velocity = change / row.m_jacDiagABInv;
  return velocity * velocity;
}

void SolverState::read(const SolverPools& pools) {
  impulses_.clear();
  for_each_row(pools, [&](const btSolverConstraint& row) {
    impulses_.push_back(btScalar(row.m_appliedImpulse));
  });
  velocities_.clear();
  for (int i = 0; i < pools.bodies->size(); ++i) {
    velocities_.push_back(added_velocity((*pools.bodies)[i]));
  }
}

void SolverState::write(const SolverPools& pools) const {
  std::size_t row_number = 0;
  for_each_row(pools,
               [&](btSolverConstraint& row) { row.m_appliedImpulse = impulses_[row_number++]; });
  for (int i = 0; i < pools.bodies->size(); ++i) {
    btSolverBody& body = (*pools.bodies)[i];
    body.internalGetDeltaLinearVelocity() = velocities_[static_cast<std::size_t>(i)].linear;
    body.internalGetDeltaAngularVelocity() = velocities_[static_cast<std::size_t>(i)].angular;
  }
}

bool IslandProblem::prepare(const SolverPools& pools) {
  number_bodies(pools);
  if (scales_.empty()) return false;
  fill(pools);
  const double most =
      std::max(kMostCost, kMostCostOfJointRow * static_cast<double>(first_contact_));
  return newton_.prepare(scales_.size(), rows_) <= most;
}

/// Bodies that joints hold are not free to be pushed about. Most joints have five rows or six.
bool IslandProblem::is_small() const {
  return scales_.size() <= kFewBodies + first_contact_ / kRowsOfJoint;
}

void IslandProblem::number_bodies(const SolverPools& pools) {
  numbers_.assign(static_cast<std::size_t>(pools.bodies->size()), VelocityRow::kFixed);
  scales_.clear();
  for (std::size_t i = 0; i < numbers_.size(); ++i) {
    const btSolverBody& body = (*pools.bodies)[static_cast<int>(i)];
    if (!can_move(body)) continue;
    numbers_[i] = static_cast<int>(scales_.size());
    const btVector3& inverse_mass = body.internalGetInvMass();
    scales_.push_back(
        {{btSqrt(inverse_mass.x()), btSqrt(inverse_mass.y()), btSqrt(inverse_mass.z())},
         root_of(body.m_originalBody->getInvInertiaTensorWorld())});
  }
}

bool IslandProblem::solve(const SolverPools& pools, double stiffness, Sliding sliding) {
  renew(pools, sliding);
  const int most_steps = is_small() ? kMostNewtonSteps : kMostNewtonStepsOfMany;
  if (!newton_.solve(rows_, stiffness, most_steps)) return false;
  for (int i = 1; i < kSolvesPerRound; ++i) newton_.solve(rows_, stiffness, most_steps);
  if (!std::ranges::all_of(rows_, [](const auto& row) { return std::isfinite(row.impulse); })) {
    return false;
  }
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    change_impulse(pools, *sources_[i], static_cast<btScalar>(rows_[i].impulse));
  }
  return true;
}

/// With the correction for sliding, the natural map of the cones is that of Coulomb's law.
double IslandProblem::error(const SolverPools& pools) {
  renew(pools, Sliding::kCorrected);
  return newton_.error(rows_);
}

/// All that the island's solution does not change.
void IslandProblem::fill(const SolverPools& pools) {
  rows_.clear();
  sources_.clear();
  for (int i = 0; i < pools.joints->size(); ++i) append((*pools.joints)[i]);
  first_contact_ = rows_.size();
  const int contact_count = pools.contacts->size();
  const int friction_rows = contact_count == 0 ? 0 : pools.friction->size() / contact_count;
  for (int i = 0; i < contact_count; ++i) {
    fill_contact(pools, (*pools.contacts)[i], friction_rows);
  }
  first_rolling_ = rows_.size();
  for (int i = 0; i < pools.rolling->size(); ++i) append((*pools.rolling)[i]);
}

void IslandProblem::fill_contact(const SolverPools& pools, btSolverConstraint& contact,
                                 int friction_rows) {
  const std::size_t place_of_normal = rows_.size();
  append(contact);
  auto unit_impulse = static_cast<double>(contact.m_jacDiagABInv);
  double friction = 0.0;
  for (int k = 0; k < friction_rows; ++k) {
    btSolverConstraint& source = (*pools.friction)[contact.m_frictionIndex + k];
    append(source);
    unit_impulse = std::min(unit_impulse, static_cast<double>(source.m_jacDiagABInv));
    friction = static_cast<double>(source.m_friction);
  }
  VelocityRow& normal = rows_[place_of_normal];
  normal.is_contact = true;
  normal.friction_rows = friction_rows;
  normal.friction = friction;
  normal.unit_impulse = unit_impulse;
}

/// The impulses so far, and what depends on them.
void IslandProblem::renew(const SolverPools& pools, Sliding sliding) {
  for (std::size_t i = 0; i < rows_.size(); ++i) {
    rows_[i].impulse = static_cast<double>(btScalar(sources_[i]->m_appliedImpulse));
  }
  for (std::size_t i = first_contact_; i < first_rolling_;) {
    VelocityRow& normal = rows_[i];
    const std::size_t end = i + 1 + static_cast<std::size_t>(normal.friction_rows);
    normal.target = per_unit_impulse(sources_[i]->m_rhs, *sources_[i]);
    double squared_sliding = 0.0;
    if (sliding == Sliding::kCorrected) {
      for (std::size_t k = i + 1; k < end; ++k) {
        const double speed = sliding_of(pools, k);
        squared_sliding += speed * speed;
      }
      normal.target -= normal.friction * std::sqrt(squared_sliding);
    }
    i = end;
  }
  for (std::size_t i = first_rolling_; i < rows_.size(); ++i) {
    const btSolverConstraint& source = *sources_[i];
    const btSolverConstraint& contact = (*pools.contacts)[source.m_frictionIndex];
    rows_[i].upper = static_cast<double>(source.m_friction) *
                     std::max(static_cast<double>(btScalar(contact.m_appliedImpulse)), 0.0);
    rows_[i].lower = -rows_[i].upper;
  }
}

/// The velocity by which a row of friction slides now, m/s.
double IslandProblem::sliding_of(const SolverPools& pools, std::size_t row) const {
  const btSolverConstraint& source = *sources_[row];
  return static_cast<double>(added_velocity(source, (*pools.bodies)[source.m_solverBodyIdA],
                                            (*pools.bodies)[source.m_solverBodyIdB])) -
         rows_[row].target;
}

VelocityRow& IslandProblem::append(btSolverConstraint& source) {
  VelocityRow row;
  row.body_a = place(source.m_solverBodyIdA, source.m_contactNormal1, source.m_relpos1CrossNormal,
                     row.along_a);
  row.body_b = place(source.m_solverBodyIdB, source.m_contactNormal2, source.m_relpos2CrossNormal,
                     row.along_b);
  row.target = per_unit_impulse(source.m_rhs, source);
  row.softness = per_unit_impulse(source.m_cfm, source);
  row.impulse = static_cast<double>(btScalar(source.m_appliedImpulse));
  row.unit_impulse = static_cast<double>(source.m_jacDiagABInv);
  row.lower = static_cast<double>(source.m_lowerLimit);
  row.upper = static_cast<double>(source.m_upperLimit);
  sources_.push_back(&source);
  return rows_.emplace_back(row);
}

/// The body's number, and in `along` what a unit impulse does to its scaled velocity.
int IslandProblem::place(int body, const btVector3& linear, const btVector3& angular,
                         std::array<double, 6>& along) const {
  const int number = numbers_[static_cast<std::size_t>(body)];
  if (number == VelocityRow::kFixed) return number;
  const Scale& scale = scales_[static_cast<std::size_t>(number)];
  const btVector3 scaled_linear = linear * scale.linear;
  const btVector3 scaled_angular = scale.angular.transpose() * angular;
  for (int k = 0; k < 3; ++k) {
    along[static_cast<std::size_t>(k)] = static_cast<double>(scaled_linear[k]);
    along[static_cast<std::size_t>(k) + 3] = static_cast<double>(scaled_angular[k]);
  }
  return number;
}

}  // namespace voxshell::bullet
