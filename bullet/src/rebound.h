#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include "impact.h"
#include "pair_step.h"

namespace voxshell::bullet {

/// Which contacts of a step touch first: a rebound of the first leaves no later ones.
struct FirstTouch {
  double time = kNever;   ///< seconds from the start of the step on
  std::size_t count = 0;  ///< contacts that touch then

  bool includes(const PairStep& step, const Impact& impact) const;
};

/// When the first of `contacts` touches, if any does within the step; its count is 0.
FirstTouch find_first_touch(const PairStep& step, std::span<const Contact> contacts);

/// What the contacts that touch first leave of the step.
struct AfterTouch {
  double fraction;        ///< of the step, at which they touch
  RelativeMotion motion;  ///< from then on, of the shell as the field sees it, in the shell's frame
};

/// The motion with which two bodies leave the contacts that touch first, without friction and with
/// nothing else in the way; none without a rebound, of links, and where the bodies move too far in
/// the step to rely on it.
std::optional<AfterTouch> find_motion_after(const PairStep& step, const FirstTouch& first,
                                            std::span<const Contact> contacts);

/// The speed apart that a step ends with.
struct Rebound {
  double speed;  ///< m/s
  /// J/kg along the normal: where the rebound's apex is below the place where the step begins, the
  /// body stops at the surface, and the next step gives it this energy.
  double owed_energy;
};

/// That of a contact after its gap. Bullet's integration keeps v^2 / 2 + g x - g dt v / 2 along the
/// normal; the speed is that at which this is what a rebound at the surface would leave.
Rebound rebound_of(const PairStep& step, const Impact& impact);

/// How Bullet's solver is made to end the step with a rebound.
struct SolverRebound {
  double restitution;    ///< the solver aims at restitution * approach - gap / time step
  double first_impulse;  ///< where the solver starts if the point is new, N s
};
SolverRebound rebound_for_solver(const PairStep& step, const FirstTouch& first,
                                 const Impact& impact);

}  // namespace voxshell::bullet
