#include "cylinder_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <variant>

#include "contact_constants.h"
#include "contact_list.h"
#include "contact_rule.h"
#include "eight_directions.h"
#include "face_field.h"
#include "second_shell.h"

namespace voxshell::bullet {
namespace {

/// The circle at an end is looked over from kEightDirections: no place of it is farther from all of
/// them than this, radii.
constexpr double kBetweenStarts = 0.4;
constexpr int kApproachSteps = 2;
/// Of a long side, between places that are looked over: a radius apart each, if they are not more.
constexpr double kMostIntervals = 64.0;

/// Whether two directions from the axis lead to one touch.
bool are_near(const Vec3& a, const Vec3& b) {
  return squared_length(a - b) <= kFollowedOfRadius * kFollowedOfRadius;
}

}  // namespace

/// Whether it is a cylinder or capsule and a model with curved parts.
bool CylinderContacts::set_shape(const PosedPair& pair) {
  const Model* const model = pair.shell_side().model();
  if (model == nullptr || pair.field_side().model() != nullptr || pair.has_triangles()) {
    return false;
  }
  if (const auto* const cylinder = std::get_if<CylinderField>(&pair.field())) {
    radius_ = cylinder->radius;
    half_length_ = 0.5 * cylinder->length;
    has_rims_ = true;
  } else if (const auto* const capsule = std::get_if<CapsuleField>(&pair.field())) {
    radius_ = capsule->radius;
    half_length_ = 0.5 * capsule->length;
    has_rims_ = false;
  } else {
    return false;
  }
  field_ = SmoothField(pair.shell_side());
  if (!field_.is_smooth()) return false;
  if (model_ != model) before_.clear();
  model_ = model;
  model_from_shape_ = pair.field_from_shell().inverse();
  middle_ = model_from_shape_.translation;
  axis_ = model_from_shape_.rotate({0, 0, 1});
  return true;
}

void CylinderContacts::slide(std::vector<Feature>& features, const PairStep& step, double reach,
                             const TouchScale& scale, std::vector<Contact>& contacts,
                             std::vector<std::uint32_t>& exact) {
  const PosedPair& pair = *step.pair;
  step_ = &step;
  touches_.clear();
  if (!set_shape(pair)) {
    before_.clear();
    return;
  }
  reach_ = reach;
  spacing_ = pair.shell().spacing();
  tolerance_ = kSlideLosesOfMargin * scale.margin;
  same_within_ = kSameOfRadius * scale.radius;
  followed_within_ = kFollowedOfRadius * scale.radius;
  least_curvature_ = kFlatBend / scale.radius;
  const auto samples = std::span(contacts).first(find_from_id(contacts, kInnerContact));
  if (!samples.empty()) {
    field_.start_from(model_->smooth_surface().triangle_of(find_deepest(samples).id));
  }
  look_over();
  std::erase_if(contacts, [&](const Contact& contact) {
    return may_be_of_side(contact, features) && leads(contact, features, exact);
  });
  drop_touches_of_balls(contacts);
  std::erase_if(touches_, [&](const Touch& touch) { return !(touch.at.distance < reach_); });
  number_touches(features.size());
  for (const Touch& touch : touches_) {
    if (features.size() <= touch.number) features.resize(touch.number + 1, {Vec3{}, 0.0});
    features[touch.number] = {touch.at.position, 0.0};
    const std::uint32_t id = kFirstFeature + touch.number;
    // Between its ends, the side touches at right angles to its axis: with the normal of a bore
    // that leans by as little as is not seen, rings sink into the rod that they glide along.
    const bool is_between = std::abs(touch.at.along) < half_length_;
    const Vec3 outwards = is_between ? level(touch.at).outwards : touch.at.outwards;
    contacts.push_back(
        contact_of(features[touch.number], id, static_cast<Vec3f>(outwards), -touch.at.distance));
    exact.push_back(id);
  }
  before_ = touches_;
  std::ranges::sort(contacts, {}, &Contact::id);
  std::ranges::sort(exact);
}

/// Where the model faces the side, without its samples, which may be far apart. At both ends a
/// straight line touches, however it lies; between them, where the model is nearest.
void CylinderContacts::look_over() {
  look_over(-half_length_, 0.0);
  look_over(half_length_, 0.0);
  const double intervals = std::clamp(std::ceil(half_length_ / radius_), 1.0, kMostIntervals);
  const double between = 2.0 * half_length_ / intervals;
  for (int i = 1; i < static_cast<int>(intervals); ++i) {
    look_over(i * between - half_length_, 0.5 * between);
  }
}

/// The circle at a place of the axis; from there up to `aside` along the axis to lower ones.
void CylinderContacts::look_over(double along, double aside) {
  const GridField& grid = model_->grid();
  const double reach = reach_ + aside + static_cast<double>(model_->smooth_surface().most_lift());
  const Vec3 center = middle_ + along * axis_;
  const auto may_touch = [&](float bound) { return static_cast<double>(bound) < reach; };
  if (!may_touch(grid.lower_bound(static_cast<Vec3f>(center), static_cast<float>(radius_)))) return;
  std::array<Vec3, kEightDirections.size()> outs;
  EightPoints places;
  EightFloats radii;
  radii.fill(static_cast<float>(kBetweenStarts * radius_));
  for (std::size_t i = 0; i < outs.size(); ++i) {
    const auto& [x, y] = kEightDirections[i];
    outs[i] = model_from_shape_.rotate({x, y, 0.0});
    places.set(i, static_cast<Vec3f>(center + radius_ * outs[i]));
  }
  const EightFloats bounds = grid.bound_balls(places, radii).lower_bound;
  for (std::size_t i = 0; i < outs.size(); ++i) {
    if (!may_touch(bounds[i])) continue;
    const Vec3 direction = approach(along, outs[i]);
    if (is_faced(along, direction)) continue;
    if (aside > 0.0) {
      const float distance = grid.distance(static_cast<Vec3f>(center + radius_ * direction));
      if (!may_touch(distance) || is_over_line(along, direction, static_cast<double>(distance))) {
        continue;
      }
    }
    const auto section = face(along, direction);
    if (!section) continue;
    if (aside > 0.0) {
      find_touch(*section);
    } else if (find_known(*section) == nullptr) {
      add(*section);
    }
  }
}

/// Of a contact that is a sample of a curved part, or of a rim, where it is on the shape, from its
/// middle.
Vec3 CylinderContacts::arm_of(const Contact& contact, const std::vector<Feature>& features) const {
  if (contact.id >= kFirstFeature) return features[contact.id - kFirstFeature].place - middle_;
  return static_cast<Vec3>(contact.point) +
         static_cast<double>(contact.depth) * static_cast<Vec3>(contact.normal) - middle_;
}

/// Not of a flat end of a cylinder, nor of a ball that ends a capsule.
bool CylinderContacts::may_be_of_side(const Contact& contact,
                                      const std::vector<Feature>& features) const {
  if (contact.id >= kInnerContact && (contact.id < kFirstFeature || !has_rims_)) return false;
  const double leans = dot(static_cast<Vec3>(contact.normal), axis_);
  if (has_rims_) return leans * leans <= 1.0 - kFlatRim * kFlatRim;
  return std::abs(dot(arm_of(contact, features), axis_)) <= half_length_;
}

/// Whether a contact is a sample of what the touches are, to which new ones are added.
bool CylinderContacts::leads(const Contact& contact, const std::vector<Feature>& features,
                             std::span<const std::uint32_t> exact) {
  const Vec3 arm = arm_of(contact, features);
  const double along = std::clamp(dot(arm, axis_), -half_length_, half_length_);
  const double distance = -static_cast<double>(contact.depth);
  const SmoothSurface& surface = model_->smooth_surface();
  auto lift = static_cast<double>(surface.most_lift());
  if (contact.id < kInnerContact) {
    const std::uint32_t triangle = surface.triangle_of(contact.id);
    if (surface.is_flat(triangle)) {
      // Of two that are one, one stays.
      return std::ranges::binary_search(exact, contact.id) &&
             std::ranges::any_of(touches_, [&](const Touch& touch) {
               const Vec3 apart = touch.at.position - middle_ - arm;
               return touch.holds && squared_length(apart) <= same_within_ * same_within_;
             });
    }
    lift = static_cast<double>(surface.lift(triangle));
    if (is_behind(static_cast<Vec3>(contact.point), -static_cast<Vec3>(contact.normal), along)) {
      return true;
    }
  }
  const Vec3 direction = approach(along, normalized(arm - dot(arm, axis_) * axis_));
  if (is_faced(along, direction) || is_over_line(along, direction, distance)) return true;
  const auto start = face(along, direction);
  // Another wall.
  if (!start || start->distance > distance + lift + tolerance_) return false;
  return find_touch(*start);
}

/// Adds what a section leads to, if it is new. Whether that holds.
bool CylinderContacts::find_touch(const Section& start) {
  if (is_covered(start)) return true;
  const Section end = go_down(start);
  if (is_covered(end)) return true;
  const Touch* touch = find_known(end);
  if (touch == nullptr) touch = &add(end);
  return touch->holds;
}

CylinderContacts::Touch& CylinderContacts::add(const Section& section) {
  const Contact contact = contact_of({section.position, 0.0}, kFirstFeature,
                                     static_cast<Vec3f>(section.outwards), -section.distance);
  // From afar, another place than the nearest may come to touch.
  const bool holds = section.distance <= followed_within_ && may_reach(*step_, contact, 0.0);
  return touches_.emplace_back(Touch{section, 0, holds});
}

/// The direction that a few normals of the grid lead to. They are of facets, but cost little.
Vec3 CylinderContacts::approach(double along, const Vec3& out) const {
  const Vec3 center = middle_ + along * axis_;
  Vec3 direction = out;
  for (int i = 0; i < kApproachSteps; ++i) {
    const auto place = static_cast<Vec3f>(center + radius_ * direction);
    const auto outwards = static_cast<Vec3>(model_->grid().gradient(place));
    const Vec3 across = dot(outwards, axis_) * axis_ - outwards;
    if (squared_length(across) < kFlatRim * kFlatRim) return out;
    direction = normalized(across);
  }
  // What is known there is a better guess.
  for (const Touch& touch : touches_) {
    if (are_near(touch.at.out, direction)) return touch.at.out;
  }
  return direction;
}

/// Whether a section is known to be faced there.
bool CylinderContacts::is_faced(double along, const Vec3& out) const {
  return std::ranges::any_of(touches_, [&](const Touch& touch) {
    return touch.holds && std::abs(touch.at.along - along) <= same_within_ &&
           are_near(touch.at.out, out);
  });
}

/// From a place of the side on. None where the model faces it only along the axis, from behind, or
/// all around, as a hole does its peg.
std::optional<CylinderContacts::Section> CylinderContacts::face(double along, const Vec3& out) {
  const Vec3 center = middle_ + along * axis_;
  Vec3 outwards;
  const auto side_at = [&](const Vec3& direction) {
    const Vec3 across = direction - dot(direction, axis_) * axis_;
    return center + radius_ * normalized(across);
  };
  const auto place_at = [&](const Vec3& direction) { return std::optional(side_at(direction)); };
  const auto feel = [&](const Vec3& position) {
    const SmoothField::Value there = field_.at(position);
    outwards = there.outwards;
    const Vec3 across = outwards - dot(outwards, axis_) * axis_;
    const bool is_flat = squared_length(across) < kFlatRim * kFlatRim;
    return Facing{position, is_flat ? Vec3{} : normalized(across), there.distance};
  };
  const Vec3 direction = -feel(side_at(out)).outwards;
  if (direction == Vec3{}) return std::nullopt;
  const auto facing = face_field(direction, direction - out, kFollowsOfSmoothTurn,
                                 kSmoothSlideWithin, place_at, feel);
  if (!facing || facing->distance <= -radius_) return std::nullopt;
  return Section{along, normalized(facing->position - center), facing->position, outwards,
                 facing->distance};
}

/// Along the side, to where the model is nearest, or its surface ends.
CylinderContacts::Section CylinderContacts::go_down(const Section& start) {
  Section at = start;
  double step = spacing_;
  const double downwards = slope_of(start) > 0.0 ? -1.0 : 1.0;
  while (std::abs(slope_of(at)) > kStraightLean && downwards * at.along < half_length_) {
    const double along = std::clamp(at.along + downwards * step, -half_length_, half_length_);
    const auto next = face(along, at.out);
    const bool goes_on = next && next->distance <= at.distance + tolerance_;
    if (next && downwards * slope_of(*next) > kStraightLean) {
      const auto level = find_level(at, *next);
      if (level) return *level;
    }
    if (goes_on && downwards * slope_of(*next) <= kStraightLean) {
      at = *next;
      step *= 2.0;
      continue;
    }
    step *= 0.25;
    if (step < same_within_) return level(at);
  }
  return at;
}

/// Between two sections with slopes to each other.
std::optional<CylinderContacts::Section> CylinderContacts::find_level(Section above,
                                                                      Section beyond) {
  for (int i = 0; i < kMostZeroSteps; ++i) {
    const double a = slope_of(above);
    const double b = slope_of(beyond);
    // Secants that hold one end get stuck where the slope bends.
    double fraction = i % 3 == 2 ? 0.5 : a / (a - b);
    fraction = std::clamp(fraction, 0.02, 0.98);
    const auto between = face(above.along + fraction * (beyond.along - above.along),
                              fraction < 0.5 ? above.out : beyond.out);
    if (!between) return std::nullopt;
    const double slope = slope_of(*between);
    if (std::abs(slope) <= kStraightLean) return between;
    const double left = std::abs(beyond.along - above.along);
    (slope * a > 0.0 ? above : beyond) = *between;
    if (left < same_within_ * kSameOfRadius) {
      return level(above.distance < beyond.distance ? above : beyond);
    }
  }
  return std::nullopt;
}

/// On an edge of the model, which has all normals between those of its faces: the side's is the one
/// that both have.
CylinderContacts::Section CylinderContacts::level(const Section& section) const {
  Section level = section;
  level.outwards = normalized(section.outwards - slope_of(section) * axis_);
  return level;
}

/// Whether the model faces the side in one direction at both.
bool CylinderContacts::are_of_line(const Section& a, const Section& b) {
  return squared_length(a.outwards - b.outwards) <= 4.0 * kStraightLean * kStraightLean;
}

const CylinderContacts::Touch* CylinderContacts::find_known(const Section& section) const {
  const auto found = std::ranges::find_if(touches_, [&](const Touch& touch) {
    return squared_length(touch.at.position - section.position) <= same_within_ * same_within_;
  });
  return found == touches_.end() ? nullptr : &*found;
}

/// Whether a place of the model lies behind the tangent plane of a touch, so that the side, which
/// is round about its axis and straight along it, touches there before.
bool CylinderContacts::is_behind(const Vec3& place, const Vec3& outwards, double along) const {
  return std::ranges::any_of(touches_, [&](const Touch& touch) {
    const Section& at = touch.at;
    if (!touch.holds) return false;
    // The other side of a wall faces away.
    if (!(dot(outwards, at.outwards) > 0.0) || std::abs(slope_of(at)) > kStraightLean) return false;
    const Vec3 aside = place - (at.position - at.distance * at.outwards);
    const double apart = along - at.along;
    const bool is_beside = std::abs(apart) <= same_within_;
    const double most = is_beside ? tolerance_ : -least_curvature_ * apart * apart;
    return dot(aside, at.outwards) <= most;
  });
}

/// Whether touches that hold say all that a section does: it is one of them, on a straight line
/// between two, or the model bends away from one to it.
bool CylinderContacts::is_covered(const Section& section) const {
  const Touch* const known = find_known(section);
  return (known != nullptr && known->holds) ||
         is_behind(section.position - section.distance * section.outwards, section.outwards,
                   section.along) ||
         is_over_line(section.along, section.out, section.distance);
}

/// Whether a place of the side lies between two touches that the model faces in one direction, and
/// no nearer to it than their straight line is.
bool CylinderContacts::is_over_line(double along, const Vec3& out, double distance) const {
  for (const Touch& left : touches_) {
    if (!(left.at.along < along) || !are_near(left.at.out, out)) continue;
    for (const Touch& right : touches_) {
      if (!(right.at.along > along) || !are_of_line(left.at, right.at)) continue;
      if (!left.holds && !right.holds) continue;
      const double fraction = (along - left.at.along) / (right.at.along - left.at.along);
      const double between = left.at.distance + fraction * (right.at.distance - left.at.distance);
      if (distance >= between - tolerance_) return true;
    }
  }
  return false;
}

/// Those where a capsule's side ends are of its balls, if these touch there or beyond.
void CylinderContacts::drop_touches_of_balls(std::span<const Contact> contacts) {
  if (has_rims_) return;
  const auto of_balls = contacts.subspan(find_from_id(contacts, kFirstFeature));
  std::erase_if(touches_, [&](const Touch& touch) {
    const Section& at = touch.at;
    if (std::abs(at.along) < half_length_) return false;
    if (slope_of(at) * at.along < 0.0) return true;
    const Vec3 place = at.position - at.distance * at.outwards;
    return std::ranges::any_of(of_balls, [&](const Contact& contact) {
      const Vec3 apart = static_cast<Vec3>(contact.point) - place;
      return squared_length(apart) <= same_within_ * same_within_;
    });
  });
}

/// Those near one of the step before have its number, others the next that is free.
void CylinderContacts::number_touches(std::size_t first) {
  taken_.clear();
  for (Touch& touch : touches_) touch.number = 0;
  for (const Touch& then : before_) {
    Touch* nearest = nullptr;
    double least = followed_within_ * followed_within_;
    for (Touch& touch : touches_) {
      const double apart = squared_length(touch.at.position - then.at.position);
      if (touch.number != 0 || apart > least) continue;
      least = apart;
      nearest = &touch;
    }
    if (nearest == nullptr) continue;
    nearest->number = then.number;
    taken_.push_back(then.number);
  }
  auto next = static_cast<std::uint32_t>(first);
  for (Touch& touch : touches_) {
    if (touch.number != 0) continue;
    while (std::ranges::find(taken_, next) != taken_.end()) ++next;
    touch.number = next++;
  }
}

}  // namespace voxshell::bullet
