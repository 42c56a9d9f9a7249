#include "friction_anchor.h"

#include <algorithm>
#include <cmath>

#include "contact_constants.h"

namespace voxshell::bullet {
namespace {

Vec3 measure_slip(const Hold& hold, const Contact& contact) {
  const auto point = static_cast<Vec3>(contact.point);
  const auto normal = static_cast<Vec3>(contact.normal);
  const Vec3 slip = point - hold.shell_from_held.transform_point(point);
  return slip - dot(slip, normal) * normal;
}

bool is_held(const PairStep& step, const Vec3& slip) {
  const double limit = kHeldOfMargin * step.rest_margin;
  return squared_length(slip) <= limit * limit;
}

}  // namespace

bool is_anchored(const PairStep& step, const Impact& impact) {
  return is_slow(step, impact) && std::abs(impact.gap) <= step.rest_margin &&
         impact.squared_speed * step.time_step * step.time_step <=
             step.rest_margin * step.rest_margin;
}

Hold renew_hold(const PairStep& step, std::span<const Contact> contacts,
                const std::optional<Pose>& b_from_a) {
  const bool shell_is_a = step.pair->shell_is_a;
  const auto may_hold = [&](const Contact& contact) {
    return is_anchored(step, impact_of(step, contact));
  };
  if (b_from_a) {
    const Hold before{
        b_from_a, step.field_from_shell.inverse() * (shell_is_a ? *b_from_a : b_from_a->inverse())};
    const auto still_holds = [&](const Contact& contact) {
      return is_held(step, measure_slip(before, contact)) && may_hold(contact);
    };
    if (std::ranges::any_of(contacts, still_holds)) return before;
  }
  if (!std::ranges::any_of(contacts, may_hold)) return {};
  return {shell_is_a ? step.field_from_shell : step.field_from_shell.inverse(), Pose{}};
}

Vec3 slip_of(const PairStep& step, const Hold& hold, const Contact& contact) {
  const Vec3 slip = measure_slip(hold, contact);
  return is_held(step, slip) ? slip : Vec3{};
}

}  // namespace voxshell::bullet
