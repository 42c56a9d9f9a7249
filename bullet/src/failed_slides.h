#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "contact_constants.h"
#include "voxshell/contacts.h"
#include "voxshell/pose.h"

namespace voxshell::bullet {

/// The elements of a shell that slid to nothing. As long as the bodies hardly move, they would
/// again, and most of the time of a heap at rest would go into such slides.
class FailedSlides {
 public:
  /// A step begins, in which elements may be asked about and added, both ascending by id.
  /// @param contacts          Those of the shell.
  /// @param field_from_shell  Pose of the shell's frame in the field's.
  /// @param radius            Of the smaller body, metres.
  /// @param forgets           The surfaces are not those of the step before.
  void begin(std::span<const Contact> contacts, const Pose& field_from_shell, double radius,
             bool forgets) {
    before_.swap(now_);
    now_.clear();
    if (contacts.empty()) return;
    const auto place = static_cast<Vec3>(contacts.front().point);
    const Vec3 moved = field_from_shell.transform_point(place) - at_.transform_point(place);
    double turned = 0.0;  // twice the sine of half the angle, or more
    for (int column = 0; column < 3; ++column) {
      Vec3 axis;
      axis[column] = 1.0;
      turned = std::max(turned, length(field_from_shell.rotate(axis) - at_.rotate(axis)));
    }
    if (!forgets && length(moved) + turned * radius <= kFailsAgainOfRadius * radius) return;
    before_.clear();
    at_ = field_from_shell;
  }

  void add(std::uint32_t id) { now_.push_back(id); }

  /// Whether the element slid to nothing when the bodies were last here. It is added again.
  bool fails_again(std::uint32_t id) {
    if (!std::ranges::binary_search(before_, id)) return false;
    add(id);
    return true;
  }

 private:
  Pose at_;  ///< of the shell in the field's frame, where the slides of now_ began to fail
  std::vector<std::uint32_t> before_;  ///< ids, ascending
  std::vector<std::uint32_t> now_;
};

}  // namespace voxshell::bullet
