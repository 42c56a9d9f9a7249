#pragma once

#include "posed_pair.h"

namespace voxshell::bullet {

/// Whether two models, as they move now, may come to be deeper in each other within the step than
/// `depth`, meters. Their shells are looked up at poses on the way, so near each other that neither
/// passes through the other one between two of them. True where kMostPosesOnTheWay are not enough,
/// and for pairs with another shape.
bool may_be_deep_on_the_way(const PosedPair& pair, double time_step, double depth);

}  // namespace voxshell::bullet
