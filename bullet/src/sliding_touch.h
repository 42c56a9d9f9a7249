#pragma once

#include <optional>

#include "motion.h"
#include "pair_step.h"
#include "voxshell/contacts.h"

namespace voxshell::bullet {

/// A contact that slides until the surfaces touch. Each of them touches with the place that faces
/// the other one then, and where those are now, they need not face each other.
struct Sliding {
  Contact contact;  ///< with the gap that is left to it now, and the normal where they touch
  /// The place of the larger body now, less where it would be if it faced that of the smaller one,
  /// shell's frame, meters.
  Vec3 aside;
  double passed;  ///< how far they move past each other until they touch, meters
  bool faces;     ///< the two normals are opposite then; not on edges
};

/// Follows the place where a round surface faces the other body, as both move: over an edge, a bar
/// or another ball it slides, and what was followed in one place would pass beside them. None where
/// the surfaces do not touch, where the contact is at no such place, and where it cannot be
/// followed. Not for triangles.
///
/// @param motion   Of the shell as the field sees it, in the shell's frame.
/// @param contact  Where it is now.
/// @param steps    For how long it is followed.
std::optional<Sliding> find_sliding(const PairStep& step, const RelativeMotion& motion,
                                    const Contact& contact, double steps);

/// How far the center of the shell's body moves against that of the field's within the step,
/// without forces; shell's frame. Gears that turn against each other do not move.
Vec3 displacement_of_centers(const PairStep& step);

/// How much nearer the bodies come at a contact within the step, if they slide or roll along each
/// other as they do now, meters: on a concave surface. None where no such surface goes on until the
/// end of the step, and where neither body is round. Not for triangles.
std::optional<double> find_turn(const PairStep& step, const Contact& contact);

}  // namespace voxshell::bullet
