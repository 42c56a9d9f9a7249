#pragma once

#include <cstdint>
#include <span>

#include "pair_step.h"
#include "voxshell/contacts.h"

namespace voxshell::bullet {

/// The lever, meters, of the torque that the contacts of a still body withstand where it is so
/// short that the solver would hardly feel it: of points all around one, their distance from it; of
/// points in a long row, its width. So it is of points in any row that are no samples: there is
/// nothing between and beside them. 0 where the lever is longer. `contacts` is not empty.
///
/// @param exact  Ids, ascending, of those that are no samples: see RoundContacts.
double rolling_lever_of(const PairStep& step, std::span<const Contact> contacts,
                        std::span<const std::uint32_t> exact);

}  // namespace voxshell::bullet
