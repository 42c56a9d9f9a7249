#include "voxshell/box_field.h"

#include "field/evaluate.h"
#include "simd/analytic_formula.h"

namespace voxshell {

float BoxField::distance(const Vec3f& p) const { return distance_at(view(), p); }

Vec3f BoxField::gradient(const Vec3f& p) const { return gradient_at(view(), p); }

float BoxField::lower_bound(const Vec3f& center, float radius) const {
  return lower_bound_at(view(), center, radius);
}

double BoxField::reach() const { return length(half_extents); }

simd::BoxView BoxField::view() const {
  const auto h = static_cast<Vec3f>(half_extents);
  return {{h.x, h.y, h.z}};
}

}  // namespace voxshell
