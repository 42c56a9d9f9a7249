#pragma once

#include "voxshell/contacts.h"
#include "voxshell/field.h"
#include "voxshell/pose.h"

namespace voxshell {

/// Whether another surface than that which the contact names is about as near, so that its depth
/// and normal are arbitrary: in the middle 9 % of a wall, on the axis of a rod, between faces that
/// meet at less than 60 degrees, where a step straight in leads out again; and, in a grid, where
/// the place that depth and normal lead to is off the surface, as beside other ridges of depths.
/// Two evaluations of a field. Contacts of find_inner_contact() are not asked about: they are
/// ambiguous.
bool is_ambiguous(const Contact& contact, const Field& field, const Pose& field_from_shell);

}  // namespace voxshell
