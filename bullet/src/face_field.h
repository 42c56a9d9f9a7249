#pragma once

#include <cmath>
#include <optional>

#include "contact_constants.h"
#include "voxshell/vector.h"

namespace voxshell::bullet {

/// A place where a surface and that of a field face each other. The surface's frame.
struct Facing {
  Vec3 position;    ///< metres
  Vec3 outwards;    ///< the field's normal there, unit length
  double distance;  ///< by the field, metres
};

/// Turns a direction until the field's normal, where `slide` leads along it, is opposite to it.
/// None where there is no such place near by.
///
/// @param slide   The place of the surface that is farthest along a direction; none where there is
/// none.
/// @param feel    What the field says of a place, as a Facing.
/// @param wanted  By how much the first direction leads away from the surface's normal where it
/// starts.
/// @param follows  Of that turn, the fraction by which the field's normal may turn with it.
/// @param within  Radians by which the two normals may miss each other.
template <class Slide, class Feel>
std::optional<Facing> face_field(Vec3 direction, const Vec3& wanted, double follows, double within,
                                 const Slide& slide, const Feel& feel) {
  Vec3 missed_before;
  double relaxation = 1.0;
  for (int i = 0; i < kMostSlides; ++i) {
    const std::optional<Vec3> position = slide(direction);
    if (!position) return std::nullopt;
    const Facing there = feel(*position);
    // Coarse fields have places without a gradient: there is nowhere to slide to.
    if (there.outwards == Vec3{}) return std::nullopt;
    const Vec3 missed = -there.outwards - direction;
    if (squared_length(missed) <= within * within) return there;
    // A peg in its hole: the field's surface has turned as far, and there is no one deepest place.
    if (i == 0 && dot(missed, wanted) > follows * squared_length(wanted)) return std::nullopt;
    // Aitken's relaxation: the field's surface is curved, too.
    if (i > 0) {
      const Vec3 change = missed - missed_before;
      relaxation *= -dot(missed_before, change) / squared_length(change);
      // The turn has made no difference.
      if (!std::isfinite(relaxation)) return std::nullopt;
    }
    missed_before = missed;
    direction = normalized(direction + relaxation * missed);
  }
  return std::nullopt;
}

}  // namespace voxshell::bullet
