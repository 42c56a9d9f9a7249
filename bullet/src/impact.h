#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "contact_constants.h"
#include "pair_step.h"
#include "voxshell/contacts.h"

namespace voxshell::bullet {

/// A time that never comes, seconds.
inline constexpr double kNever = std::numeric_limits<double>::infinity();

/// How the bodies meet at a contact, along its normal.
struct Impact {
  double gap;                 ///< meters, negative where the bodies overlap
  double approach;            ///< m/s
  double approach_of_forces;  ///< what forces add to it in the step, m/s
  double approach_of_fall;    ///< the same as far as nothing supports the bodies, m/s
  double squared_speed;       ///< in any direction, m^2/s^2

  /// When the surfaces meet or met, seconds from the start of the step on.
  double time() const { return approach > 0.0 ? gap / approach : kNever; }
};

inline Impact impact_of(const PairStep& step, const Contact& contact) {
  const Vec3 velocity = step.motion.velocity_at(static_cast<Vec3>(contact.point));
  const auto normal = static_cast<Vec3>(contact.normal);
  return {-static_cast<double>(contact.depth) - step.thickness, -dot(velocity, normal),
          -dot(step.motion.velocity_of_forces, normal), -dot(step.motion.velocity_of_fall, normal),
          squared_length(velocity)};
}

/// How much of the gap the bodies close within the step if nothing stops them, meters.
inline double closing_of(const PairStep& step, const Impact& impact) {
  return (impact.approach + impact.approach_of_fall) * step.time_step;
}

/// Whether it takes more than a step to cross the rest margin.
inline bool is_slow(const PairStep& step, const Impact& impact) {
  return impact.approach * step.time_step <= step.rest_margin;
}

/// Whether what stops the bodies turns them by little, as they close slowly for their thickness.
inline bool is_gentle(const PairStep& step, const Impact& impact) {
  const double thinnest = std::min(step.pair->a.thinnest(), step.pair->b.thinnest());
  return closing_of(step, impact) <= kGentleOfThickness * thinnest;
}

/// Whether a point is a contact where it is: it penetrates, or is slow and within the rest margin.
inline bool is_contact(const PairStep& step, const Impact& impact) {
  // In this order: nearly all points are slow.
  return (is_slow(step, impact) && impact.gap <= step.rest_margin) || impact.gap < 0.0;
}

}  // namespace voxshell::bullet
