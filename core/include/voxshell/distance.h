#pragma once

#include <optional>

#include "voxshell/contacts.h"

namespace voxshell {

/// The element of the shell with the smallest distance to the field's surface, if any is below
/// `max_distance`: the nearest where the bodies are apart, the deepest where they overlap (its
/// depth is minus the distance). Ties go to the smaller id. By branch and bound on the point-sphere
/// tree.
std::optional<Contact> find_nearest(const Field& field, const PointShell& shell,
                                    const Pose& field_from_shell, float max_distance,
                                    QueryScratch& scratch);

}  // namespace voxshell
