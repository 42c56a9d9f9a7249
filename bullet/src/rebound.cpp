#include "rebound.h"

#include <algorithm>
#include <cmath>

#include "contact_constants.h"

namespace voxshell::bullet {

namespace {

/// Others are there in case the solver turns the body.
bool touches_within(const PairStep& step, const Impact& impact) {
  return is_contact(step, impact) || closing_of(step, impact) >= impact.gap;
}

}  // namespace

bool FirstTouch::includes(const PairStep& step, const Impact& impact) const {
  return touches_within(step, impact) && time < kNever &&
         impact.time() <= time + kFirstTouchWithin * step.time_step;
}

FirstTouch find_first_touch(const PairStep& step, std::span<const Contact> contacts) {
  FirstTouch first;
  for (const Contact& contact : contacts) {
    const Impact impact = impact_of(step, contact);
    if (touches_within(step, impact)) first.time = std::min(first.time, impact.time());
  }
  return first;
}

std::optional<AfterTouch> find_motion_after(const PairStep& step, const FirstTouch& first,
                                            std::span<const Contact> contacts) {
  const PosedPair& pair = *step.pair;
  const bool has_link = step.motion_a.is_link || step.motion_b.is_link;
  if (!(first.time < kNever) || has_link || step.time_step == 0.0) return std::nullopt;
  // Friction and other bodies may make it another motion, which must not lead through a body.
  const double thinnest = std::min(pair.a.thinnest(), pair.b.thinnest());
  if (!(step.restitution > 0.0) ||
      step.farthest_displacement > kCcdOfThickness * std::min(thinnest, step.radius)) {
    return std::nullopt;
  }
  const Pose& world_from_shell = pair.shell_side().world_from_geometry();
  Motion shell = pair.shell_is_a ? step.motion_a : step.motion_b;
  Motion field = pair.shell_is_a ? step.motion_b : step.motion_a;
  for (int i = 0; i < kReboundSweeps; ++i) {
    for (const Contact& contact : contacts) {
      const Impact impact = impact_of(step, contact);
      if (!first.includes(step, impact)) continue;
      const Vec3 at = world_from_shell.transform_point(static_cast<Vec3>(contact.point));
      const Vec3 normal = world_from_shell.rotate(static_cast<Vec3>(contact.normal));
      const auto speed_apart = [&](const Motion& of_shell, const Motion& of_field) {
        return dot(of_shell.velocity_at(at) - of_field.velocity_at(at), normal);
      };
      const double speed = speed_apart(shell, field);
      const double missing = step.restitution * impact.approach - speed;
      const double response =
          speed_apart(shell.pushed(normal, at), field.pushed(-normal, at)) - speed;
      if (!(missing > 0.0) || !(response > 0.0)) continue;
      const Vec3 impulse = missing / response * normal;
      shell = shell.pushed(impulse, at);
      field = field.pushed(-impulse, at);
    }
  }
  return AfterTouch{std::clamp(first.time / step.time_step, 0.0, 1.0),
                    RelativeMotion::of(shell, field, world_from_shell)};
}

Rebound rebound_of(const PairStep& step, const Impact& impact) {
  const double v = impact.approach;
  const double gap = std::max(impact.gap, 0.0);
  // Without a step there is nothing that a gap is crossed in.
  if (step.time_step == 0.0 || (gap == 0.0 && step.owed_energy == 0.0)) {
    return {step.restitution * v, 0.0};
  }
  const double g_dt = impact.approach_of_forces;
  const double climb = 2.0 * gap * g_dt / step.time_step;
  const double energy =
      std::max(step.restitution * step.restitution * (v * v + climb + g_dt * v), step.owed_energy);
  const double square = 0.25 * g_dt * g_dt + energy - climb;
  const double speed = square > 0.0 ? std::sqrt(square) - 0.5 * g_dt : -1.0;
  if (speed < 0.0) return {-gap / step.time_step, energy};
  return {speed, 0.0};
}

SolverRebound rebound_for_solver(const PairStep& step, const FirstTouch& first,
                                 const Impact& impact) {
  SolverRebound rebound{step.restitution, 0.0};
  if (!(impact.approach > 0.0) || step.time_step == 0.0) return rebound;
  // A point that only stops approaching: if those that come later rebounded as well, ten iterations
  // of Bullet's solver would leave the body with too much energy.
  if (!first.includes(step, impact)) return {0.0, 0.0};
  const double speed = rebound_of(step, impact).speed;
  // The solver of multibodies takes the approach with what forces have added to it.
  const double of_gap = impact.gap > 0.0 ? impact.gap / step.time_step : 0.0;
  const bool has_link = step.motion_a.is_link || step.motion_b.is_link;
  const double approach = impact.approach + (has_link ? impact.approach_of_forces : 0.0);
  if ((of_gap > 0.0 || step.owed_energy > 0.0 || has_link) && approach > 0.0) {
    rebound.restitution = (speed + of_gap) / approach;
  }
  // From 0, ten iterations leave a body that lands on several points at once some per cent too
  // fast; from equal fractions of what turns its velocity round, they have little left to do.
  const double inverse_mass = step.motion_a.inverse_mass + step.motion_b.inverse_mass;
  if (inverse_mass > 0.0) {
    const double turned = speed + impact.approach + impact.approach_of_forces;
    rebound.first_impulse = std::max(turned, 0.0) /
                            (inverse_mass * kWarmStartingFactor * static_cast<double>(first.count));
  }
  return rebound;
}

}  // namespace voxshell::bullet
