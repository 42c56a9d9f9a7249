#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "voxshell/field.h"
#include "voxshell/point_shell.h"
#include "voxshell/pose.h"

namespace voxshell {

/// One point of the shell inside the field, or within the margin of its surface. Metres, the
/// shell's frame.
struct Contact {
  std::uint32_t id;  ///< of the shell's point
  float depth;       ///< minus the signed distance: positive inside, above -margin
  Vec3f point;       ///< the shell's point
  Vec3f normal;      ///< the field's outward unit normal there

  friend bool operator==(const Contact&, const Contact&) = default;
};

struct ContactOptions {
  float margin = 0.0f;  ///< points with a distance below this are contacts, metres
};

/// The mutable state of queries; one a thread. Reused, it makes a warm query free of allocation.
class QueryScratch {
 public:
  std::vector<Contact> contacts;
};

/// All contacts of a shell in a field, ascending by id (thesis, Algorithm 3.1: walk the
/// point-sphere tree, skip the clusters that cannot reach the surface). Equal bit for bit to
/// contacts_flat(). The result lives in `scratch` until its next use.
std::span<const Contact> find_contacts(const Field& field, const PointShell& shell,
                                       const Pose& field_from_shell, const ContactOptions& options,
                                       QueryScratch& scratch);

/// True if find_contacts() would find any; stops at the first.
bool collides(const Field& field, const PointShell& shell, const Pose& field_from_shell,
              float margin = 0.0f);

}  // namespace voxshell
