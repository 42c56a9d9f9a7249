#include "cylinder_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <variant>

#include "contact_constants.h"
#include "face_field.h"
#include "second_shell.h"

namespace voxshell::bullet {
namespace {

constexpr double kHalf = 0.70710678118654752;  // the cosine of 45 degrees

/// From which a section is looked over: no place of it is farther from all of them than
/// kBetweenStarts radii.
constexpr std::array<std::array<double, 2>, 8> kStarts{{{1, 0},
                                                        {kHalf, kHalf},
                                                        {0, 1},
                                                        {-kHalf, kHalf},
                                                        {-1, 0},
                                                        {-kHalf, -kHalf},
                                                        {0, -1},
                                                        {kHalf, -kHalf}}};
constexpr double kBetweenStarts = 0.4;

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
  const Pose model_from_shape = pair.field_from_shell().inverse();
  middle_ = model_from_shape.translation;
  axis_ = model_from_shape.rotate({0, 0, 1});
  return true;
}

void CylinderContacts::slide(std::vector<Feature>& features, const PosedPair& pair, double reach,
                             const TouchScale& scale, std::vector<Contact>& contacts,
                             std::vector<std::uint32_t>& exact) {
  touches_.clear();
  ways_.clear();
  if (!set_shape(pair)) {
    before_.clear();
    return;
  }
  reach_ = reach;
  spacing_ = pair.shell().spacing();
  tolerance_ = kSlideLosesOfMargin * scale.margin;
  same_within_ = kSameOfRadius * scale.radius;
  followed_within_ = kFollowedOfRadius * scale.radius;

  // The ends, where a side without waves touches.
  const Pose model_from_shape = pair.field_from_shell().inverse();
  for (const double along : {-half_length_, half_length_}) {
    for (const auto& [x, y] : kStarts) {
      const Vec3 out = model_from_shape.rotate({x, y, 0.0});
      const Vec3 place = middle_ + along * axis_ + radius_ * out;
      if (field_.at(place).distance - kBetweenStarts * radius_ < reach) lead(along, out);
    }
  }
  const SmoothSurface& surface = model_->smooth_surface();
  const auto is_exact = [&](const Contact& contact) {
    return std::ranges::binary_search(exact, contact.id);
  };
  const auto leads = [&](const Contact& contact) {
    const bool is_sample = contact.id < kInnerContact;
    if (!is_sample && (contact.id < kFirstFeature || !has_rims_)) return false;
    Vec3 arm;
    if (is_sample) {
      arm = static_cast<Vec3>(contact.point) +
            static_cast<double>(contact.depth) * static_cast<Vec3>(contact.normal) - middle_;
    } else {
      arm = features[contact.id - kFirstFeature].place - middle_;
    }
    const double along = dot(arm, axis_);
    const Vec3 across = arm - along * axis_;
    // On the flat side of a cylinder, or on a ball that ends a capsule.
    const auto normal = static_cast<Vec3>(contact.normal);
    const double leans = dot(normal, axis_);
    if (has_rims_ ? leans * leans > 1.0 - kFlatRim * kFlatRim : std::abs(along) > half_length_) {
      return false;
    }
    const Vec3 out = normalized(across);
    if (is_sample && is_exact(contact)) {
      // Of two that are one, one stays.
      return std::ranges::any_of(touches_, [&](const Touch& touch) {
        const Vec3 apart = touch.at.position - middle_ - arm;
        return squared_length(apart) <= same_within_ * same_within_;
      });
    }
    if (is_sample && surface.is_flat(surface.triangle_of(contact.id))) return false;
    return lead(std::clamp(along, -half_length_, half_length_), out);
  };
  std::erase_if(contacts, leads);
  // Those of a capsule's ends are of its balls.
  if (!has_rims_) {
    std::erase_if(touches_, [&](const Touch& touch) {
      return std::abs(touch.at.along) >= half_length_;
    });
  }
  std::erase_if(touches_, [&](const Touch& touch) { return !(touch.at.distance < reach_); });
  number_touches(features.size());
  const std::size_t first = features.size();
  for (const Touch& touch : touches_) {
    const std::size_t index = touch.number;
    if (features.size() <= index) features.resize(index + 1, {Vec3{}, 0.0});
    features[index] = {touch.at.position, 0.0};
    const std::uint32_t id = kFirstFeature + touch.number;
    contacts.push_back(contact_of(features[index], id, static_cast<Vec3f>(touch.at.outwards),
                                  -touch.at.distance));
    exact.push_back(id);
  }
  static_cast<void>(first);
  before_ = touches_;
  std::ranges::sort(contacts, {}, &Contact::id);
  std::ranges::sort(exact);
}

/// From a place of the side on. None where the model faces it only along the axis, or from behind.
std::optional<CylinderContacts::Section> CylinderContacts::face(double along, const Vec3& out) {
  const Vec3 centre = middle_ + along * axis_;
  Vec3 outwards;
  const auto facing = face_field(
      out, {}, std::numeric_limits<double>::infinity(), kSmoothSlideWithin,
      [&](const Vec3& direction) {
        const Vec3 across = direction - dot(direction, axis_) * axis_;
        return std::optional(centre + radius_ * normalized(across));
      },
      [&](const Vec3& position) {
        const SmoothField::Value there = field_.at(position);
        outwards = there.outwards;
        const Vec3 across = outwards - dot(outwards, axis_) * axis_;
        const bool is_flat = squared_length(across) < kFlatRim * kFlatRim;
        return Facing{position, is_flat ? Vec3{} : normalized(across), there.distance};
      });
  if (!facing || facing->distance <= -radius_) return std::nullopt;
  return Section{along, normalized(facing->position - centre), facing->position, outwards,
                 facing->distance};
}

/// Along the side, to where the model is nearest. None where the way ends before that.
std::optional<CylinderContacts::Section> CylinderContacts::go_down(const Section& start) {
  way_.clear();
  Section at = start;
  double step = spacing_;
  const double downwards = slope_of(start) > 0.0 ? -1.0 : 1.0;
  while (std::abs(slope_of(at)) > kStraightLean && downwards * at.along < half_length_) {
    const double along = std::clamp(at.along + downwards * step, -half_length_, half_length_);
    const auto next = face(along, at.out);
    if (!next) return std::nullopt;
    if (downwards * slope_of(*next) > kStraightLean) {
      const auto level = find_level(at, *next);
      if (!level) return std::nullopt;
      way_.push_back({at, *level});
      return level;
    }
    // A step, on which the next surface is another.
    if (next->distance > at.distance + tolerance_) return std::nullopt;
    way_.push_back({at, *next});
    at = *next;
    step *= 2.0;
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
    if (left < same_within_ * kSameOfRadius) return between;
    (slope * a > 0.0 ? above : beyond) = *between;
  }
  return std::nullopt;
}

/// Whether a way to a known touch has led through a section.
bool CylinderContacts::is_known(const Section& section) const {
  const auto is_near = [&](const Vec3& position, double within) {
    return squared_length(position - section.position) <= within * within;
  };
  for (const Touch& touch : touches_) {
    if (is_near(touch.at.position, same_within_)) return true;
  }
  for (const Step& step : ways_) {
    const double length = step.to.along - step.from.along;
    if (length == 0.0) continue;
    const double fraction = (section.along - step.from.along) / length;
    if (!(fraction >= 0.0 && fraction <= 1.0)) continue;
    const Vec3 there = step.from.position + fraction * (step.to.position - step.from.position);
    if (is_near(there, followed_within_)) return true;
  }
  return false;
}

/// Whether it lies on a straight line between two touches, with nothing that they do not say.
bool CylinderContacts::adds_nothing(const Section& section) const {
  const auto is_of_line = [&](const Touch& touch) {
    return squared_length(touch.at.outwards - section.outwards) <=
           4.0 * kStraightLean * kStraightLean;
  };
  for (const Touch& left : touches_) {
    if (!(left.at.along < section.along) || !is_of_line(left)) continue;
    for (const Touch& right : touches_) {
      if (!(right.at.along > section.along) || !is_of_line(right)) continue;
      const double fraction =
          (section.along - left.at.along) / (right.at.along - left.at.along);
      const double between =
          left.at.distance + fraction * (right.at.distance - left.at.distance);
      if (section.distance >= between - tolerance_) return true;
    }
  }
  return false;
}

/// Adds the touch that a place of the side leads to. Whether it leads to one.
bool CylinderContacts::lead(double along, const Vec3& out) {
  const auto start = face(along, out);
  if (!start) return false;
  if (is_known(*start)) return true;
  const auto end = go_down(*start);
  if (!end) return false;
  if (!is_known(*end) && !adds_nothing(*end)) touches_.push_back({*end, 0});
  ways_.insert(ways_.end(), way_.begin(), way_.end());
  return true;
}

/// Those near one of the step before have its number, others the next that is free.
void CylinderContacts::number_touches(std::size_t first) {
  std::vector<std::uint32_t> taken;
  std::vector<bool> is_numbered(touches_.size());
  for (const Touch& then : before_) {
    std::size_t nearest = touches_.size();
    double least = followed_within_ * followed_within_;
    for (std::size_t i = 0; i < touches_.size(); ++i) {
      const double apart = squared_length(touches_[i].at.position - then.at.position);
      if (!is_numbered[i] && apart <= least) {
        least = apart;
        nearest = i;
      }
    }
    if (nearest == touches_.size()) continue;
    touches_[nearest].number = then.number;
    is_numbered[nearest] = true;
    taken.push_back(then.number);
  }
  auto next = static_cast<std::uint32_t>(first);
  const auto is_used = [&](std::uint32_t number) {
    return std::ranges::find(taken, number) != taken.end();
  };
  for (std::size_t i = 0; i < touches_.size(); ++i) {
    if (is_numbered[i]) continue;
    while (is_used(next)) ++next;
    touches_[i].number = next++;
  }
}

}  // namespace voxshell::bullet
