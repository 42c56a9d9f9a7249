#include "voxshell/sphere_field.h"

#include "field/evaluate.h"
#include "simd/analytic_formula.h"

namespace voxshell {

float SphereField::distance(const Vec3f& p) const { return distance_at(view(), p); }

Vec3f SphereField::gradient(const Vec3f& p) const { return gradient_at(view(), p); }

float SphereField::lower_bound(const Vec3f& center, float ball_radius) const {
  return lower_bound_at(view(), center, ball_radius);
}

double SphereField::reach() const { return radius; }

simd::SphereView SphereField::view() const { return {static_cast<float>(radius)}; }

}  // namespace voxshell
