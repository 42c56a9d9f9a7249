#pragma once

#include "simd/analytic_formula.h"
#include "simd/grid_formula.h"

namespace voxshell::simd {

/// A field as a point shell sees it: a view of it and the pose that takes coordinates of the
/// shell's frame to the field's.
template <class V>
struct PosedView {
  V field;
  float row_x[3], row_y[3], row_z[3];  ///< of the rotation field_from_shell
  float translation[3];
  float slack;  ///< the most that float32 adds to or takes from a distance, meters
};

/// A plane lies in the shell's frame already: cheaper, and as precise far from its origin as near.
template <>
struct PosedView<PlaneView> {
  PlaneView field;
  float slack;
};

namespace VOXSHELL_ISA {

template <class V, class F>
VOXSHELL_INLINE Triple<F> to_field(const PosedView<V>& posed, const Triple<F>& p) {
  const auto along = [&](const float (&row)[3]) {
    return row[0] * p.x + row[1] * p.y + row[2] * p.z;
  };
  return {along(posed.row_x) + posed.translation[0], along(posed.row_y) + posed.translation[1],
          along(posed.row_z) + posed.translation[2]};
}

template <class V, class F>
VOXSHELL_INLINE Triple<F> to_shell(const PosedView<V>& posed, const Triple<F>& direction) {
  const auto along = [&](int axis) {
    return posed.row_x[axis] * direction.x + posed.row_y[axis] * direction.y +
           posed.row_z[axis] * direction.z;
  };
  return {along(0), along(1), along(2)};
}

template <class F>
VOXSHELL_INLINE Triple<F> to_field(const PosedView<PlaneView>&, const Triple<F>& p) {
  return p;
}
template <class F>
VOXSHELL_INLINE Triple<F> to_shell(const PosedView<PlaneView>&, const Triple<F>& direction) {
  return direction;
}

template <class V, class F>
VOXSHELL_INLINE F posed_distance(const PosedView<V>& posed, const Triple<F>& p) {
  return evaluate_distance(posed.field, to_field(posed, p));
}

/// Outward unit normal, the shell's frame; zero where the field has no gradient.
template <class V, class F>
VOXSHELL_INLINE Triple<F> posed_normal(const PosedView<V>& posed, const Triple<F>& p) {
  return normalized(to_shell(posed, evaluate_gradient(posed.field, to_field(posed, p))));
}

}  // namespace VOXSHELL_ISA
}  // namespace voxshell::simd
