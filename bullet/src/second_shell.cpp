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
  by_x_.assign(contacts.begin(), second);
  const auto x_of = [](const Contact& contact) { return contact.point.x; };
  std::ranges::sort(by_x_, {}, x_of);
  const auto is_double = [&](const Contact& contact) {
    const float x = contact.point.x;
    for (auto near = std::ranges::lower_bound(by_x_, x - margin, {}, x_of);
         near != by_x_.end() && near->point.x <= x + margin; ++near) {
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
