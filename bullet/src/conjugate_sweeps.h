#pragma once

#include <vector>

#include <LinearMath/btScalar.h>

#include "island_problem.h"

namespace voxshell::bullet {

/// Nonlinear conjugate gradients on top of sweeps (Silcowitz-Hansen, Niebe and Erleben 2010, A
/// nonsmooth nonlinear conjugate gradient method for interactive contact force problems).
///
/// What a sweep changes is taken for the gradient, and the impulses go on along a direction that is
/// conjugate to those before. The next sweep puts back within its limits what has left them.
class ConjugateSweeps {
 public:
  /// Before the first sweep.
  void begin(const SolverPools& pools);
  /// After a sweep that another one follows.
  void go_on(const SolverPools& pools);

 private:
  double find_change(const SolverPools& pools);
  void move(const SolverPools& pools, btScalar factor);

  SolverState before_;            ///< the sweep
  std::vector<btScalar> change_;  ///< of the impulses, by the sweep
  std::vector<btScalar> direction_;
  std::vector<AddedVelocity> velocity_change_;
  std::vector<AddedVelocity> velocity_direction_;
  double last_ = 0.0;  ///< the squared length of the last sweep's change, J
};

}  // namespace voxshell::bullet
