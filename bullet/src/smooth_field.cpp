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

void SmoothField::start_from(std::uint32_t triangle) {
  if (!round_) return;
  constexpr double kThird = 1.0 / 3.0;
  const SmoothSurface::Place middle{triangle, {kThird, kThird, kThird}};
  const SmoothSurface& surface = round_->model()->smooth_surface();
  before_ = RoundSide::Place{surface.position(middle), surface.normal(middle), middle};
}

/// None beyond the end of a round part, whose edge is nearest.
std::optional<SmoothField::Value> SmoothField::value_at(const Vec3& place,
                                                        const RoundSide::Place& nearest) const {
  const Vec3 apart = place - nearest.position;
  const double distance = dot(apart, nearest.normal);
  const double aside = length(apart - distance * nearest.normal);
  if (aside > tolerance_ + kAsideOfDistance * std::abs(distance)) return std::nullopt;
  return Value{distance, nearest.normal};
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
  // What is near on the way along the surface need not be what is nearest.
  const auto walk_from = [&](const RoundSide::Place& start) -> std::optional<Value> {
    const auto near = round_->nearest_from(start, place);
    if (!near) return std::nullopt;
    const auto found = value_at(place, *near);
    const double within = walk_within_ + kFarFieldError * std::abs(value.distance);
    if (!found || std::abs(found->distance - value.distance) > within) return std::nullopt;
    before_ = near;
    return found;
  };
  if (before_) {
    if (const auto found = walk_from(*before_)) return *found;
  }
  const auto below =
      round_->nearest(place - value.distance * value.outwards, before_ ? &*before_ : nullptr);
  if (!below) return value;
  before_ = below;
  return walk_from(*below).value_or(value);
}

}  // namespace voxshell::bullet
