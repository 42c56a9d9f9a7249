#include "voxshell/cylinder_field.h"

#include <cmath>

#include "field/evaluate.h"
#include "simd/analytic_formula.h"

namespace voxshell {

float CylinderField::distance(const Vec3f& p) const { return distance_at(view(), p); }

Vec3f CylinderField::gradient(const Vec3f& p) const { return gradient_at(view(), p); }

float CylinderField::lower_bound(const Vec3f& center, float ball_radius) const {
  return lower_bound_at(view(), center, ball_radius);
}

double CylinderField::reach() const { return std::sqrt(radius * radius + length * length / 4.0); }

simd::CylinderView CylinderField::view() const {
  return {static_cast<float>(radius), static_cast<float>(length / 2.0)};
}

}  // namespace voxshell
