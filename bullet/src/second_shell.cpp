#include "second_shell.h"

#include <algorithm>

#include "contact_constants.h"
#include "contact_list.h"

namespace voxshell::bullet {
namespace {

/// Numbers in slices of equal width, of which there are about as many as numbers at most.
class Slices {
 public:
  Slices(float lowest, float highest, float width, std::size_t most) : lowest_(lowest) {
    const float range = highest - lowest;
    const auto limit = static_cast<float>(most);
    // Not std::clamp(), which would pass on what is no number.
    const float wanted = range < limit * width ? range / width : limit;
    last_ = wanted > 1.0f ? static_cast<std::size_t>(wanted) : 0;
    per_unit_ = range > 0.0f ? static_cast<float>(last_) / range : 0.0f;
  }
  std::size_t count() const { return last_ + 1; }
  /// Of a larger number, no smaller one.
  std::size_t find(float number) const {
    const float at = (number - lowest_) * per_unit_;
    if (!(at > 0.0f)) return 0;
    return at < static_cast<float>(last_) ? static_cast<std::size_t>(at) : last_;
  }

 private:
  float lowest_;
  std::size_t last_;
  float per_unit_;
};

}  // namespace

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
  // With room for rounding.
  const float reach = kSortedReach * margin;
  const auto count = static_cast<std::size_t>(second - contacts.begin());
  const std::span<const Contact> first(contacts.data(), count);
  const Slices slices = [&] {
    float lowest = along(first[0]);
    float highest = lowest;
    for (const Contact& contact : first) {
      lowest = std::min(lowest, along(contact));
      highest = std::max(highest, along(contact));
    }
    return Slices(lowest, highest, reach, count);
  }();
  starts_.assign(slices.count() + 1, 0);
  for (const Contact& contact : first) ++starts_[slices.find(along(contact)) + 1];
  for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
  sorted_.resize(count);
  for (const Contact& contact : first) {
    const float here = along(contact);
    sorted_[starts_[slices.find(here)]++] = {here, contact.point, contact.normal};
  }
  // Each start is now the next one's.
  const auto start_of = [&](std::size_t slice) { return slice == 0 ? 0 : starts_[slice - 1]; };
  const auto is_double = [&](const Contact& contact) {
    const float here = along(contact);
    const std::uint32_t end = starts_[slices.find(here + reach)];
    for (std::uint32_t i = start_of(slices.find(here - reach)); i < end; ++i) {
      const Placed& near = sorted_[i];
      if (squared_length(near.point - contact.point) <= margin * margin &&
          dot(near.normal, contact.normal) >= kDoubleCosine && near.along >= here - reach &&
          near.along <= here + reach) {
        return true;
      }
    }
    return false;
  };
  contacts.erase(std::remove_if(second, contacts.end(), is_double), contacts.end());
}

}  // namespace voxshell::bullet
