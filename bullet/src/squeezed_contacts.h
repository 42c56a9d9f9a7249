#pragma once

#include <cstddef>
#include <vector>

#include <BulletDynamics/ConstraintSolver/btContactSolverInfo.h>

#include "island_problem.h"

namespace voxshell::bullet {

/// Finds bodies that are squeezed: that cannot be pushed out of all that they are in, as what is
/// between two kinematic fingers.
///
/// Rigid bodies leave the force of such contacts open. Split impulses, which change poses alone,
/// leave it at nothing, and then friction does not hold what is squeezed.
class SqueezedContacts {
 public:
  /// Lets the contacts of squeezed bodies give way like stiff springs, whose force goes with depth.
  ///
  /// Call it when the split impulses of `pools` are solved, before its other rows are. These
  /// contacts lose their split impulses, which would move bodies aside against no friction.
  void soften(const SolverPools& pools, const btContactSolverInfo& info);

 private:
  /// Bodies that can move and that split impulses join.
  struct Group {
    btScalar support = 0;    ///< split impulses by what cannot move, N s
    btScalar momentum = 0;   ///< that split impulses give to its bodies, turns included, N s
    btScalar asked = 0;      ///< work of its split impulses if bodies moved as these ask, J
    btScalar done = 0;       ///< the same as the bodies do move
    bool is_driven = false;  ///< by a kinematic body
  };
  struct Body {
    std::size_t joined_to;  ///< another body of its group, or itself
    btScalar work = 0;      ///< of the split impulses on it, J: twice its kinetic energy
    Group group = {};       ///< if it is joined to itself
  };

  void join_bodies(const SolverPools& pools);
  void sum_contacts(const SolverPools& pools);
  void sum_bodies(const SolverPools& pools);
  std::size_t first_of_group(int solver_body);
  bool is_squeezed(int solver_body, const SolverPools& pools);

  std::vector<Body> bodies_;  ///< by solver body; kept for its memory
};

}  // namespace voxshell::bullet
