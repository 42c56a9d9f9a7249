#pragma once

#include <vector>

#include "voxshell/contacts.h"

namespace voxshell::bullet {

/// Leaves those contacts of flat patches that span them, in order: whatever forces between two
/// bodies the others can carry, these can. Decision 47.
///
/// @param least  Patches may shrink by this much, meters, or by a small fraction of their width.
/// @param band   Contacts that are deeper than the plane of those that span their patch by at most
///               this are in it, meters.
/// @return Whether the contacts are those of a few flat patches. If not, all are left.
bool leave_outer(double least, float band, std::vector<Contact>& contacts);

}  // namespace voxshell::bullet
