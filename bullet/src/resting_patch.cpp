#include "resting_patch.h"

#include <algorithm>

namespace voxshell::bullet {

void RestingPatch::settle(std::span<Contact> contacts, double thickness, double band) {
  // Of what has moved since, in each step: else errors of the solver add up to a tilt of the patch
  // that it is then held to.
  constexpr double kForgotten = 0.01;
  // Points that hold do so for a while beyond the band, or a body rocks about its edge.
  constexpr double kLetGo = 2.0;
  const float deepest = std::ranges::max_element(contacts, {}, &Contact::depth)->depth;
  const double nearest = std::max(-static_cast<double>(deepest) - thickness, 0.0);
  held_.swap(before_);
  held_.clear();
  auto before = before_.begin();
  for (Contact& contact : contacts) {
    const double gap = -static_cast<double>(contact.depth) - thickness;
    double lift = gap - nearest;
    before = std::find_if(before, before_.end(),
                          [&](const Held& held) { return held.id >= contact.id; });
    if (before != before_.end() && before->id == contact.id && lift <= kLetGo * band) {
      lift = std::min(before->lift + kForgotten * (lift - before->lift), band);
    }
    if (lift <= 0.0 || lift > band) continue;
    contact.depth = static_cast<float>(lift - gap - thickness);
    held_.push_back({contact.id, lift});
  }
}

void RestingPatch::keep(std::span<const Contact> contacts) {
  std::erase_if(held_, [&](const Held& held) {
    return std::ranges::find(contacts, held.id, &Contact::id) == contacts.end();
  });
}

void RestingPatch::release() { held_.clear(); }

}  // namespace voxshell::bullet
