#include "ball_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

#include "contact_constants.h"
#include "second_shell.h"

namespace voxshell::bullet {
namespace {

constexpr double kThird = 0.57735026918962576;  // the square root of a third

/// From which a ball's surface is looked over: no place of it is farther from all of them than
/// kBetweenStarts radii. Unit length.
constexpr std::array<Vec3, kBallIds> kStarts{{{0, 0, -1},
                                              {0, 0, 1},
                                              {0, -1, 0},
                                              {0, 1, 0},
                                              {-1, 0, 0},
                                              {1, 0, 0},
                                              {-kThird, -kThird, -kThird},
                                              {-kThird, -kThird, kThird},
                                              {-kThird, kThird, -kThird},
                                              {-kThird, kThird, kThird},
                                              {kThird, -kThird, -kThird},
                                              {kThird, -kThird, kThird},
                                              {kThird, kThird, -kThird},
                                              {kThird, kThird, kThird}}};
constexpr double kBetweenStarts = 0.63;

/// The first start that a direction is near to, or nearly as near as to the nearest, and that is
/// not taken: what lies between two keeps one of them.
std::size_t choose_start(const Vec3& direction, const std::array<bool, kBallIds>& is_taken) {
  double most = -1.0;
  for (std::size_t i = 0; i < kBallIds; ++i) {
    if (!is_taken[i]) most = std::max(most, dot(kStarts[i], direction));
  }
  std::size_t i = 0;
  while (is_taken[i] || dot(kStarts[i], direction) < most - kNearlyAsNear) ++i;
  return i;
}

}  // namespace

bool BallContacts::is_outside(const Ball& ball, const Vec3& direction) {
  return dot(direction, ball.out) >= -kCapRim;
}

void BallContacts::append(std::vector<Feature>& features, const PosedPair& pair,
                          const PairStep* step, double margin, const TouchScale& scale,
                          std::vector<Contact>& contacts, std::vector<std::uint32_t>& exact) {
  field_ = SmoothField(pair.shell_side());
  const bool slides = scale.margin > 0.0;
  const double radius = slides ? scale.radius : features.front().radius;
  same_within_ = kSameOfRadius * radius;
  followed_within_ = kFollowedOfRadius * radius;
  balls_.clear();
  touches_.clear();
  const GridField& grid = pair.shell_side().model()->grid();
  grid_ = &grid;
  const Vec3 middle = pair.field_from_shell().inverse().transform_point(pair.field_side().middle());
  for (std::size_t first = 0; first < features.size(); first += kBallIds) {
    const Feature ball = features[first];
    balls_.push_back({ball.place, ball.radius, normalized(ball.place - middle)});
    const auto of_center = static_cast<double>(grid.distance(static_cast<Vec3f>(ball.place)));
    // Far from the surface a grid's distances are rough: those of balls are found near it.
    if (!(of_center < margin + (1.0 + kBallSlack) * ball.radius)) continue;
    const std::size_t first_touch = touches_.size();
    const auto nearest = hold_ball(ball, middle, margin, grid);
    bool is_exact = slides;
    if (nearest) {
      const auto outwards = static_cast<Vec3>(nearest->outwards);
      std::optional<Facing> facing;
      if (slides) facing = face(balls_.back(), -outwards);
      const Vec3 position = ball.place - ball.radius * outwards;
      // Another wall may be nearer than the one that this leads to.
      const bool is_same = facing && squared_length(facing->position - position) <=
                                         followed_within_ * followed_within_;
      const double slack = scale.margin + (is_same ? field_.off_field() : 0.0);
      is_exact = facing && facing->distance <= nearest->distance + slack;
      if (!is_exact) facing = {position, outwards, nearest->distance};
      if (facing->distance < margin) touches_.push_back(*facing);
    }
    // Between two walls, no way leads from the center to either. What is about the center of a ball
    // that is in the model is no wall that it lies on.
    if ((is_exact || !nearest) && of_center > 0.0) find_all(balls_.back(), first_touch, margin);
    const std::size_t facing_count = touches_.size();
    if (slides && step->uses_ccd && of_center > 0.0) {
      find_on_the_way(balls_.back(), first_touch, *step);
    }
    std::array<bool, kBallIds> is_taken{};
    for (std::size_t i = first_touch; i < touches_.size(); ++i) {
      const Facing& of = touches_[i];
      const std::size_t start = choose_start(-of.outwards, is_taken);
      is_taken[start] = true;
      Feature& feature = features[first + start];
      if (!nearest || i > first_touch) feature = {of.position, 0.0};
      const auto id = kFirstFeature + static_cast<std::uint32_t>(first + start);
      contacts.push_back(contact_of(feature, id, static_cast<Vec3f>(of.outwards), -of.distance));
      if (is_exact && i < facing_count) exact.push_back(id);
    }
  }
  std::ranges::sort(contacts, {}, &Contact::id);
  std::ranges::sort(exact);
}

/// Where the model's surface faces a ball, from a direction on.
std::optional<Facing> BallContacts::face(const Ball& ball, const Vec3& direction) {
  return face_field(
      direction, {}, std::numeric_limits<double>::infinity(), field_.faces_within(),
      [&](const Vec3& along) { return std::optional(ball.center + ball.radius * along); },
      [&](const Vec3& position) {
        const SmoothField::Value there = field_.at(position);
        return Facing{position, there.outwards, there.distance};
      });
}

bool BallContacts::is_known(std::size_t first, const Vec3& position) const {
  return std::any_of(touches_.begin() + static_cast<std::ptrdiff_t>(first), touches_.end(),
                     [&](const Facing& touch) {
                       return squared_length(touch.position - position) <=
                              same_within_ * same_within_;
                     });
}

/// But those of touches_ from the first one on.
void BallContacts::find_all(const Ball& ball, std::size_t first, double margin) {
  for (const Vec3& start : kStarts) {
    const SmoothField::Value there = field_.at(ball.center + ball.radius * start);
    if (there.distance - kBetweenStarts * ball.radius > margin) continue;
    const auto facing = face(ball, start);
    if (!facing || !(facing->distance < margin) || is_known(first, facing->position)) continue;
    // Behind the center, it is the back of a wall.
    if (facing->distance <= -ball.radius || !is_outside(ball, -facing->outwards)) continue;
    touches_.push_back(*facing);
  }
}

/// The wall that a ball meets first on a straight way, beside those of touches_ from the first one
/// on.
///
/// @param so_far        How the ball has moved since the step began.
/// @param displacement  From there; gets what the wall leaves of the rest of it.
std::optional<Facing> BallContacts::meet(const Ball& ball, std::size_t first, Vec3& so_far,
                                         Vec3& displacement) const {
  const GridField& grid = *grid_;
  const auto look = [&](double fraction) -> std::optional<Facing> {
    const Vec3 moved = so_far + fraction * displacement;
    const auto center = static_cast<Vec3f>(ball.center + moved);
    const auto of_center = static_cast<double>(grid.distance(center));
    if (!(of_center > 0.0 && of_center < ball.radius)) return std::nullopt;
    const auto outwards = static_cast<Vec3>(normalized(grid.gradient(center)));
    const auto is_known = [&](const Facing& touch) {
      return dot(touch.outwards, outwards) > kTurnedCosine;
    };
    const auto known = std::span(touches_).subspan(first);
    if (!(dot(outwards, displacement) < 0.0) || std::ranges::any_of(known, is_known)) {
      return std::nullopt;
    }
    return Facing{ball.center - ball.radius * outwards, outwards,
                  of_center - ball.radius - dot(outwards, moved)};
  };
  const double hops =
      std::min(std::floor(length(displacement) / (kBallHop * ball.radius)), kMostBallHops);
  for (int hop = 1; hop <= static_cast<int>(hops); ++hop) {
    const auto there = look(hop / hops);
    if (!there) continue;
    double before = (hop - 1) / hops;
    double after = hop / hops;
    for (int i = 0; i < kMeetSteps; ++i) {
      const double between = 0.5 * (before + after);
      (look(between) ? after : before) = between;
    }
    // Where it begins to be nearer than others, the grid blends their normals.
    const Facing met = look(std::min(after + kBehindMeeting / hops, 1.0)).value_or(*there);
    so_far = so_far + after * displacement;
    displacement = (1.0 - after) * displacement;
    displacement = displacement - dot(displacement, met.outwards) * met.outwards;
    return met;
  }
  return std::nullopt;
}

/// The walls that the ball meets on its way, each of which turns it aside: a ball that rolls across
/// a bin does not face the wall on its other side before it is there.
void BallContacts::find_on_the_way(const Ball& ball, std::size_t first, const PairStep& step) {
  Vec3 so_far;
  Vec3 displacement =
      -step.time_step * (step.motion.velocity_at(ball.center) + step.motion.velocity_of_fall);
  for (int wall = 0; wall < kMostWalls && touches_.size() - first < kBallIds; ++wall) {
    const auto met = meet(ball, first, so_far, displacement);
    if (!met) return;
    touches_.push_back(*met);
  }
}

void BallContacts::drop_covered(std::vector<Contact>& contacts, const PointShell& shell,
                                const std::vector<std::uint32_t>& exact) {
  if (touches_.empty()) return;
  const auto is_sample = [&](const Contact& contact) { return contact.id < kInnerContact; };
  const auto is_exact = [&](const Contact& contact) {
    return std::ranges::binary_search(exact, contact.id);
  };
  edges_.clear();
  for (const Contact& contact : contacts) {
    if (is_sample(contact) && is_exact(contact) && !shell.is_point(contact.id)) {
      edges_.push_back(static_cast<Vec3>(contact.point));
    }
  }
  const auto is_near = [&](const Vec3& a, const Vec3& b, double within) {
    return squared_length(a - b) <= within * within;
  };
  const auto is_covered = [&](const Contact& contact) {
    const auto point = static_cast<Vec3>(contact.point);
    if (!is_sample(contact)) {
      // An edge knows better than a coarse grid where a ball touches it.
      return std::ranges::any_of(
          edges_, [&](const Vec3& edge) { return is_near(edge, point, followed_within_); });
    }
    if (is_exact(contact)) {
      return shell.is_point(contact.id) && std::ranges::any_of(touches_, [&](const Facing& facing) {
               return is_near(facing.position - facing.distance * facing.outwards, point,
                              same_within_);
             });
    }
    for (const Ball& ball : balls_) {
      const Vec3 arm = point - ball.center;
      const double off = length(arm) - ball.radius;
      const bool is_of_ball = std::abs(off + static_cast<double>(contact.depth)) <= same_within_;
      if (!is_of_ball || !is_outside(ball, normalized(arm))) continue;
      const auto facing = face(ball, normalized(arm));
      if (facing && is_known(0, facing->position)) return true;
    }
    return false;
  };
  std::erase_if(contacts, is_covered);
}

}  // namespace voxshell::bullet
