#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "impact.h"
#include "pair_step.h"

namespace voxshell::bullet {

class FreeBodies;

/// Which contacts of a step touch first.
struct FirstTouch {
  double time = kNever;  ///< seconds from the start of the step on

  bool includes(const PairStep& step, const Impact& impact) const;
};

/// When the first of `contacts` touches, if any does within the step.
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

/// Which contacts of a step rebound: those that touch first, and those that touch later, at right
/// angles, and that the rebounds of the earlier ones leave alone: the walls of a corner.
class Rebounding {
 public:
  /// Of contacts ascending by id.
  void find(const PairStep& step, const FirstTouch& first, std::span<const Contact> contacts);
  /// How many rebound at the same time as the contact, itself included; 0 if it does not.
  std::size_t count_with(std::uint32_t id) const;

 private:
  struct Touch {
    std::uint32_t id;
    std::uint32_t index;  ///< among the contacts
    Impact impact;
    std::size_t count = 0;  ///< as count_with() has it
    bool is_free = true;    ///< from what rebounds before it
    bool is_now = false;    ///< rebounds at the time that is looked at
  };

  std::size_t find_together(const PairStep& step, std::span<const Contact> contacts, double time,
                            bool goes_on, FreeBodies& bodies);
  bool is_of_another_wall(const PairStep& step, std::span<const Contact> contacts,
                          const Contact& contact) const;

  std::vector<Touch> touches_;
  std::vector<Touch*> later_;  ///< those that may rebound now
};

/// The speed apart that a step ends with.
struct Rebound {
  double speed;  ///< m/s
  /// Twice the energy per mass along the normal, m2/s2: where the rebound's apex is below the place
  /// where the step begins, the body stops at the surface, and the next step gives it this energy.
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
/// @param count  The contacts that rebound with this one: see Rebounding.
SolverRebound rebound_for_solver(const PairStep& step, std::size_t count, const Impact& impact);

}  // namespace voxshell::bullet
