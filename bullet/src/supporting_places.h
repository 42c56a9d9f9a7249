#pragma once

#include <vector>

#include "voxshell/vector.h"

namespace voxshell::bullet {

/// A place at which a contact pushes, or may push, a body.
struct SupportingPlace {
  Vec3 place;   ///< meters
  Vec3 normal;  ///< unit length
  double impulse;
};

/// Places at which contacts pushed in the last step, and at which they may push in this one, in one
/// frame. Decision 59.
struct SupportingPlaces {
  std::vector<SupportingPlace> before;
  std::vector<SupportingPlace> now;

  /// Whether places of now span the middle of those before, weighted by their impulses, or lie
  /// within `aside` meters of it; for each direction of the impulses, up to a fraction of their
  /// sum. Empties `before`.
  bool can_support(double aside);
};

}  // namespace voxshell::bullet
