#include "second_shell.h"

#include <algorithm>

#include "contact_constants.h"
#include "contact_list.h"

namespace voxshell::bullet {

Contact turn_over(const Contact& contact, const Pose& field_from_shell) {
  const auto normal = static_cast<Vec3>(contact.normal);
  const Vec3 on_field =
      static_cast<Vec3>(contact.point) + static_cast<double>(contact.depth) * normal;
  return {kFirstOfSecond + contact.id, contact.depth,
          static_cast<Vec3f>(field_from_shell.transform_point(on_field)),
          static_cast<Vec3f>(-field_from_shell.rotate(normal))};
}

void SecondShell::append(std::span<const Contact> found, const Pose& field_from_shell,
                         std::vector<Contact>& contacts) {
  for (const Contact& contact : found) contacts.push_back(turn_over(contact, field_from_shell));
}

void SecondShell::drop_doubles(float margin, std::vector<Contact>& contacts) {
  const auto second =
      contacts.begin() + static_cast<std::ptrdiff_t>(find_from_id(contacts, kFirstOfSecond));
  if (second == contacts.begin() || second == contacts.end()) return;
  // Aslant, as the points of an edge share a coordinate.
  constexpr Vec3f kAslant{0.48f, 0.6f, 0.64f};
  const auto along = [&](const Contact& contact) { return dot(contact.point, kAslant); };
  sorted_.clear();
  for (auto first = contacts.begin(); first != second; ++first) {
    sorted_.push_back({along(*first), first->point, first->normal});
  }
  std::ranges::sort(sorted_, {}, &Placed::along);
  // With room for rounding.
  const float reach = kSortedReach * margin;
  const auto is_double = [&](const Contact& contact) {
    const float here = along(contact);
    for (auto near = std::ranges::lower_bound(sorted_, here - reach, {}, &Placed::along);
         near != sorted_.end() && near->along <= here + reach; ++near) {
      if (squared_length(near->point - contact.point) <= margin * margin &&
          dot(near->normal, contact.normal) >= kDoubleCosine) {
        return true;
      }
    }
    return false;
  };
  contacts.erase(std::remove_if(second, contacts.end(), is_double), contacts.end());
}

}  // namespace voxshell::bullet
