#pragma once

#include <vector>

#include "voxshell/contacts.h"

namespace voxshell::bullet {

/// Leaves those contacts of flat patches that span them, in order: whatever forces between two
/// bodies the others can carry, these can. Decision 47.
///
/// @param tolerance  By how much the patches may shrink, metres.
/// @param band       Contacts that are deeper than the plane of those that span their patch by at
///                   most this are in it, metres.
/// @return Whether the contacts are those of a few flat patches. If not, all are left.
bool leave_outer(double tolerance, float band, std::vector<Contact>& contacts);

}  // namespace voxshell::bullet
