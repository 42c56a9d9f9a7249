#pragma once

#include <vector>

#include "pair_step.h"
#include "shape_features.h"

namespace voxshell::bullet {

/// Appends the walls that corners and rims of Bullet's shapes meet on their way within a step with
/// CCD while they touch something else: what slides across the floor of a bin touches the floor
/// with its lower corners, and would meet the wall with its upper ones alone, and tip over.
///
/// @param features  Of find_features(). As many are appended, whose ids such contacts have: places
/// a little above what the corners touch, from where ways lead to the walls.
/// @param contacts  Those of features.
void append_walls_ahead(const PairStep& step, std::vector<Feature>& features,
                        std::vector<Contact>& contacts);

}  // namespace voxshell::bullet
