#include "voxshell/cone_field.h"

#include <cmath>

#include "field/evaluate.h"
#include "simd/analytic_formula.h"

namespace voxshell {

float ConeField::distance(const Vec3f& p) const { return distance_at(view(), p); }

Vec3f ConeField::gradient(const Vec3f& p) const { return gradient_at(view(), p); }

float ConeField::lower_bound(const Vec3f& center, float ball_radius) const {
  return lower_bound_at(view(), center, ball_radius);
}

double ConeField::reach() const { return std::sqrt(radius * radius + height * height / 4.0); }

simd::ConeView ConeField::view() const {
  const double slant = std::sqrt(radius * radius + height * height);
  return {.radius = static_cast<float>(radius),
          .half_height = static_cast<float>(height / 2.0),
          .slant_r = static_cast<float>(-radius / slant),
          .slant_z = static_cast<float>(height / slant),
          .slant_length = static_cast<float>(slant)};
}

}  // namespace voxshell
