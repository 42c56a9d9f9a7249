#include "voxshell/plane_field.h"

#include <cmath>

#include "field/evaluate.h"
#include "simd/analytic_formula.h"

namespace voxshell {

float PlaneField::distance(const Vec3f& p) const { return distance_at(view(), p); }

Vec3f PlaneField::gradient(const Vec3f& p) const { return gradient_at(view(), p); }

float PlaneField::lower_bound(const Vec3f& center, float radius) const {
  return lower_bound_at(view(), center, radius);
}

double PlaneField::reach() const { return std::abs(offset); }

simd::PlaneView PlaneField::view() const {
  const auto n = static_cast<Vec3f>(normal);
  return {{n.x, n.y, n.z}, static_cast<float>(offset)};
}

}  // namespace voxshell
