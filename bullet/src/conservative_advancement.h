#pragma once

#include <algorithm>
#include <optional>

#include "contact_constants.h"
#include "voxshell/vector.h"

namespace voxshell::bullet {

/// How far a moving thing is from touching, and how far it can move, in any direction, without
/// touching. Meters.
struct Clearance {
  double gap;
  double safe_displacement;
};

/// Where on its way a moving thing first touches.
struct Advance {
  double fraction;  ///< of the displacement
  double gap;       ///< that is left there, meters
};

/// Conservative advancement (Mirtich 1996): moves by what is safe until the gap is at most
/// `touching`. None if that is not so up to `end`, a fraction of the displacement. Where
/// kMostAdvances are not enough, the way counts as touching where they end, with the gap there.
///
/// @param measure  The Clearance at a fraction of the displacement.
/// @param length   No part of the moving thing moves farther, meters.
template <class Measure>
std::optional<Advance> advance(double length, double touching, double end, const Measure& measure) {
  Advance reached{0.0, 0.0};
  for (int i = 0; i < kMostAdvances; ++i) {
    const Clearance clearance = measure(reached.fraction);
    reached.gap = clearance.gap;
    if (reached.gap <= touching) return reached;
    const double next = reached.fraction + clearance.safe_displacement / length;
    if (!(next <= end)) return std::nullopt;
    reached.fraction = next;
  }
  return reached;
}

/// Of a place in a field, whose surface is where the field is `offset`: a bold displacement where
/// the field's own lower bound says that it is safe (decision 14), else one that no trilinear cell
/// is steep enough to make unsafe.
template <class F>
Clearance clearance_of(const F& field, const Vec3f& place, double offset) {
  const double gap = static_cast<double>(field.distance(place)) - offset;
  const double bold = kBoldOfGap * gap;
  const bool is_safe =
      static_cast<double>(field.lower_bound(place, static_cast<float>(bold))) >= offset;
  return {gap, is_safe ? bold : kSafeOfGap * gap};
}

}  // namespace voxshell::bullet
