#include "rebound.h"

#include <algorithm>
#include <cmath>

#include "contact_constants.h"

namespace voxshell::bullet {

namespace {

/// Others are there in case the solver turns the body, and what is slow may be within the rest
/// margin for some steps before it touches.
bool touches_within(const PairStep& step, const Impact& impact) {
  return impact.gap <= 0.0 || closing_of(step, impact) >= impact.gap;
}

/// Whether the rebound of what touches first may change how other contacts of the pair do.
bool has_others_to_follow(const PairStep& step, const FirstTouch& first) {
  const bool has_link = step.motion_a.is_link || step.motion_b.is_link;
  return first.time < kNever && !has_link && step.time_step > 0.0 && step.restitution > 0.0;
}

}  // namespace

/// Two bodies without friction, with nothing else in the way.
class FreeBodies {
 public:
  explicit FreeBodies(const PairStep& step)
      : world_from_shell_(step.pair->shell_side().world_from_geometry()),
        shell_(step.pair->shell_is_a ? step.motion_a : step.motion_b),
        field_(step.pair->shell_is_a ? step.motion_b : step.motion_a) {}

  /// m/s.
  double speed_apart(const Contact& contact) const {
    return speed_apart(shell_, field_, place_of(contact), normal_of(contact));
  }
  /// Pushes the bodies until they part at a contact with that speed, if they do so more slowly.
  void part(const Contact& contact, double wanted) {
    const Vec3 at = place_of(contact);
    const Vec3 normal = normal_of(contact);
    const double speed = speed_apart(shell_, field_, at, normal);
    const double missing = wanted - speed;
    const double response =
        speed_apart(shell_.pushed(normal, at), field_.pushed(-normal, at), at, normal) - speed;
    if (!(missing > 0.0) || !(response > 0.0)) return;
    const Vec3 impulse = missing / response * normal;
    shell_ = shell_.pushed(impulse, at);
    field_ = field_.pushed(-impulse, at);
  }
  /// Of the shell as the field sees it, in the shell's frame.
  RelativeMotion motion() const { return RelativeMotion::of(shell_, field_, world_from_shell_); }

 private:
  Vec3 place_of(const Contact& contact) const {
    return world_from_shell_.transform_point(static_cast<Vec3>(contact.point));
  }
  Vec3 normal_of(const Contact& contact) const {
    return world_from_shell_.rotate(static_cast<Vec3>(contact.normal));
  }
  static double speed_apart(const Motion& shell, const Motion& field, const Vec3& at,
                            const Vec3& normal) {
    return dot(shell.velocity_at(at) - field.velocity_at(at), normal);
  }

  Pose world_from_shell_;
  Motion shell_;
  Motion field_;
};

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
  if (!has_others_to_follow(step, first)) return std::nullopt;
  // Friction and other bodies may make it another motion, which must not lead through a body.
  const double thinnest = std::min(pair.a.thinnest(), pair.b.thinnest());
  if (step.farthest_displacement > kDetailOfThickness * std::min(thinnest, step.ball.radius)) {
    return std::nullopt;
  }
  FreeBodies bodies(step);
  for (int i = 0; i < kReboundSweeps; ++i) {
    for (const Contact& contact : contacts) {
      const Impact impact = impact_of(step, contact);
      if (first.includes(step, impact)) bodies.part(contact, step.restitution * impact.approach);
    }
  }
  return AfterTouch{std::clamp(first.time / step.time_step, 0.0, 1.0), bodies.motion()};
}

void Rebounding::find(const PairStep& step, const FirstTouch& first,
                      std::span<const Contact> contacts) {
  touches_.clear();
  const bool goes_on = has_others_to_follow(step, first);
  for (std::uint32_t i = 0; i < contacts.size(); ++i) {
    const Impact impact = impact_of(step, contacts[i]);
    // A body that lands flat at the end of the step does so as a whole.
    const bool touches_with_last =
        goes_on && impact.time() <= (1.0 + kFirstTouchWithin) * step.time_step;
    if (!touches_with_last && !touches_within(step, impact)) continue;
    touches_.push_back({.id = contacts[i].id, .index = i, .impact = impact});
  }
  for (double time = first.time; time < kNever;) {
    FreeBodies bodies(step);
    const std::size_t count = find_together(step, contacts, time, goes_on, bodies);
    time = kNever;
    for (Touch& touch : touches_) {
      if (touch.is_now) touch.count = count;
      if (!goes_on || touch.count > 0 || !touch.is_free) continue;
      const Contact& contact = contacts[touch.index];
      const double change = bodies.speed_apart(contact) + touch.impact.approach;
      touch.is_free = std::abs(change) <= kFreeOfApproach * touch.impact.approach &&
                      is_of_another_wall(step, contacts, contact);
      const bool touches = touch.is_free && touches_within(step, touch.impact);
      if (touches) time = std::min(time, touch.impact.time());
    }
  }
}

/// Marks what rebounds from a time on. Of what touches a little later, a place that what touches
/// first takes away from the other body, as a corner does the edge beside it, does not rebound.
///
/// @param bodies  With their velocities before; get those that they part with.
/// @return How many.
std::size_t Rebounding::find_together(const PairStep& step, std::span<const Contact> contacts,
                                      double time, bool goes_on, FreeBodies& bodies) {
  const auto part = [&] {
    for (int i = 0; i < kReboundSweeps; ++i) {
      for (const Touch& touch : touches_) {
        if (!touch.is_now) continue;
        bodies.part(contacts[touch.index], step.restitution * touch.impact.approach);
      }
    }
  };
  std::size_t count = 0;
  later_.clear();
  for (Touch& touch : touches_) {
    const double after = touch.impact.time() - time;
    touch.is_now = touch.is_free && touch.count == 0 &&
                   after <= (goes_on ? kTogetherWithin : kFirstTouchWithin) * step.time_step;
    count += touch.is_now ? 1 : 0;
    const bool may_be_now = touch.is_free && touch.count == 0 && !touch.is_now &&
                            after <= kFirstTouchWithin * step.time_step;
    if (may_be_now) later_.push_back(&touch);
  }
  if (!goes_on) return count;
  part();
  std::ranges::stable_sort(later_, {}, [](const Touch* touch) { return touch->impact.time(); });
  for (Touch* touch : later_) {
    if (!(bodies.speed_apart(contacts[touch->index]) < 0.0)) continue;
    touch->is_now = true;
    ++count;
    part();
  }
  return count;
}

/// Whether the contact is at right angles to all that rebound now, but for those that only rest.
/// Levers may leave its approach alone by chance.
bool Rebounding::is_of_another_wall(const PairStep& step, std::span<const Contact> contacts,
                                    const Contact& contact) const {
  return std::ranges::none_of(touches_, [&](const Touch& touch) {
    return touch.is_now && !is_slow(step, touch.impact) &&
           std::abs(dot(contact.normal, contacts[touch.index].normal)) > kMostCosineOfWalls;
  });
}

std::size_t Rebounding::count_with(std::uint32_t id) const {
  const auto found = std::ranges::lower_bound(touches_, id, {}, &Touch::id);
  return found != touches_.end() && found->id == id ? found->count : 0;
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
  // Without energy it only stops there, whichever way forces have it go.
  if (energy == 0.0) return {-gap / step.time_step, 0.0};
  const double square = 0.25 * g_dt * g_dt + energy - climb;
  const double speed = square > 0.0 ? std::sqrt(square) - 0.5 * g_dt : -1.0;
  if (speed < 0.0) return {-gap / step.time_step, energy};
  return {speed, 0.0};
}

SolverRebound rebound_for_solver(const PairStep& step, std::size_t count, const Impact& impact) {
  SolverRebound rebound{step.restitution, 0.0};
  if (!(impact.approach > 0.0) || step.time_step == 0.0) return rebound;
  // A point that only stops approaching: if those that come later rebounded as well, ten iterations
  // of Bullet's solver would leave the body with too much energy.
  if (count == 0) return {0.0, 0.0};
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
    rebound.first_impulse =
        std::max(turned, 0.0) / (inverse_mass * kWarmStartingFactor * static_cast<double>(count));
  }
  return rebound;
}

}  // namespace voxshell::bullet
