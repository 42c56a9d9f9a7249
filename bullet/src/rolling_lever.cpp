#include "rolling_lever.h"

#include <algorithm>
#include <cmath>

#include "contact_constants.h"
#include "contact_list.h"

namespace voxshell::bullet {

double rolling_lever_of(const PairStep& step, std::span<const Contact> contacts,
                        std::span<const std::uint32_t> exact) {
  if (!step.rolls_at_rest || !step.is_still) return 0.0;
  const Vec3f deepest = find_deepest(contacts).point;
  const auto squared_arm = [&](const Contact& contact) {
    return squared_length(contact.point - deepest);
  };
  const Vec3f farthest = contacts[find_largest(contacts, squared_arm)].point - deepest;
  const float radius = length(farthest);
  const double small = kSmallPatchOfRadius * step.ball.radius;
  const bool are_samples = std::ranges::any_of(contacts, [&](const Contact& contact) {
    return !std::ranges::binary_search(exact, contact.id);
  });
  const bool is_small = static_cast<double>(radius) < small;
  if (is_small && (are_samples || radius == 0.0f)) return static_cast<double>(radius);
  float widest = 0.0f;
  for (const Contact& contact : contacts) {
    widest = std::max(widest, squared_length(cross(farthest, contact.point - deepest)));
  }
  const auto width = static_cast<double>(std::sqrt(widest) / radius);
  return width < small ? width : 0.0;
}

}  // namespace voxshell::bullet
