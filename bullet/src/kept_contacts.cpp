#include "kept_contacts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "bounds_of_change.h"
#include "contact_constants.h"
#include "contact_list.h"

namespace voxshell::bullet {
KeptContacts::Question KeptContacts::Question::of(const PairStep& step) {
  return {{step.pair->a.key(), step.pair->b.key()},
          step.pair->shell_is_a,
          step.is_still,
          step.uses_ccd,
          step.time_step,
          step.rest_margin,
          step.thickness,
          step.field_from_shell,
          {step.motion, step.if_stopped[0], step.if_stopped[1]}};
}

void KeptContacts::keep(const PairStep& step, std::span<const Contact> found) {
  asked_ = Question::of(step);
  renew(step, found);
}

void KeptContacts::renew(const PairStep& step, std::span<const Contact> contacts) {
  contacts_.assign(contacts.begin(), contacts.end());
  field_from_shell_ = step.field_from_shell;
}

void KeptContacts::reduce_to(std::span<const Contact> chosen) {
  chosen_.clear();
  for (const Contact& contact : chosen) chosen_.push_back(contact.id);
  std::ranges::sort(chosen_);
  keep_if(contacts_,
          [&](const Contact& contact) { return std::ranges::binary_search(chosen_, contact.id); });
}

bool KeptContacts::hold_in(const PairStep& step, bool are_followed) const {
  if (!asked_) return false;
  const Question now = Question::of(step);
  if (now.geometry != asked_->geometry || now.shell_is_a != asked_->shell_is_a ||
      now.is_still != asked_->is_still || now.uses_ccd != asked_->uses_ccd ||
      now.time_step != asked_->time_step || now.rest_margin != asked_->rest_margin ||
      now.thickness != asked_->thickness) {
    return false;
  }
  // Contacts move along by the inverse of the pose, which only rotations have.
  if (!(squared_length(now.field_from_shell.rotation.row_x) < 2.0)) return false;
  const double most = (are_followed ? kKeptOfMargin : kKeptUnfollowedOfMargin) * step.rest_margin;
  if (!(bound_displacement(asked_->field_from_shell, now.field_from_shell, step.middle,
                           step.ball.radius) <= most)) {
    return false;
  }
  for (std::size_t i = 0; i < now.motions.size(); ++i) {
    const double difference =
        bound_difference(asked_->motions[i], now.motions[i], step.middle, step.ball.radius);
    if (!(difference * step.time_step <= most)) return false;
  }
  return true;
}

bool KeptContacts::have_moved_in(const PairStep& step) const {
  return bound_displacement(field_from_shell_, step.field_from_shell, step.middle,
                            step.ball.radius) > kFollowedOfMargin * step.rest_margin;
}

void KeptContacts::move_to(const PairStep& step, std::vector<Contact>& contacts) const {
  contacts.clear();
  if (!asked_) return;
  // How the field's body has moved since, as the shell's sees it.
  const Pose now_from_then = step.field_from_shell.inverse() * field_from_shell_;
  contacts.assign(contacts_.begin(), contacts_.end());
  for (Contact& contact : contacts) {
    const auto normal = static_cast<Vec3>(contact.normal);
    const auto on_shell = static_cast<Vec3>(contact.point);
    const Vec3 on_field =
        now_from_then.transform_point(on_shell + static_cast<double>(contact.depth) * normal);
    // The normal is that of the surface that an element of the other body touches.
    const bool is_of_second = contact.id >= kFirstOfSecond;
    const Vec3 normal_now = is_of_second ? normal : now_from_then.rotate(normal);
    const double depth = dot(on_field - on_shell, normal_now);
    contact.depth = static_cast<float>(depth);
    contact.normal = static_cast<Vec3f>(normal_now);
    if (is_of_second) contact.point = static_cast<Vec3f>(on_field - depth * normal_now);
  }
}

}  // namespace voxshell::bullet
