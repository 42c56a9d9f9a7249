#include "voxshell/capsule_field.h"

#include "field/evaluate.h"
#include "simd/analytic_formula.h"

namespace voxshell {

float CapsuleField::distance(const Vec3f& p) const { return distance_at(view(), p); }

Vec3f CapsuleField::gradient(const Vec3f& p) const { return gradient_at(view(), p); }

float CapsuleField::lower_bound(const Vec3f& center, float ball_radius) const {
  return lower_bound_at(view(), center, ball_radius);
}

double CapsuleField::reach() const { return radius + length / 2.0; }

simd::CapsuleView CapsuleField::view() const {
  return {static_cast<float>(radius), static_cast<float>(length / 2.0)};
}

}  // namespace voxshell
