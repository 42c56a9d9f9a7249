#include "turning_contacts.h"

#include <algorithm>

#include "contact_constants.h"
#include "sliding_touch.h"

namespace voxshell::bullet {

void TurningContacts::find(const PairStep& step, std::span<const Contact> contacts,
                           std::span<const std::uint32_t> exact) {
  turning_.clear();
  motions_.clear();
  if (!step.solver_turns_contacts) return;
  const double displacement = length(displacement_of_centers(step));
  if (displacement < kLeastTurn * step.ball.radius) return;
  const double near = std::max(step.rest_margin, kMostGapOfTurn * kMostTurn * displacement);
  for (const Contact& contact : contacts) {
    const Impact impact = impact_of(step, contact);
    if (impact.gap > near || !std::ranges::binary_search(exact, contact.id)) continue;
    turning_.push_back({contact.id, contact.normal, impact, find_turn(step, contact)});
  }
  const Turning* fastest = nullptr;
  for (Turning& turning : turning_) {
    const double turn = mean_beside(turning.normal).value_or(0.0);
    const double gap = turning.impact.gap;
    const bool touches = gap <= std::max(step.rest_margin, kMostGapOfTurn * turn);
    const double closing = turning.impact.approach * step.time_step;
    const bool rebounds =
        step.restitution > 0.0 && closing > kMostClosingOfTurn * turn + std::max(gap, 0.0);
    if (!(turn > 0.0) || !touches || rebounds) continue;
    turning.speed = turn / step.time_step;
    if (fastest == nullptr || turning.speed > fastest->speed) fastest = &turning;
  }
  if (fastest != nullptr) find_motions(step, *fastest);
  std::erase_if(turning_, [](const Turning& turning) { return turning.speed == 0.0; });
}

void TurningContacts::find_motions(const PairStep& step, const Turning& turning) {
  const auto normal = static_cast<Vec3>(turning.normal);
  const double apart = turning.impact.approach + turning.speed;
  RelativeMotion motion = step.motion;
  motion.velocity_of_fall = {};
  motion.velocity = motion.velocity + apart * normal;
  motions_.push_back(motion);
  motion.velocity =
      motion.velocity + step.motion.velocity_of_forces + turning.impact.approach_of_forces * normal;
  motions_.push_back(motion);
}

/// How much nearer the bodies come at the contacts that have a normal, about:
/// both ends of a cylinder, which must not be turned aside because one was not found.
std::optional<double> TurningContacts::mean_beside(const Vec3f& normal) const {
  double sum = 0.0;
  double count = 0.0;
  for (const Turning& other : turning_) {
    if (!other.found || dot(other.normal, normal) < kDoubleCosine) continue;
    sum += *other.found;
    count += 1.0;
  }
  return count > 0.0 ? std::optional(sum / count) : std::nullopt;
}

double TurningContacts::speed_of(std::uint32_t id) const {
  const auto found = std::ranges::lower_bound(turning_, id, {}, &Turning::id);
  return found != turning_.end() && found->id == id ? found->speed : 0.0;
}

}  // namespace voxshell::bullet
