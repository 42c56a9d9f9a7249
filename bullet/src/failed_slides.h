#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "voxshell/contacts.h"
#include "voxshell/pose.h"

namespace voxshell::bullet {

/// The elements of a shell that slid to nothing. As long as the bodies hardly move, they would
/// again, and most of the time of a heap at rest would go into such slides. Decision 36.
class FailedSlides {
 public:
  /// A step begins, in which elements may be asked about and added, both ascending by id.
  /// @param contacts          Those of the shell.
  /// @param field_from_shell  Pose of the shell's frame in the field's.
  /// @param radius            Of the smaller body, meters.
  /// @param forgets           The surfaces are not those of the step before.
  void begin(std::span<const Contact> contacts, const Pose& field_from_shell, double radius,
             bool forgets);

  void add(std::uint32_t id) { now_.push_back(id); }

  /// Whether the element slid to nothing when the bodies were last here. It is added again.
  bool fails_again(std::uint32_t id);

 private:
  Pose at_;  ///< of the shell in the field's frame, where the slides of now_ began to fail
  std::vector<std::uint32_t> before_;  ///< ids, ascending
  std::vector<std::uint32_t> now_;
};

}  // namespace voxshell::bullet
