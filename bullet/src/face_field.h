#pragma once

#include <cmath>
#include <optional>

#include "contact_constants.h"
#include "voxshell/pose.h"
#include "voxshell/vector.h"

namespace voxshell::bullet {

/// A place where a surface and that of a field face each other. The surface's frame.
struct Facing {
  Vec3 position;    ///< meters
  Vec3 outwards;    ///< the field's normal there, unit length
  double distance;  ///< by the field, meters
};

/// What a direction is to be turned by for what it misses: Broyden's method (1965), the inverse of
/// minus the derivative. Across a groove that is hardly wider than a ball, the normal turns almost
/// with the direction, and along it hardly at all, so that one factor for both would not do.
class Turn {
 public:
  Vec3 of(const Vec3& missed) const { return by_missed_ * missed; }

  /// @param turned   What the direction was turned by.
  /// @param regained How much less it misses.
  /// @return Whether that has made a difference.
  bool learn(const Vec3& turned, const Vec3& regained) {
    const Vec3 expected = by_missed_ * regained;
    const double scale = 1.0 / dot(turned, expected);
    if (!std::isfinite(scale)) return false;
    const Vec3 wrong = scale * (turned - expected);
    const Vec3 along = by_missed_.transposed() * turned;
    by_missed_.row_x += wrong.x * along;
    by_missed_.row_y += wrong.y * along;
    by_missed_.row_z += wrong.z * along;
    return true;
  }

 private:
  Matrix3 by_missed_;
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
  Vec3 turned;
  Turn turn;
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
    if (i > 0 && !turn.learn(turned, missed_before - missed)) return std::nullopt;
    missed_before = missed;
    const Vec3 next = normalized(direction + turn.of(missed));
    turned = next - direction;
    direction = next;
  }
  return std::nullopt;
}

}  // namespace voxshell::bullet
