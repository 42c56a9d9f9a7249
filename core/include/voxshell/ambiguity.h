#pragma once

#include "voxshell/contacts.h"
#include "voxshell/field.h"
#include "voxshell/pose.h"

namespace voxshell {

/// Whether another surface is about as near as the contact's, so that its depth and normal are
/// arbitrary. This is so in the middle 9 % of a wall, on the axis of a rod, and between faces that
/// meet at less than 60 degrees: a step straight in leads out again there. In a grid, it is also so
/// if the place that depth and normal lead to is off the surface, as beside other ridges of depth.
/// Costs two evaluations of a field. Do not pass contacts of find_inner_contact(): they are always
/// ambiguous.
bool is_ambiguous(const Contact& contact, const Field& field, const Pose& field_from_shell);

}  // namespace voxshell
