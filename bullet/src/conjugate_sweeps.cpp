#include "conjugate_sweeps.h"

#include <cstddef>

namespace voxshell::bullet {

void ConjugateSweeps::begin(const SolverPools& pools) {
  before_.read(pools);
  change_.assign(before_.impulses().size(), 0);
  direction_.assign(before_.impulses().size(), 0);
  velocity_change_.assign(before_.velocities().size(), {{0, 0, 0}, {0, 0, 0}});
  velocity_direction_.assign(before_.velocities().size(), {{0, 0, 0}, {0, 0, 0}});
  last_ = 0.0;
}

/// Stores what the sweep has changed.
///
/// @return Its squared length, J: that of each impulse is over the mass that it acts on.
double ConjugateSweeps::find_change(const SolverPools& pools) {
  double squared = 0.0;
  std::size_t i = 0;
  for_each_row(pools, [&](const btSolverConstraint& row) {
    const btScalar change = btScalar(row.m_appliedImpulse) - before_.impulses()[i];
    change_[i++] = change;
    if (row.m_jacDiagABInv > 0) {
      squared += static_cast<double>(change) * static_cast<double>(change / row.m_jacDiagABInv);
    }
  });
  for (int b = 0; b < pools.bodies->size(); ++b) {
    const auto at = static_cast<std::size_t>(b);
    const AddedVelocity now = added_velocity((*pools.bodies)[b]);
    const AddedVelocity& before = before_.velocities()[at];
    velocity_change_[at] = {now.linear - before.linear, now.angular - before.angular};
  }
  return squared;
}

/// Goes on by `factor` times the last direction. The next one is that and the sweep's change.
void ConjugateSweeps::move(const SolverPools& pools, btScalar factor) {
  std::size_t i = 0;
  for_each_row(pools, [&](btSolverConstraint& row) {
    const btScalar along = factor * direction_[i];
    row.m_appliedImpulse = btScalar(row.m_appliedImpulse) + along;
    direction_[i] = along + change_[i];
    ++i;
  });
  for (int b = 0; b < pools.bodies->size(); ++b) {
    btSolverBody& body = (*pools.bodies)[b];
    const auto at = static_cast<std::size_t>(b);
    AddedVelocity& direction = velocity_direction_[at];
    const AddedVelocity along{factor * direction.linear, factor * direction.angular};
    body.internalGetDeltaLinearVelocity() += along.linear;
    body.internalGetDeltaAngularVelocity() += along.angular;
    direction = {along.linear + velocity_change_[at].linear,
                 along.angular + velocity_change_[at].angular};
  }
  before_.read(pools);
}

void ConjugateSweeps::go_on(const SolverPools& pools) {
  const double squared = find_change(pools);
  // Where sweeps change more than before, the directions are of other contacts.
  const bool gets_nearer = squared < last_;
  move(pools, gets_nearer ? static_cast<btScalar>(squared / last_) : btScalar(0));
  last_ = squared;
}

}  // namespace voxshell::bullet
