#include "smooth_field.h"

#include <cmath>
#include <variant>

#include "contact_constants.h"

namespace voxshell::bullet {

SmoothField::SmoothField(const Side& side) : field_(side.participant().field) {
  // Uniform models are what their grids say.
  const Model* const model = side.model();
  if (model == nullptr || !side.has_sharp_field()) return;
  round_ = RoundSide::of(side);
  tolerance_ = model->settings().tolerance;
  walk_within_ = tolerance_ + static_cast<double>(model->smooth_surface().most_lift());
  deepest_ = kSmoothOfLift * walk_within_;
}

double SmoothField::faces_within() const { return is_smooth() ? kSmoothSlideWithin : kSlideWithin; }

void SmoothField::start_from(std::uint32_t triangle) {
  if (!round_) return;
  constexpr double kThird = 1.0 / 3.0;
  const SmoothSurface::Place middle{triangle, {kThird, kThird, kThird}};
  const SmoothSurface& surface = round_->model()->smooth_surface();
  before_ = RoundSide::Place::of(surface, middle);
}

/// What the field says beyond the end of a round part, whose edge is nearest, is true.
SmoothField::Value SmoothField::value_at(const Vec3& place, const RoundSide::Place& nearest,
                                         const Value& of_field) const {
  const Vec3 apart = place - nearest.position;
  const double distance = dot(apart, nearest.normal);
  const double aside = length(apart - distance * nearest.normal);
  if (aside > tolerance_ + kAsideOfDistance * std::abs(distance)) return of_field;
  return {distance, nearest.normal};
}

/// By way of the surface; none where what is near so is not what is nearest.
std::optional<SmoothField::Value> SmoothField::walk_from(const RoundSide& round,
                                                         const RoundSide::Place& start,
                                                         const Vec3& place, const Value& of_field) {
  const auto near = round.nearest_from(start, place);
  if (!near) return std::nullopt;
  const double distance = std::abs(of_field.distance);
  const double within = walk_within_ + kFarFieldError * distance;
  if (std::abs(length(place - near->position) - distance) > within) return std::nullopt;
  const Value found = value_at(place, *near, of_field);
  if (std::abs(found.distance - of_field.distance) > within) return std::nullopt;
  before_ = near;
  return found;
}

SmoothField::Value SmoothField::at(const Vec3& place) {
  const auto value = std::visit(
      [&](const auto& field) {
        const auto at = static_cast<Vec3f>(place);
        return Value{static_cast<double>(field.distance(at)),
                     normalized(static_cast<Vec3>(field.gradient(at)))};
      },
      *field_);
  if (!round_ || value.distance < -deepest_) return value;
  const RoundSide& round = *round_;
  if (before_) {
    if (const auto found = walk_from(round, *before_, place, value)) return *found;
  }
  const auto below =
      round.nearest(place - value.distance * value.outwards, before_ ? &*before_ : nullptr);
  if (!below) return value;
  before_ = below;
  return walk_from(round, *below, place, value).value_or(value);
}

std::optional<RoundSide::Place> SmoothField::nearest(const Vec3& place) {
  if (!round_) return std::nullopt;
  const RoundSide& round = *round_;
  if (before_) {
    const double distance = std::visit(
        [&](const auto& field) {
          return static_cast<double>(field.distance(static_cast<Vec3f>(place)));
        },
        *field_);
    if (walk_from(round, *before_, place, {distance, {}})) return before_;
  }
  const auto found = round.nearest(place, before_ ? &*before_ : nullptr);
  if (found) before_ = found;
  return found;
}

}  // namespace voxshell::bullet
