#include "resting_patch.h"

#include <algorithm>
#include <bit>
#include <cstddef>

#include "contact_constants.h"
#include "contact_list.h"

namespace voxshell::bullet {

void RestingPatch::settle(std::span<Contact> contacts, std::span<const std::uint32_t> exact,
                          double thickness, double band) {
  const float deepest = find_deepest(contacts).depth;
  const double nearest = std::max(-static_cast<double>(deepest) - thickness, 0.0);
  const auto gap_of = [&](const Contact& contact) {
    return -static_cast<double>(contact.depth) - thickness;
  };
  // With room to spare: a body at rest finds a few more contacts now and then.
  if (lifts_.size() < contacts.size()) lifts_.resize(std::bit_ceil(contacts.size()));
  held_.reserve(lifts_.size());
  std::ranges::transform(contacts, lifts_.begin(),
                         [&](const Contact& contact) { return gap_of(contact) - nearest; });
  for (const Held& held : held_) {
    const std::size_t place = find_from_id(contacts, held.id);
    if (place == contacts.size() || contacts[place].id != held.id) continue;
    double& lift = lifts_[place];
    if (lift <= kPatchHeldWithin * band) {
      lift = std::min(held.lift + kPatchForgets * (lift - held.lift), band);
    }
  }
  // Branchless: membership is unpredictable.
  held_.resize(contacts.size());
  std::size_t count = 0;
  for (std::size_t place = 0; place < contacts.size(); ++place) {
    const double lift = lifts_[place];
    held_[count] = {contacts[place].id, static_cast<std::uint32_t>(place), lift};
    count += (lift > 0.0) & (lift <= band) ? 1u : 0u;
  }
  held_.resize(count);
  drop_exact(exact);
  for (const Held& held : held_) {
    Contact& contact = contacts[held.place];
    contact.depth = static_cast<float>(held.lift - gap_of(contact) - thickness);
  }
}

void RestingPatch::drop_exact(std::span<const std::uint32_t> exact) {
  if (exact.empty()) return;
  std::erase_if(held_,
                [&](const Held& held) { return std::ranges::binary_search(exact, held.id); });
}

void RestingPatch::keep(std::span<const Contact> contacts) {
  keep_if(held_, [&](const Held& held) {
    bool is_in = false;
    for (const Contact& contact : contacts) is_in |= contact.id == held.id;
    return is_in;
  });
}

void RestingPatch::release() { held_.clear(); }

}  // namespace voxshell::bullet
