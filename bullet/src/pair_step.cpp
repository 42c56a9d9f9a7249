#include "pair_step.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <BulletCollision/CollisionDispatch/btManifoldResult.h>

#include "contact_constants.h"
#include "rest_margin.h"

namespace voxshell::bullet {

double PairStep::touching_gap() const { return kTouchingOfDetail * detail; }

Pose PairStep::field_from_shell_after(double fraction, const Motion& of_a,
                                      const Motion& of_b) const {
  const auto moved = [&](const Side& side) {
    const Motion& of_side = &side == &pair->a ? of_a : of_b;
    return of_side.moved(side.world_from_geometry(), fraction, time_step);
  };
  return moved(pair->field_side()).inverse() * moved(pair->shell_side());
}

namespace {

/// No place of the smaller body is faster, as the other one sees it, without what forces add, m/s.
double find_fastest(const PairStep& step) {
  const Motion& a = step.motion_a;
  const Motion& b = step.motion_b;
  return length(a.velocity_at(step.ball.center) - b.velocity_at(step.ball.center)) +
         length(a.angular_velocity - b.angular_velocity) * step.ball.radius;
}

/// How far contacts are looked for.
void look_ahead(const ContactSettings& settings, PairStep& step) {
  const Motion& a = step.motion_a;
  const Motion& b = step.motion_b;
  // Inside each other the nearest surface is a face, not the edge or corner that they hit.
  const bool rebounds = step.restitution > 0.0 && settings.mode == ContactMode::kAutomatic;
  const double of_detail = kCcdOfDetail * step.detail;
  const double by_default = rebounds ? std::min(step.rest_margin, of_detail) : of_detail;
  const double threshold =
      settings.ccd_motion_threshold >= 0.0 ? settings.ccd_motion_threshold : by_default;
  step.farthest_displacement = find_farthest_displacement(a, b, step.ball, step.time_step);
  step.uses_ccd = step.farthest_displacement > threshold;
  step.margin = step.rest_margin;
  if (step.uses_ccd) step.margin = std::max(step.margin, kCcdReach * step.farthest_displacement);
  const double farthest_if_stopped = find_farthest_if_stopped(a, b, step.ball, step.time_step);
  if (farthest_if_stopped > threshold) step.margin = std::max(step.margin, farthest_if_stopped);
  step.touch_margin = std::min(
      step.margin, std::max(step.rest_margin, find_touch_reach(a, b, step.ball, step.time_step)));
}

}  // namespace

PairStep describe_step(const PosedPair& pair, const ContactSettings& settings, double time_step,
                       double owed_energy, const Support* support) {
  const btCollisionObject* const object_a = pair.a.wrap().getCollisionObject();
  const btCollisionObject* const object_b = pair.b.wrap().getCollisionObject();
  const Ball ball_a = pair.a.bounding_ball();
  const Ball ball_b = pair.b.bounding_ball();
  PairStep step{};
  step.pair = &pair;
  step.time_step = time_step;
  step.motion_a = Motion::of(*object_a, time_step);
  step.motion_b = Motion::of(*object_b, time_step);
  if (ball_a.radius != ball_b.radius) {
    step.larger = ball_b.radius < ball_a.radius ? &pair.a : &pair.b;
  }
  // Bodies touch within the smaller one's ball.
  step.ball = step.larger == &pair.a ? ball_b : ball_a;
  step.thickness = pair.thickness();
  const double rest_margin =
      default_rest_margin(step.ball.radius, std::min(pair.a.thinnest(), pair.b.thinnest()));
  step.rest_margin = settings.margin >= 0.0 ? settings.margin : rest_margin;
  step.deep_overlap = kDeepOfMargin * rest_margin;
  step.detail = std::min(pair.a.detail(), pair.b.detail());
  step.restitution = static_cast<double>(gCalculateCombinedRestitutionCallback(object_a, object_b));
  const double fastest = find_fastest(step);
  const double weight =
      std::max(length(step.motion_a.velocity_of_forces), length(step.motion_b.velocity_of_forces));
  const double energy_to_lift = weight / time_step * kStillOfMargin * step.rest_margin;
  step.is_still = time_step > 0.0 && 0.5 * fastest * fastest <= energy_to_lift;
  look_ahead(settings, step);
  // What lies on something looks no farther than what touches it.
  step.is_supported = step.looks_ahead() && support != nullptr && step.is_still &&
                      fastest * time_step <= step.rest_margin &&
                      step.motion_a.is_supported(support->of(*object_a), ball_a.radius) &&
                      step.motion_b.is_supported(support->of(*object_b), ball_b.radius);
  if (step.is_supported) {
    step.motion_a.velocity_of_fall = step.motion_b.velocity_of_fall = {};
    look_ahead(settings, step);
  }
  step.rolls_at_rest = settings.rolling_at_rest;
  step.solver_turns_contacts = settings.solver_turns_contacts;
  step.is_segmented = settings.mode == ContactMode::kSegmented;

  step.owed_energy = owed_energy;
  step.field_from_shell = pair.field_from_shell();
  const Motion& of_shell = pair.shell_is_a ? step.motion_a : step.motion_b;
  const Motion& of_field = pair.shell_is_a ? step.motion_b : step.motion_a;
  const Pose& world_from_shell = pair.shell_side().world_from_geometry();
  step.motion = RelativeMotion::of(of_shell, of_field, world_from_shell);
  step.if_stopped = {RelativeMotion::of(of_shell, Motion{}, world_from_shell),
                     RelativeMotion::of(Motion{}, of_field, world_from_shell)};
  step.middle = pair.shell_side().world_from_geometry().inverse().transform_point(step.ball.center);
  step.displacement =
      time_step * (step.motion.velocity_at(step.middle) + step.motion.velocity_of_fall);
  return step;
}

bool Turning::may_face(const Vec3& normal, const Vec3& direction, double slack) const {
  const Vec3 axis = cross(normal, direction);
  const double angle = std::atan2(length(axis), dot(normal, direction));
  return angle <= std::abs(dot(turn, normalized(axis))) + std::abs(dot(stopped, direction)) + slack;
}

double Turning::lead_over(const Vec3& place, const Vec3& normal, const Vec3& other, double gap,
                          const Vec3& direction) const {
  constexpr std::array kFractions{0.25, 0.5, 0.75, 1.0};
  const Vec3 arm = place - center;
  const Vec3 other_arm = other - center;
  // The most of some angles on the way of a turn about an axis.
  const auto lead = [&](const Vec3& axis, double most) {
    const double level = dot(axis, arm) * dot(axis, direction);
    const double now = dot(arm, direction) - level;
    const double ahead = dot(cross(axis, arm), direction);
    const double speed = dot(cross(axis, other_arm), direction);
    // Nothing holds the other place before it has closed its gap.
    const auto taken = [&](double angle) {
      return speed < 0.0 ? angle * speed : std::max(angle * speed - gap, 0.0);
    };
    double largest = now + level;
    for (const double fraction : kFractions) {
      const double angle = fraction * most;
      largest =
          std::max(largest, level + now * std::cos(angle) + ahead * std::sin(angle) - taken(angle));
    }
    return largest - dot(other_arm, direction);
  };
  const Vec3 toward = cross(normal, direction);
  const double angle = std::atan2(length(toward), dot(normal, direction));
  return std::max(lead(normalized(turn), length(turn)),
                  lead(normalized(toward), std::min(angle, std::abs(dot(stopped, direction)))));
}

Turning turning_of(const PairStep& step, bool is_of_field) {
  const PosedPair& pair = *step.pair;
  const bool is_a = pair.shell_is_a != is_of_field;
  const Motion& own = is_a ? step.motion_a : step.motion_b;
  const Motion& other = is_a ? step.motion_b : step.motion_a;
  // What does not move turns about the other body, as that sees it.
  const bool moves = own.inverse_mass > 0.0 || own.is_link;
  const Side& side = is_of_field ? pair.field_side() : pair.shell_side();
  const auto to_own = [&](const Vec3& v) {
    return is_of_field ? step.field_from_shell.rotate(v) : v;
  };
  return {side.world_from_geometry().inverse().transform_point(moves ? own.center : other.center),
          kCcdReach * step.time_step * to_own(step.motion.angular_velocity),
          kCcdReach / step.ball.radius * to_own(step.displacement)};
}

Turning own_turning_of(const PairStep& step, bool is_of_field) {
  const bool is_a = step.pair->shell_is_a != is_of_field;
  const Motion& own = is_a ? step.motion_a : step.motion_b;
  Turning turning = turning_of(step, is_of_field);
  if (own.inverse_mass == 0.0 && !own.is_link) turning.stopped = {};
  const Side& side = is_of_field ? step.pair->field_side() : step.pair->shell_side();
  turning.turn = kCcdReach * step.time_step *
                 side.world_from_geometry().inverse().rotate(own.angular_velocity);
  return turning;
}

}  // namespace voxshell::bullet
