#pragma once

#include <optional>
#include <span>
#include <vector>

#include "pair_step.h"
#include "rebound.h"
#include "shape_features.h"
#include "voxshell/contacts.h"

namespace voxshell::bullet {

// Contacts of bodies that will touch within the step (Xu and Barbic 2016): continuous collision
// detection.

/// Follows the point of a contact, its velocity constant, by conservative advancement until it
/// touches. The result has the gap that is left to the point now and the normal of the place that
/// it will reach; none where it touches nothing. Not for triangles.
///
/// @param motion    Of the shell as the field sees it, in the shell's frame.
/// @param features  Those that the ids of contacts from kFirstFeature on count.
/// @param steps     For how long it is followed.
std::optional<Contact> find_speculative(const PairStep& step, const RelativeMotion& motion,
                                        std::span<const Feature> features, const Contact& contact,
                                        double steps);

/// Widens the gap of a plane that a contact is taken for, so that it does not stop a motion of the
/// bodies where nothing is in the way of that. Without forces: what something else carries does not
/// fall, and may pass below a bar whose nearest place, as seen from here, is aslant. Along a bend:
/// the wall on its other side.
///
/// @param found    The contact where it is now.
/// @param allowed  How much nearer than touching the bodies may come by that motion, meters.
void allow_motion(const PairStep& step, const RelativeMotion& motion,
                  std::span<const Feature> features, const Contact& found, double allowed,
                  Contact& plane);

/// The same for the motion that the bodies have once the contacts that touch first have rebounded.
/// Beside the place where two edges cross, the planes of the faces there would be in its way, far
/// past the ends of these faces.
void allow_motion_after(const PairStep& step, const AfterTouch& after,
                        std::span<const Feature> features, const Contact& found, Contact& plane);

/// Moves contacts that were looked for after a fraction of the step to where they are at its start,
/// and drops those that overlap there.
void move_to_start(const PairStep& step, double fraction, std::vector<Contact>& contacts);

}  // namespace voxshell::bullet
