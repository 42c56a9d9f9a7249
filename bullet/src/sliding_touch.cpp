#include "sliding_touch.h"

#include <algorithm>
#include <cmath>

#include "conservative_advancement.h"
#include "contact_constants.h"
#include "face_field.h"
#include "impact.h"
#include "round_side.h"
#include "round_touch.h"
#include "second_shell.h"
#include "slide_to_nearest.h"
#include "smooth_field.h"

namespace voxshell::bullet {
namespace {

/// The round one of the two bodies, of which a place faces the other one.
struct RoundBody {
  bool is_shell;  ///< it is the pair's shell side
  RoundSide round;
  RoundSide::Place place;  ///< its own frame
};

/// The smaller body where that is round: its surface is the one that bends more.
std::optional<RoundBody> find_round(const PairStep& step, const Contact& contact) {
  const bool first = !is_shell_larger(step);
  for (const bool is_shell : {first, !first}) {
    const PosedPair& pair = *step.pair;
    const auto round = RoundSide::of(is_shell ? pair.shell_side() : pair.field_side());
    if (!round) continue;
    const Pose own_from_shell = is_shell ? Pose{} : step.field_from_shell;
    const Vec3 at = is_shell ? static_cast<Vec3>(contact.point) : place_of_second(contact);
    const auto place = round->nearest(own_from_shell.transform_point(at));
    if (!place) continue;
    const Vec3 outwards = own_from_shell.rotate(static_cast<Vec3>(contact.normal));
    const double facing = (is_shell ? -1.0 : 1.0) * dot(place->normal, outwards);
    if (facing >= kFacesEdge) return RoundBody{is_shell, *round, *place};
  }
  return std::nullopt;
}

/// The place of a round body that is nearest to the other one at each time of the step.
class SlidingPlace {
 public:
  /// Where they are nearest to each other at some time. The frame of the shell, but for the place.
  struct Met {
    double fraction;  ///< of the step
    double gap;       ///< meters
    Vec3 outwards;    ///< of the other body
    Vec3 position;
    RoundSide::Place place;
  };

  SlidingPlace(const PairStep& step, const RelativeMotion& motion, const RoundBody& body)
      : step_(step),
        body_(body),
        own_from_shell_(body.is_shell ? Pose{} : step.field_from_shell),
        shell_from_own_(own_from_shell_.inverse()),
        other_from_shell_(body.is_shell ? step.field_from_shell : Pose{}),
        shell_from_other_(other_from_shell_.inverse()),
        motion_(body.is_shell ? motion : motion.reversed()),
        other_(other_side(step, body)),
        safe_of_gap_(other_side(step, body).has_sharp_field() ? kBoldOfGap : kSafeOfGap),
        place_(body.place) {}

  /// Where they touch. Where it is not found on the way, what was found last counts if they are as
  /// good as touching there.
  std::optional<Met> find_touch(double steps) {
    const auto reached = advance(path_of(place_.position).length(), step_.touching_gap(), steps,
                                 [&](double fraction) { return clearance_after(fraction); });
    if (!reached || !met_) return std::nullopt;
    return met_->gap <= same_gap() ? met_ : std::nullopt;
  }

  /// How much nearer they come to each other until the end of the step, if they go on as now along
  /// each other from a contact with that gap.
  std::optional<double> find_turn(double gap) {
    const Vec3 way = (body_.is_shell ? 1.0 : -1.0) * displacement_of_centers(step_);
    within_ = std::min(kSlidesWithin, kSlidesWithinOfTurn * length(way) / step_.ball.radius);
    const bool is_smaller = body_.is_shell != is_shell_larger(step_);
    const double angle = step_.time_step * length(step_.motion.angular_velocity);
    const bool may_turn = angle >= kLeastOwnTurn || !is_smaller || rises_along(way);
    if (!may_turn) return std::nullopt;
    const auto now = settle(0.0);
    // Elsewhere it is not the contact's place.
    if (!now || std::abs(now->gap - gap) > same_gap()) return std::nullopt;
    const auto half = settle_between(0.0, 0.5);
    if (!half) return std::nullopt;
    // Straight ahead, the body would end the step on the other side of a thin wall. It stays on
    // this side along the chord that its first half predicts, if that bends evenly.
    const double predicted = 4.0 * (now->gap - half->gap);
    double along_chord = 0.0;
    const double deep = kDeepInWall * other_side(step_, body_).thinnest();
    if (predicted - now->gap > deep && -half->gap < deep) {
      const RoundSide::Place of_half = place_;
      const auto quarter = settle_between(0.5, 0.25);
      if (!quarter || !is_even(16.0 * (now->gap - quarter->gap), predicted)) return std::nullopt;
      place_ = of_half;
      along_chord = predicted;
    }
    motion_.velocity = motion_.velocity + (along_chord / step_.time_step) * now->outwards;
    const auto then = settle_between(0.5, 1.0);
    if (!then || dot(now->outwards, then->outwards) < kLeastCosineOfTurn) return std::nullopt;
    const double turn = along_chord + now->gap - then->gap;
    // Nothing comes nearer by more than it moves.
    if (turn > step_.farthest_displacement) return std::nullopt;
    return is_even(predicted, turn) ? std::optional(turn) : std::nullopt;
  }

  /// The contact where they touch.
  Sliding contact_of(const Met& met, const Contact& contact) {
    const double sign = body_.is_shell ? 1.0 : -1.0;
    const SmoothField::Value there = other_.at(other_from_shell_.transform_point(met.position));
    const Vec3 felt = shell_from_other_.rotate(there.outwards);
    const bool faces = squared_length(felt - met.outwards) <= kMostLeanOfTouch * kMostLeanOfTouch;
    // The place is found within half a degree only, and the other body bends less.
    const Vec3 outwards = faces ? felt : met.outwards;
    const Vec3 normal = sign * outwards;
    const auto facing = body_.round.slide(met.place, own_from_shell_.rotate(-outwards),
                                          kFlatBend / step_.ball.radius);
    const Vec3 now = shell_from_own_.transform_point((facing ? *facing : met.place).position);
    const Vec3 velocity = motion_.velocity_at(now) + motion_.velocity_of_fall;
    const double approach = -dot(velocity, outwards);
    const double closing = std::max(approach * step_.time_step, 0.0);
    const double gap = std::max(met.gap, 0.0);
    Contact touching = contact;
    touching.normal = static_cast<Vec3f>(normal);
    touching.depth = static_cast<float>(-(met.fraction * closing + gap) - step_.thickness);
    const Vec3 on_other = met.position - (met.gap + step_.thickness) * outwards;
    // At the place of the smaller body.
    const bool is_larger = body_.is_shell == is_shell_larger(step_);
    const Vec3 of_smaller = is_larger ? on_other : now;
    const Vec3 of_larger = is_larger ? now : on_other;
    touching.point = static_cast<Vec3f>(of_smaller);
    if (is_shell_larger(step_)) {
      put_on_field(step_, step_.field_from_shell.transform_point(of_smaller), touching);
    }
    const Vec3 apart = of_larger - of_smaller;
    const double passing = length(velocity + approach * outwards);
    return {touching, apart - dot(apart, normal) * normal, met.fraction * step_.time_step * passing,
            faces};
  }

 private:
  static const Side& other_side(const PairStep& step, const RoundBody& body) {
    return body.is_shell ? step.pair->field_side() : step.pair->shell_side();
  }

  /// Gaps that differ by less are of one place.
  double same_gap() const {
    return std::max(step_.touching_gap(), kSameOfRadius * step_.ball.radius);
  }

  Path path_of(const Vec3& own_place) const {
    return {motion_, shell_from_own_.transform_point(own_place), step_.time_step};
  }

  /// Whether the first part of the step predicts what is found later: a surface that bends evenly
  /// comes nearer with the square of time. What comes nearer all at once is another wall.
  static bool is_even(double predicted, double turn) {
    return std::abs(predicted - turn) <= kUnevenTurn * std::abs(turn);
  }

  /// Whether the other body's surface turns toward the body on the way ahead along it.
  bool rises_along(const Vec3& way) {
    const Vec3 here = shell_from_own_.transform_point(place_.position);
    const auto outwards_at = [&](const Vec3& place) {
      return shell_from_other_.rotate(other_.at(other_from_shell_.transform_point(place)).outwards);
    };
    const Vec3 outwards = outwards_at(here);
    const Vec3 along = way - dot(way, outwards) * outwards;
    return dot(outwards_at(here + along) - outwards, normalized(along)) < -kLeastTurn;
  }

  /// How far they are apart after a fraction of the step.
  Clearance clearance_after(double fraction) {
    const auto now = settle(fraction);
    // Near an edge, places on both sides of it feel its faces; what they felt before is true.
    if (!now || (now->gap < 0.0 && met_)) return {0.0, 0.0};
    met_ = now;
    return {now->gap, safe_of_gap_ * now->gap};
  }

  /// Slides the place on from what was nearest at an earlier time of the step. On bodies that spin
  /// fast it may be far away, and is found by little at once.
  std::optional<Met> settle_between(double from, double to) {
    const RoundSide::Place before = place_;
    if (const auto met = settle(to)) return met;
    const double angle =
        std::abs(to - from) * step_.time_step * length(motion_.own.angular_velocity);
    const int parts = 1 + static_cast<int>(angle / kMostTurnOfSlide);
    place_ = before;
    for (int i = 1; i < parts; ++i) {
      if (!settle(from + (to - from) * i / parts)) return std::nullopt;
    }
    return parts > 1 ? settle(to) : std::nullopt;
  }

  /// Slides the place to where the other body is nearest, after a fraction of the step.
  std::optional<Met> settle(double fraction) {
    const auto nearest = [&](const Vec3& point, const RoundSide::Place& guess) {
      const auto walked = body_.round.nearest_from(guess, point);
      return walked ? walked : body_.round.nearest(point, &guess);
    };
    const auto feel = [&](const Vec3& position) {
      const Path path = path_of(position);
      const SmoothField::Value there =
          other_.at(other_from_shell_.transform_point(path.at(fraction)));
      const Vec3 outwards = path.turned_back(fraction, shell_from_other_.rotate(there.outwards));
      return Facing{position, own_from_shell_.rotate(outwards), there.distance - step_.thickness};
    };
    const auto facing = SlideToNearest(step_.ball.radius, within_, nearest, feel).slide(place_);
    if (!facing) return std::nullopt;
    const Path path = path_of(facing->position);
    const Vec3 outwards = path.turned_at(fraction, shell_from_own_.rotate(facing->outwards));
    return Met{fraction, facing->distance, outwards, path.at(fraction), place_};
  }

  const PairStep& step_;
  const RoundBody& body_;
  Pose own_from_shell_;
  Pose shell_from_own_;
  Pose other_from_shell_;
  Pose shell_from_other_;
  RelativeMotion motion_;  ///< of the round body as the other one sees it, in the shell's frame
  SmoothField other_;
  double safe_of_gap_;  ///< the fraction of a gap that is safe to move by
  RoundSide::Place place_;
  double within_ = kSlidesWithin;  ///< see SlideToNearest
  std::optional<Met> met_;
};

}  // namespace

std::optional<Sliding> find_sliding(const PairStep& step, const RelativeMotion& motion,
                                    const Contact& contact, double steps) {
  const auto body = find_round(step, contact);
  if (!body) return std::nullopt;
  SlidingPlace place(step, motion, *body);
  const auto met = place.find_touch(steps);
  if (!met) return std::nullopt;
  return place.contact_of(*met, contact);
}

Vec3 displacement_of_centers(const PairStep& step) {
  const bool is_a = step.pair->shell_is_a;
  const Vec3 velocity = is_a ? step.motion_a.velocity - step.motion_b.velocity
                             : step.motion_b.velocity - step.motion_a.velocity;
  const Matrix3& world_from_shell = step.pair->shell_side().world_from_geometry().rotation;
  return step.time_step * (world_from_shell.transposed() * velocity);
}

std::optional<double> find_turn(const PairStep& step, const Contact& contact) {
  const auto body = find_round(step, contact);
  if (!body) return std::nullopt;
  // As the solver has them move at this contact, whose normal need not be quite true.
  const Impact impact = impact_of(step, contact);
  RelativeMotion along = step.motion;
  along.velocity = along.velocity + impact.approach * static_cast<Vec3>(contact.normal);
  along.velocity_of_fall = {};
  return SlidingPlace(step, along, *body).find_turn(impact.gap);
}

}  // namespace voxshell::bullet
