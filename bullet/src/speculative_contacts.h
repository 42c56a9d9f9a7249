#pragma once

#include <optional>
#include <span>
#include <vector>

#include "pair_step.h"
#include "shape_features.h"
#include "voxshell/contacts.h"

namespace voxshell::bullet {

// Contacts of bodies that will touch within the step (Xu and Barbic 2016): continuous collision
// detection.

/// Follows the point of a contact, its velocity constant, by conservative advancement until it
/// touches. The result has the gap that is left to the point now and the normal of the place that
/// it will reach; none where it touches nothing. Not for triangles.
///
/// @param steps     For how long it is followed.
/// @param features  Those that the ids of contacts from kFirstFeature on count.
std::optional<Contact> find_speculative(const PairStep& step, std::span<const Feature> features,
                                        const Contact& contact, double steps);

/// Moves contacts that were looked for after a fraction of the step to where they are at its start,
/// and drops those that overlap there.
void carry_back(const PairStep& step, double fraction, std::vector<Contact>& contacts);

}  // namespace voxshell::bullet
