#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <BulletDynamics/ConstraintSolver/btSolverBody.h>
#include <BulletDynamics/ConstraintSolver/btSolverConstraint.h>

#include "velocity_newton.h"

namespace voxshell::bullet {

/// What Bullet's solver has set up for an island; all of it belongs to the solver.
struct SolverPools {
  btAlignedObjectArray<btSolverBody>* bodies;
  btConstraintArray* joints;
  btConstraintArray* contacts;
  btConstraintArray* friction;
  btConstraintArray* rolling;
};

/// What impulses have added to a body's velocity.
struct AddedVelocity {
  btVector3 linear;   ///< m/s
  btVector3 angular;  ///< rad/s
};
AddedVelocity added_velocity(const btSolverBody& body);

template <class Visit>
void for_each_row(const SolverPools& pools, const Visit& visit) {
  for (btConstraintArray* rows : {pools.joints, pools.contacts, pools.friction, pools.rolling}) {
    for (int i = 0; i < rows->size(); ++i) visit((*rows)[i]);
  }
}

/// Whether impulses change the body's velocity.
bool can_move(const btSolverBody& body);

/// The velocity along a row that the impulses so far have added.
btScalar added_velocity(const btSolverConstraint& row, const btSolverBody& a,
                        const btSolverBody& b);

/// Lets the row's impulse, N s, be `impulse`.
///
/// @return The velocity along the row that this changes, squared: what the solver's residual is of.
btScalar set_impulse(btSolverConstraint& row, btSolverBody& a, btSolverBody& b, btScalar impulse);

/// The impulses of all rows, and what they have added to the velocities of bodies.
///
/// Velocities are kept, too: those that follow from the difference of two sets of impulses are
/// rounded to the larger set, and a solve that diverges makes that large.
class SolverState {
 public:
  void read(const SolverPools& pools);
  void write(const SolverPools& pools) const;

  std::span<const btScalar> impulses() const { return impulses_; }           ///< of the rows, N s
  std::span<const AddedVelocity> velocities() const { return velocities_; }  ///< of the bodies

 private:
  std::vector<btScalar> impulses_;
  std::vector<AddedVelocity> velocities_;
};

/// Bullet's rows of an island as VelocityNewton takes them.
class IslandProblem {
 public:
  /// How sliding contacts are kept from opening.
  enum class Sliding {
    kIgnored,    ///< not at all: right where nothing slides
    kCorrected,  ///< by the speed at which each slides now
  };

  /// Whether Newton's method pays for the island.
  bool prepare(const SolverPools& pools);
  /// Whether the island, which was prepared, has few bodies but for those that joints hold.
  bool is_small() const;

  /// Changes all impulses to those of Newton's method.
  ///
  /// @return Whether it has converged. If not, the impulses are what they were.
  bool solve(const SolverPools& pools, double stiffness, Sliding sliding);

  /// The largest velocity by which the impulses so far miss Coulomb's law or a joint, m/s.
  double error(const SolverPools& pools);

 private:
  /// Roots of a body's inverse mass and inertia.
  struct Scale {
    btVector3 linear;
    btMatrix3x3 angular;
  };

  void number_bodies(const SolverPools& pools);
  void fill(const SolverPools& pools);
  void fill_contact(const SolverPools& pools, btSolverConstraint& contact, int friction_rows);
  void renew(const SolverPools& pools, Sliding sliding);
  double sliding_of(const SolverPools& pools, std::size_t row) const;
  VelocityRow& append(btSolverConstraint& source);
  int place(int body, const btVector3& linear, const btVector3& angular,
            std::array<double, 6>& along) const;

  VelocityNewton newton_;
  std::vector<int> numbers_;  ///< of solver bodies among those that move
  std::vector<Scale> scales_;
  std::vector<VelocityRow> rows_;
  std::vector<btSolverConstraint*> sources_;  ///< of the rows
  std::size_t first_contact_ = 0;             ///< of the rows; joints come before
  std::size_t first_rolling_ = 0;             ///< rolling friction comes last
};

}  // namespace voxshell::bullet
