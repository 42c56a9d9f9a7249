#pragma once

#include <vector>

#include "voxshell/contacts.h"

namespace voxshell {

/// The oracle of find_contacts(): evaluates every point and every edge segment in order, without
/// the trees.
std::vector<Contact> find_contacts_flat(const Field& field, const PointShell& shell,
                                        const Pose& field_from_shell,
                                        const ContactOptions& options = {});

}  // namespace voxshell
