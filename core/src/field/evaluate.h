#pragma once

#include "simd/wide.h"
#include "voxshell/vector.h"

namespace voxshell {

// A field's formula, which kernels use for eight points, at one.

inline simd::VOXSHELL_ISA::Triple<float> to_triple(const Vec3f& p) { return {p.x, p.y, p.z}; }

template <class View>
float distance_at(const View& field, const Vec3f& p) {
  return evaluate_distance(field, to_triple(p));
}

template <class View>
Vec3f gradient_at(const View& field, const Vec3f& p) {
  const auto g = evaluate_gradient(field, to_triple(p));
  return {g.x, g.y, g.z};
}

template <class View>
float lower_bound_at(const View& field, const Vec3f& center, float radius) {
  return evaluate_lower_bound(field, to_triple(center), radius);
}

}  // namespace voxshell
