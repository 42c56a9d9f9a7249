#pragma once

#include <cstddef>
#include <vector>

#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>

#include "island_problem.h"

namespace voxshell::bullet {

/// Contacts of bodies that joints connect, as that of a door on a hinge with the ground.
///
/// The joint and the contact of rigid bodies can press against each other as hard as it takes to
/// keep the bodies from sliding, and where a joint pulls a body by a micrometer into another one,
/// without end.
class BracedContacts {
 public:
  /// Finds them among the rows of an island.
  void find(const SolverPools& pools);

  bool empty() const { return contacts_.empty(); }

  /// How hard they are pressed together, N s.
  double sum_of_impulses(const SolverPools& pools) const;

  /// Lets them give way by a small depth, at what the forces and motors of the island can press two
  /// bodies by.
  void soften(const SolverPools& pools, const btContactSolverInfo& info) const;

 private:
  std::size_t first_of_group(int solver_body);

  std::vector<std::size_t> joined_to_;  ///< another body of its group, or itself, by solver body
  std::vector<int> contacts_;           ///< among the island's
};

}  // namespace voxshell::bullet
