#pragma once

#include <optional>
#include <span>

#include "impact.h"
#include "pair_step.h"

namespace voxshell::bullet {

// Where friction holds a pair that rests. One pose for all points: remembered point by point, slips
// that no motion undoes would pull for ever.

/// Whether a contact rests, and so slowly that friction remembers where the bodies are.
bool is_anchored(const PairStep& step, const Impact& impact);

/// The hold of the steps before if some of `contacts` is still where it was taken; else one that is
/// taken now, or none if no contact is anchored. Of b as a sees it.
struct Hold {
  std::optional<Pose> b_from_a;
  /// Takes a point of the shell to where it would be had it not slipped.
  Pose shell_from_held;
};
Hold renew_hold(const PairStep& step, std::span<const Contact> contacts,
                const std::optional<Pose>& b_from_a);

/// How far the point of a contact has slipped along the surface since the hold was taken, meters,
/// in the shell's frame; zero where it has slipped so far that it slides.
Vec3 slip_of(const PairStep& step, const Hold& hold, const Contact& contact);

}  // namespace voxshell::bullet
