#pragma once

#include "pair_step.h"
#include "voxshell/contacts.h"

namespace voxshell::bullet {

/// Whether a point or edge of the larger body lies beside the smaller one rather than under it: its
/// surface goes on in front of it, so that nothing can come at it from where the normal says. On a
/// ground of points as far apart as the body is large, those in front of its sides would stop it.
/// Where both shells are asked, points of either body are looked at.
///
/// @param contact   Where the point is now.
/// @param normal    The normal that it is to have, which may be that of a place that it will reach.
bool is_beside(const PairStep& step, const Contact& contact, const Vec3f& normal);

/// Whether a sample that does not touch yet is of a part that cannot come to face the other body
/// within the step: an edge of that part, which has elements of its own, then touches first. Of
/// shells without edges, never.
bool is_steep(const PairStep& step, const Contact& contact);

}  // namespace voxshell::bullet
