#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "posed_pair.h"

namespace voxshell::bullet {

/// The id of the contact of a body of which no part of the surface touches.
inline constexpr std::uint32_t kInnerContact = kFirstOfSecond + 0x7ff00000u;
/// The id of contacts of bodies that turn into each other.
inline constexpr std::uint32_t kEndContact = kInnerContact + 1u;

/// A contact of the second shell as one of the first: its point is the place on the first body's
/// surface, its normal that of the field's side. `field_from_shell` is of the second query.
Contact turn_over(const Contact& contact, const Pose& field_from_shell);

/// Where a point of the second shell is: where the field's side touches. The first shell's frame.
inline Vec3 place_of_second(const Contact& contact) {
  return static_cast<Vec3>(contact.point) +
         static_cast<double>(contact.depth) * static_cast<Vec3>(contact.normal);
}

/// Adds what the second shell of a pair finds to what the first found.
class SecondShell {
 public:
  /// Appends contacts of the second shell, with ids from kFirstOfSecond on.
  void append(std::span<const Contact> found, const Pose& field_from_shell,
              std::vector<Contact>& contacts);

  /// Drops contacts of the second shell where one of the first is as near as `margin`, meters, and
  /// has the same normal, within ten degrees: manifolds need not hold both.
  void drop_doubles(float margin, std::vector<Contact>& contacts);

 private:
  /// A contact of the first shell.
  struct Placed {
    float along;  ///< one direction
    Vec3f point;
    Vec3f normal;
  };
  std::vector<Placed> sorted_;         ///< by slices across it, these ascending
  std::vector<std::uint32_t> starts_;  ///< of the slices, and of one more
};

}  // namespace voxshell::bullet
