#include "failed_slides.h"

#include <algorithm>

#include "contact_constants.h"

namespace voxshell::bullet {
namespace {

/// How far the axes of two frames are apart: at most twice the sine of half the angle between them,
/// and at least 0.8 of that.
double turn_between(const Pose& a, const Pose& b) {
  double most = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 unit;
    unit[axis] = 1.0;
    most = std::max(most, length(a.rotate(unit) - b.rotate(unit)));
  }
  return most;
}

}  // namespace

void FailedSlides::begin(std::span<const Contact> contacts, const Pose& field_from_shell,
                         double radius, bool forgets) {
  before_.swap(now_);
  now_.clear();
  if (contacts.empty()) return;
  const auto place = static_cast<Vec3>(contacts.front().point);
  const double moved =
      length(field_from_shell.transform_point(place) - at_.transform_point(place)) +
      radius * turn_between(field_from_shell, at_);
  if (!forgets && moved <= kFailsAgainOfRadius * radius) return;
  before_.clear();
  at_ = field_from_shell;
}

bool FailedSlides::fails_again(std::uint32_t id) {
  if (!std::ranges::binary_search(before_, id)) return false;
  add(id);
  return true;
}

}  // namespace voxshell::bullet
