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
  walk_within_ =
      model->settings().tolerance + static_cast<double>(model->smooth_surface().most_lift());
}

/// None beyond the end of a round part, whose edge is nearest.
std::optional<SmoothField::Value> SmoothField::value_at(const Vec3& place,
                                                        const RoundSide::Place& nearest) const {
  const Vec3 apart = place - nearest.position;
  const double distance = dot(apart, nearest.normal);
  const double aside = length(apart - distance * nearest.normal);
  const double tolerance = round_->model()->settings().tolerance;
  if (aside > tolerance + kAsideOfDistance * std::abs(distance)) return std::nullopt;
  return Value{distance, nearest.normal};
}

SmoothField::Value SmoothField::at(const Vec3& place) {
  const auto distance = [&] {
    return std::visit(
        [&](const auto& field) {
          return static_cast<double>(field.distance(static_cast<Vec3f>(place)));
        },
        *field_);
  };
  if (round_ && before_) {
    // What is near on the way along the surface need not be what is nearest.
    const auto near = round_->nearest_from(*before_, place);
    const auto value = near ? value_at(place, *near) : std::nullopt;
    if (value && std::abs(value->distance - distance()) <= walk_within_) {
      before_ = near;
      return *value;
    }
  }
  if (round_) {
    const auto nearest = round_->nearest(place, before_ ? &*before_ : nullptr);
    if (nearest) before_ = nearest;
    const auto value = nearest ? value_at(place, *nearest) : std::nullopt;
    if (value) return *value;
  }
  const Vec3 outwards = std::visit(
      [&](const auto& field) {
        return normalized(static_cast<Vec3>(field.gradient(static_cast<Vec3f>(place))));
      },
      *field_);
  return {distance(), outwards};
}

}  // namespace voxshell::bullet
