#include "contact_rule.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include "contact_list.h"
#include "rest_margin.h"
#include "second_shell.h"

namespace voxshell::bullet {
namespace {

/// Bodies are still that cannot rise by a larger share of the rest margin than this.
constexpr double kStillWithin = 0.15;
constexpr double kTouching = 0.05;  ///< of the smaller detail of the two bodies
constexpr double kNever = std::numeric_limits<double>::infinity();

/// Where a place touches a field on its way, by conservative advancement (Xu and Barbic 2016).
struct Touch {
  double share;  ///< of the way
  Vec3f place;
  double gap;  ///< that is left there, metres
};

/// @param gap     From the start to the surface, metres.
/// @param offset  How much less that is than the field's distance: of balls, and of Bullet's
/// margins.
template <class F>
std::optional<Touch> find_touch(const F& field, const Vec3& start, const Vec3& way, double gap,
                                double offset, double touching) {
  constexpr double kOfDistance = 0.6;  // fields of grids may change faster than the distance
  constexpr int kMostSteps = 64;
  const double length_of_way = length(way);
  Touch touch{0.0, static_cast<Vec3f>(start), gap};
  for (int i = 0; touch.gap > touching && i < kMostSteps; ++i) {
    touch.share += kOfDistance * touch.gap / length_of_way;
    if (!(touch.share <= 1.0)) return std::nullopt;
    touch.place = static_cast<Vec3f>(start + touch.share * way);
    touch.gap = static_cast<double>(field.distance(touch.place)) - offset;
  }
  return touch;
}

}  // namespace

ContactRule::ContactRule(const PosedPair& pair, const ContactSettings& settings, double time_step,
                         Memory& memory)
    : pair_(pair),
      time_step_(time_step),
      memory_(memory),
      motion_a_(Motion::of(*pair.a.wrap().getCollisionObject(), time_step)),
      motion_b_(Motion::of(*pair.b.wrap().getCollisionObject(), time_step)),
      restitution_(static_cast<double>(gCalculateCombinedRestitutionCallback(
          pair.a.wrap().getCollisionObject(), pair.b.wrap().getCollisionObject()))),
      rolling_at_rest_(settings.rolling_at_rest),
      detail_(std::min(pair.a.detail(), pair.b.detail())),
      owed_(memory.owed),
      first_touch_(kNever),
      first_count_(0) {
  const Ball ball_a = pair.a.bounding_ball();
  const Ball ball_b = pair.b.bounding_ball();
  if (ball_a.radius != ball_b.radius) larger_ = ball_b.radius < ball_a.radius ? &pair.a : &pair.b;
  const Ball& ball = larger_ == &pair.a ? ball_b : ball_a;
  radius_ = ball.radius;
  rest_margin_ = settings.margin >= 0.0
                     ? settings.margin
                     : default_rest_margin(radius_, std::min(pair.a.thinnest(), pair.b.thinnest()));
  // Bodies touch within the smaller one's ball.
  farthest_way_ = find_farthest_way(motion_a_, motion_b_, ball, time_step);
  const double fastest =
      length(motion_a_.velocity_at(ball.centre) - motion_b_.velocity_at(ball.centre)) +
      length(motion_a_.angular_velocity - motion_b_.angular_velocity) * radius_;
  const double weight =
      std::max(length(motion_a_.velocity_of_forces), length(motion_b_.velocity_of_forces));
  const double energy_to_lift = weight / time_step * kStillWithin * rest_margin_;
  is_still_ = time_step > 0.0 && 0.5 * fastest * fastest <= energy_to_lift;
  sweeps_ =
      farthest_way_ > (settings.ccd_motion_threshold >= 0.0 ? settings.sweep_beyond : detail_);
  // The solver may make points faster than they are.
  constexpr double kTurned = 2.0;
  margin_ = sweeps_ ? std::max(rest_margin_, kTurned * farthest_way_) : rest_margin_;
}

double ContactRule::touching_gap() const { return kTouching * detail_; }

Pose ContactRule::field_from_shell_after(double share) const {
  const auto moved = [&](const Side& side) {
    const Motion& motion = &side == &pair_.a ? motion_a_ : motion_b_;
    return motion.moved(side.world_from_geometry(), share, time_step_);
  };
  return moved(pair_.field_side()).inverse() * moved(pair_.shell_side());
}

void ContactRule::apply(std::vector<Contact>& contacts, std::span<const Feature> features,
                        double share) {
  features_ = features;
  motion_ = RelativeMotion::of(pair_.shell_is_a ? motion_a_ : motion_b_,
                               pair_.shell_is_a ? motion_b_ : motion_a_,
                               pair_.shell_side().world_from_geometry());
  field_from_shell_ = pair_.field_from_shell();
  if (share > 0.0) carry_back(contacts, share);
  std::size_t kept = 0;
  bool touches = false;
  bool touches_from_above = false;
  // What is taken may overwrite the contact that is looked at.
  const auto take = [&](const Contact& judged, double time) {
    contacts[kept++] = judged;
    first_touch_ = std::min(first_touch_, time);
  };
  const auto touch = [&](const Contact& judged, double time) {
    touches = true;
    touches_from_above = touches_from_above || !is_beside(judged);
    take(judged, time);
  };
  for (const Contact& contact : contacts) {
    const Impact impact = impact_of(contact);
    if (is_contact(impact)) {
      touch(contact, impact.time());
    } else if (sweeps_) {
      const double closing = (impact.approach + impact.approach_of_forces) * time_step_;
      if (!(closing >= impact.gap)) {
        take(contact, impact.time());
      } else if (const auto swept = pair_.has_triangles() ? contact : sweep(contact)) {
        touch(*swept, impact_of(*swept).time());
      }
    }
  }
  contacts.resize(touches ? kept : 0);
  // A body that leaves another from inside is in contact all the way, if only with such.
  if (touches_from_above) drop_beside(contacts);
  if (is_still_ && touches) {
    constexpr double kBandOfMargin = 0.5;
    memory_.patch.settle(contacts, pair_.thickness(), kBandOfMargin * rest_margin_);
  } else {
    memory_.patch.release();
  }
  hold(contacts);
  memory_.owed = 0.0;
  if (first_touch_ == kNever) return;
  for (const Contact& contact : contacts) {
    const Impact impact = impact_of(contact);
    if (!is_first(impact)) continue;
    ++first_count_;
    memory_.owed = std::max(memory_.owed, rebound_of(impact).owed);
  }
}

double ContactRule::Impact::time() const { return approach > 0.0 ? gap / approach : kNever; }

ContactRule::Impact ContactRule::impact_of(const Contact& contact) const {
  const Vec3 velocity = motion_.velocity_at(static_cast<Vec3>(contact.point));
  const auto normal = static_cast<Vec3>(contact.normal);
  return {-static_cast<double>(contact.depth) - pair_.thickness(), -dot(velocity, normal),
          -dot(motion_.velocity_of_forces, normal), squared_length(velocity)};
}

/// Whether a contact is among those that touch first. Those that come later would not come at all
/// after a rebound of the first.
bool ContactRule::is_first(const Impact& impact) const {
  constexpr double kAtOnce = 0.05;  // steps
  const double time = impact.time();
  return time < kNever && time <= first_touch_ + kAtOnce * time_step_;
}

/// Whether it takes more than a step to cross the rest margin.
bool ContactRule::is_slow(const Impact& impact) const {
  return impact.approach * time_step_ <= rest_margin_;
}

bool ContactRule::is_resting(const Impact& impact) const {
  return is_slow(impact) && std::abs(impact.gap) <= rest_margin_;
}

/// Whether a point is a contact where it is: one that penetrates or rests.
bool ContactRule::is_contact(const Impact& impact) const {
  // In this order: nearly all that are looked at are slow.
  return (is_slow(impact) && impact.gap <= rest_margin_) || impact.gap < 0.0;
}

/// Whether friction is to remember where the bodies are.
bool ContactRule::holds(const Impact& impact) const {
  return is_resting(impact) &&
         impact.squared_speed * time_step_ * time_step_ <= rest_margin_ * rest_margin_;
}

/// Bodies of which no point is where it took hold do so anew. One pose for all points: remembered
/// point by point, slips that no motion undoes would pull for ever.
void ContactRule::hold(std::span<const Contact> contacts) {
  if (memory_.hold) {
    shell_from_held_ =
        field_from_shell_.inverse() * (pair_.shell_is_a ? *memory_.hold : memory_.hold->inverse());
  }
  const auto may_hold = [&](const Contact& contact) { return holds(impact_of(contact)); };
  const auto still_holds = [&](const Contact& contact) {
    return is_held(slip_of(contact)) && may_hold(contact);
  };
  if (memory_.hold && std::ranges::any_of(contacts, still_holds)) return;
  memory_.hold.reset();
  if (std::ranges::any_of(contacts, may_hold)) {
    memory_.hold = pair_.shell_is_a ? field_from_shell_ : field_from_shell_.inverse();
    shell_from_held_ = Pose{};
  }
}

/// Whether a point that has slipped so far, metres, does not slide yet.
bool ContactRule::is_held(const Vec3& slip) const {
  constexpr double kOfMargin = 1.0 / 30.0;
  const double limit = kOfMargin * rest_margin_;
  return squared_length(slip) <= limit * limit;
}

/// After a gap, the speed at which the energy of Bullet's integration, v^2 / 2 + g x - g dt v / 2
/// along the normal, is what a rebound at the surface would leave.
ContactRule::Rebound ContactRule::rebound_of(const Impact& impact) const {
  const double v = impact.approach;
  const double gap = std::max(impact.gap, 0.0);
  // Without a step there is nothing that a gap is crossed in.
  if (time_step_ == 0.0 || (gap == 0.0 && owed_ == 0.0)) return {restitution_ * v, 0.0};
  const double g_dt = impact.approach_of_forces;
  const double climb = 2.0 * gap * g_dt / time_step_;
  const double energy = std::max(restitution_ * restitution_ * (v * v + climb + g_dt * v), owed_);
  const double square = 0.25 * g_dt * g_dt + energy - climb;
  const double speed = square > 0.0 ? std::sqrt(square) - 0.5 * g_dt : -1.0;
  if (speed < 0.0) return {-gap / time_step_, energy};
  return {speed, 0.0};
}

/// Of points all around one, their distance from it; of points in a long row, its width.
double ContactRule::lever_of(std::span<const Contact> contacts) const {
  constexpr double kSmall = 0.1;
  if (!rolling_at_rest_ || !is_still_) return 0.0;
  const Vec3f deepest = find_deepest(contacts).point;
  const auto squared_arm = [&](const Contact& contact) {
    return squared_length(contact.point - deepest);
  };
  const Vec3f farthest = contacts[find_largest(contacts, squared_arm)].point - deepest;
  const float radius = length(farthest);
  const double small = kSmall * radius_;
  if (static_cast<double>(radius) < small) return static_cast<double>(radius);
  float widest = 0.0f;
  for (const Contact& contact : contacts) {
    widest = std::max(widest, squared_length(cross(farthest, contact.point - deepest)));
  }
  const auto width = static_cast<double>(std::sqrt(widest) / radius);
  return width < small ? width : 0.0;
}

WorldContact ContactRule::to_world(const Contact& contact, double lever) const {
  WorldContact world = pair_.to_world(contact);
  const Impact impact = impact_of(contact);
  const double inverse_mass = motion_a_.inverse_mass + motion_b_.inverse_mass;
  world.is_resting = holds(impact);
  world.carries_on = is_still_ || world.is_resting;
  if (world.is_resting) {
    const Vec3 slip = slip_of(contact);
    if (is_held(slip)) {  // else it slides
      const Vec3 of_shell = pair_.shell_side().world_from_geometry().rotate(slip);
      world.slip = pair_.shell_is_a ? of_shell : -of_shell;
    }
    world.rolling_friction = lever;
  }
  world.restitution = restitution_;
  if (!(impact.approach > 0.0) || time_step_ == 0.0) return world;
  // A point that only stops approaching: if those that come later rebounded as well, ten iterations
  // of Bullet's solver would leave the body with too much energy.
  if (!is_first(impact)) {
    world.restitution = 0.0;
    return world;
  }
  const double speed = rebound_of(impact).speed;
  // The solver aims at restitution * approach - gap / time step. That of multibodies takes the
  // approach with what forces have added to it.
  const double of_gap = impact.gap > 0.0 ? impact.gap / time_step_ : 0.0;
  const bool has_link = motion_a_.is_link || motion_b_.is_link;
  const double approach = impact.approach + (has_link ? impact.approach_of_forces : 0.0);
  if ((of_gap > 0.0 || owed_ > 0.0 || has_link) && approach > 0.0) {
    world.restitution = (speed + of_gap) / approach;
  }
  // From 0, ten iterations leave a body that lands on several points at once some per cent too
  // fast; from equal shares of what turns its velocity round, they have little left to do.
  if (inverse_mass > 0.0) {
    const double turned = speed + impact.approach + impact.approach_of_forces;
    world.first_impulse = std::max(turned, 0.0) /
                          (inverse_mass * kWarmStartingFactor * static_cast<double>(first_count_));
  }
  return world;
}

/// Of points: triangles are no bodies of their own.
bool ContactRule::shell_is_larger() const {
  return !pair_.has_triangles() && larger_ == &pair_.shell_side();
}

void ContactRule::drop_beside(std::vector<Contact>& contacts) {
  if ((larger_ == nullptr && !pair_.asks_both) || pair_.has_triangles()) return;
  std::erase_if(contacts, [&](const Contact& contact) { return is_beside(contact); });
  first_touch_ = kNever;
  for (const Contact& contact : contacts) {
    first_touch_ = std::min(first_touch_, impact_of(contact).time());
  }
}

/// Whether a point of the larger body lies beside the smaller one rather than under it: that its
/// surface goes on in front of it, so that nothing can come at it from where the normal says. On a
/// ground of points as far apart as the body is large, those in front of its sides would stop it.
bool ContactRule::is_beside(const Contact& contact) const {
  constexpr float kAgainst = -0.3f;  // cosine of the angle between the normals
  constexpr float kFree = 0.3f;      // spacings
  if (pair_.has_triangles() || contact.id >= kInnerContact) return false;
  const bool is_second = contact.id >= kFirstOfSecond;
  const Side& side = is_second ? pair_.field_side() : pair_.shell_side();
  if (larger_ != &side && !pair_.asks_both) return false;
  const PointShell& shell = *side.participant().shell;
  const std::uint32_t id = is_second ? contact.id - kFirstOfSecond : contact.id;
  if (id >= shell.size()) return false;  // an edge is as sharp as it looks
  Vec3f point = contact.point;
  Vec3f outwards = contact.normal;
  if (is_second) {
    point = static_cast<Vec3f>(field_from_shell_.transform_point(place_of_second(contact)));
    outwards = static_cast<Vec3f>(-field_from_shell_.rotate(static_cast<Vec3>(contact.normal)));
  }
  if (dot(shell.normals()[id], outwards) < kAgainst) return false;
  const auto spacing = static_cast<float>(shell.spacing());
  if (contact.depth > spacing) return false;
  const Vec3f in_front = point - spacing * outwards;
  return side.model()->grid().distance(in_front) < kFree * spacing;
}

/// To where contacts that are found after a share of the step are at its start.
void ContactRule::carry_back(std::vector<Contact>& contacts, double share) const {
  const Pose field_from_shell_then = field_from_shell_after(share);
  for (Contact& contact : contacts) {
    const auto normal = static_cast<Vec3>(contact.normal);
    const double gap = -static_cast<double>(contact.depth) - pair_.thickness();
    const Vec3 on_field = field_from_shell_then.transform_point(
        static_cast<Vec3>(contact.point) + static_cast<double>(contact.depth) * normal);
    put_on_field(contact, on_field);
    const Impact impact = impact_of(contact);
    const double closing = (impact.approach + impact.approach_of_forces) * time_step_;
    contact.depth = static_cast<float>(-std::max(gap, 0.0) - share * closing - pair_.thickness());
    put_on_field(contact, on_field);
  }
  std::erase_if(contacts, [&](const Contact& contact) { return impact_of(contact).gap < 0.0; });
}

/// Moves a contact, along the surface, to where a place of the field's body is now. Of two places
/// that will touch, solvers are to see that of the smaller body where it is: with the lever of the
/// other it would be turned, not stopped.
void ContactRule::put_on_field(Contact& contact, const Vec3& on_field) const {
  const Vec3 now = field_from_shell_.inverse().transform_point(on_field);
  contact.point = static_cast<Vec3f>(now) - contact.depth * contact.normal;
}

/// Follows the point, its velocity constant, until it touches or the step ends.
std::optional<Contact> ContactRule::sweep(const Contact& contact) const {
  if (contact.id >= kFirstFeature) {
    return sweep_into_shell(features_[contact.id - kFirstFeature], contact.id);
  }
  if (contact.id >= kFirstOfSecond) {
    return sweep_into_shell({place_of_second(contact), 0.0}, contact.id);
  }
  const auto point = static_cast<Vec3>(contact.point);
  const Vec3 way = field_from_shell_.rotate(
      time_step_ * (motion_.velocity_at(point) + motion_.velocity_of_forces));
  const Vec3 start = field_from_shell_.transform_point(point);
  const double gap = -static_cast<double>(contact.depth) - pair_.thickness();
  return std::visit(
      [&](const auto& field) -> std::optional<Contact> {
        const auto touch = find_touch(field, start, way, gap, pair_.thickness(), touching_gap());
        if (!touch) return std::nullopt;
        const Vec3 normal = normalized(static_cast<Vec3>(field.gradient(touch->place)));
        const double approach = -dot(way, normal);
        if (!(approach > 0.0)) return std::nullopt;
        Contact touching = contact;
        touching.normal = static_cast<Vec3f>(field_from_shell_.inverse().rotate(normal));
        touching.depth = static_cast<float>(-(touch->share * approach + std::max(touch->gap, 0.0)) -
                                            pair_.thickness());
        if (shell_is_larger()) {
          const double apart = std::max(touch->gap, 0.0) + pair_.thickness();
          put_on_field(touching, static_cast<Vec3>(touch->place) - apart * normal);
        }
        return touching;
      },
      pair_.field());
}

/// The same of a feature, or a point of the second shell, in the field of the shell's model.
std::optional<Contact> ContactRule::sweep_into_shell(const Feature& feature,
                                                     std::uint32_t id) const {
  const GridField& field = pair_.shell_side().model()->grid();
  const Vec3 way = -time_step_ * (motion_.velocity_at(feature.place) + motion_.velocity_of_forces);
  const double offset = feature.radius + pair_.thickness();
  const double gap =
      static_cast<double>(field.distance(static_cast<Vec3f>(feature.place))) - offset;
  const auto touch = find_touch(field, feature.place, way, gap, offset, touching_gap());
  if (!touch) return std::nullopt;
  const Vec3f outwards = normalized(field.gradient(touch->place));
  const double approach = -dot(way, static_cast<Vec3>(outwards));
  if (!(approach > 0.0)) return std::nullopt;
  const double gap_then = std::max(touch->gap, 0.0);
  Contact touching =
      contact_of(feature, id, outwards, -(touch->share * approach + gap_then) - pair_.thickness());
  // The shell's place, as in put_on_field().
  if (id < kFirstFeature && larger_ == &pair_.field_side()) {
    touching.point = touch->place - static_cast<float>(gap_then) * outwards;
  }
  return touching;
}

}  // namespace voxshell::bullet
