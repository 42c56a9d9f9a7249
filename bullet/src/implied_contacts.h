#pragma once

#include <vector>

#include "pair_step.h"
#include "voxshell/contacts.h"

namespace voxshell::bullet {

class TurningContacts;

/// Drops contacts ahead, to which nothing brings the bodies within the step, where others keep the
/// bodies from them: the solver would look at them in vain. Decision 71.
///
/// A contact keeps the bodies on one side of a plane. However the solver makes them move, places
/// move by at most kCcdReach times the farthest displacement, and the bodies turn by at most what
/// that takes at the smaller one's ball. So where one contact holds, the bodies come nearer to
/// another one's plane by at most the first one's gap, and by what that motion makes of the
/// differences of their normals and of their places.
///
/// @param places  The same contacts where they are now.
void drop_implied(const PairStep& step, const TurningContacts& turning,
                  std::vector<Contact>& contacts, std::vector<Contact>& places);

}  // namespace voxshell::bullet
