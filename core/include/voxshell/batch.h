#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "voxshell/contacts.h"

namespace voxshell {

/// Contacts of many poses, in sequence. Those of pose i are contacts[offsets[i]] to
/// contacts[offsets[i + 1] - 1].
struct ContactBatch {
  std::vector<Contact> contacts;
  std::vector<std::size_t> offsets;  ///< number of poses + 1
};

/// find_contacts() for each pose, on `threads` threads (0: one per core), with the same bits for
/// any number. Error kCanceled if `progress` returned false.
Result<ContactBatch> find_contacts_batch(const Field& field, const PointShell& shell,
                                         std::span<const Pose> field_from_shell,
                                         const ContactOptions& options, unsigned threads = 0,
                                         const Progress& progress = {});

/// collides() for each pose, 1 or 0.
Result<std::vector<char>> collides_batch(const Field& field, const PointShell& shell,
                                         std::span<const Pose> field_from_shell, float margin,
                                         unsigned threads = 0, const Progress& progress = {});

}  // namespace voxshell
