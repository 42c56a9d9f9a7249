#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "voxshell/contacts.h"
#include "voxshell/manifold.h"

namespace voxshell {

/// The oracle of find_contacts(): evaluates every point and every edge segment in order, without
/// the trees.
std::vector<Contact> find_contacts_flat(const Field& field, const PointShell& shell,
                                        const Pose& field_from_shell,
                                        const ContactOptions& options = {});

/// The oracle of find_deepest_per_segment() with arrivals: whether it considers an element of the
/// shell.
bool arrives_flat(const Field& field, const PointShell& shell, std::uint32_t id,
                  std::span<const Arrival> arrivals);

}  // namespace voxshell
