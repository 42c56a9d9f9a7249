#include "swept_hits.h"

#include <algorithm>
#include <cmath>
#include <variant>

#include "contact_constants.h"
#include "contact_list.h"
#include "voxshell/manifold.h"

namespace voxshell::bullet {
namespace {

/// The contact of a place of the shell with the field as they are now.
Contact contact_at(const Field& field, const Pose& field_from_shell, const Contact& later) {
  const auto place = static_cast<Vec3>(later.point);
  const auto in_field = static_cast<Vec3f>(field_from_shell.transform_point(place));
  return std::visit(
      [&](const auto& typed) -> Contact {
        const Vec3 outwards = normalized(static_cast<Vec3>(typed.gradient(in_field)));
        return {later.id, -typed.distance(in_field), later.point,
                static_cast<Vec3f>(field_from_shell.inverse().rotate(outwards))};
      },
      field);
}

}  // namespace

void SweptHits::find(const PairStep& step, const PointShell& shell, const Field& field,
                     bool is_of_field, int level, QueryLists& lists,
                     std::vector<Contact>& contacts) {
  ids_.clear();
  found_.clear();
  const auto touching = -static_cast<float>(step.rest_margin + step.thickness);
  const auto touches = [&](const Contact& contact) { return contact.depth >= touching; };
  PairStep motion = step;
  // What something carries does not fall.
  if (std::ranges::any_of(contacts, touches)) {
    motion.motion_a.velocity_of_fall = {};
    motion.motion_b.velocity_of_fall = {};
  }
  const double wanted = std::ceil(step.farthest_displacement / step.detail);
  const int poses = static_cast<int>(std::clamp(wanted, 1.0, 1.0 * kMostSweptPoses));
  const auto field_from_shell_after = [&](double fraction) {
    const Pose pose = motion.field_from_shell_after(fraction);
    return is_of_field ? pose.inverse() : pose;
  };
  for (int i = 1; i <= poses; ++i) {
    scratch_.borrow(lists);
    const std::span<const Contact> inside =
        find_deepest_per_segment(field, shell, field_from_shell_after(1.0 * i / poses), level,
                                 static_cast<float>(step.thickness), scratch_);
    found_.insert(found_.end(), inside.begin(), inside.end());
  }
  std::ranges::stable_sort(found_, {}, &Contact::id);
  const auto same = std::ranges::unique(found_, {}, &Contact::id);
  found_.erase(same.begin(), same.end());
  const Pose now = field_from_shell_after(0.0);
  for (Contact& contact : found_) contact = contact_at(field, now, contact);
  // What touches now is found already.
  std::erase_if(found_, touches);
  for (const Contact& contact : found_) ids_.push_back(contact.id);
  merge_by_id(found_, contacts);
}

}  // namespace voxshell::bullet
