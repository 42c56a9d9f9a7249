#include "smooth_field.h"

#include <cmath>
#include <variant>

#include "contact_constants.h"

namespace voxshell::bullet {

SmoothField::SmoothField(const Side& side) : field_(side.participant().field) {
  // Uniform models are what their grids say.
  if (side.model() != nullptr && side.has_sharp_field()) round_ = RoundSide::of(side);
}

SmoothField::Value SmoothField::at(const Vec3& place) {
  if (round_) {
    const auto nearest = round_->nearest(place, before_ ? &*before_ : nullptr);
    if (nearest) {
      before_ = nearest;
      const Vec3 apart = place - nearest->position;
      const double distance = dot(apart, nearest->normal);
      const Vec3 aside = apart - distance * nearest->normal;
      // Beyond the end of a round part, its edge is nearest.
      const double tolerance = round_->model()->settings().tolerance;
      if (length(aside) <= tolerance + kAsideOfDistance * std::abs(distance)) {
        return {distance, nearest->normal};
      }
    }
  }
  return std::visit(
      [&](const auto& field) {
        const auto at = static_cast<Vec3f>(place);
        return Value{static_cast<double>(field.distance(at)),
                     normalized(static_cast<Vec3>(field.gradient(at)))};
      },
      *field_);
}

}  // namespace voxshell::bullet
