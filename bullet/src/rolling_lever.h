#pragma once

#include <span>

#include "pair_step.h"
#include "voxshell/contacts.h"

namespace voxshell::bullet {

/// The lever, metres, of the torque that the contacts of a still body withstand where it is so
/// short that the solver would hardly feel it: of points all around one, their distance from it; of
/// points in a long row, its width. 0 where the lever is longer. `contacts` is not empty.
double rolling_lever_of(const PairStep& step, std::span<const Contact> contacts);

}  // namespace voxshell::bullet
