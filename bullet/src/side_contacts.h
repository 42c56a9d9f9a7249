#pragma once

#include <vector>

#include "pair_step.h"
#include "voxshell/contacts.h"

namespace voxshell::bullet {

/// Whether a point of the larger body lies beside the smaller one rather than under it: its surface
/// goes on in front of it, so that nothing can come at it from where the normal says. On a ground
/// of points as far apart as the body is large, those in front of its sides would stop it. Where
/// both shells are asked, points of either body are looked at.
bool is_beside(const PairStep& step, const Contact& contact);

/// Drops such contacts. For pairs that others hold.
void drop_beside(const PairStep& step, std::vector<Contact>& contacts);

}  // namespace voxshell::bullet
