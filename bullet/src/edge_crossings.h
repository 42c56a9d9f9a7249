#pragma once

#include <vector>

#include "posed_pair.h"

namespace voxshell::bullet {

/// Moves contacts of edges that lean to where these cross the edge at which the other body's
/// surface ends, if that is about as near as `way`, meters. The normal there is square to both.
/// The field's own normal beside the crossing is that of the surface, and what tips over an edge
/// would be pushed upward by it alone.
void cross_edges(std::vector<Contact>& contacts, const Side& own, const Side& other,
                 const Pose& field_from_shell, double way);

}  // namespace voxshell::bullet
