#pragma once

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <variant>

#include "simd/exact_view.h"
#include "simd/posed_view.h"
#include "simd/tree_view.h"
#include "voxshell/field.h"
#include "voxshell/point_shell.h"
#include "voxshell/pose.h"

namespace voxshell {

/// What float32 arithmetic on coordinates up to `magnitude` metres may add to or take from a
/// distance: 32 units in the last place, several times what the longest chain of operations needs.
inline float compute_rounding_slack(double magnitude) {
  constexpr double kUlp = 1.0 / (1 << 23);
  return static_cast<float>(32.0 * kUlp * magnitude);
}

inline double compute_reach(const PointSphereTree& tree) {
  const Sphere& root = tree.spheres(1)[0];
  return length(static_cast<Vec3>(root.centre)) + static_cast<double>(root.radius);
}

/// The radius about the shell's origin that holds all its points and edges.
inline double compute_reach(const PointShell& shell) {
  const double of_points = compute_reach(shell.tree());
  const EdgeSegments* edges = shell.edges();
  if (edges == nullptr) return of_points;
  return std::max(of_points, compute_reach(edges->tree()) + static_cast<double>(edges->reach()));
}

inline void write_floats(const Vec3& from, float (&to)[3]) {
  const auto rounded = static_cast<Vec3f>(from);
  to[0] = rounded.x;
  to[1] = rounded.y;
  to[2] = rounded.z;
}

/// The field as the shell sees it; `view` is the field's, which callers have at hand. The pose is
/// worked out in float64 and applied in float32.
template <class F, class V>
simd::PosedView<V> make_posed(const F& field, const V& view, const PointShell& shell,
                              const Pose& field_from_shell) {
  simd::PosedView<V> posed;
  posed.field = view;
  write_floats(field_from_shell.rotation.row_x, posed.row_x);
  write_floats(field_from_shell.rotation.row_y, posed.row_y);
  write_floats(field_from_shell.rotation.row_z, posed.row_z);
  write_floats(field_from_shell.translation, posed.translation);
  posed.slack = compute_rounding_slack(field.reach() + compute_reach(shell) +
                                       length(field_from_shell.translation));
  return posed;
}

/// A plane is carried into the shell's frame once, in float64: cheaper, and as precise far from its
/// origin as near it.
inline simd::PosedView<simd::PlaneView> make_posed(const PlaneField& plane, const simd::PlaneView&,
                                                   const PointShell& shell,
                                                   const Pose& field_from_shell) {
  simd::PosedView<simd::PlaneView> posed;
  write_floats(field_from_shell.rotation.transposed() * plane.normal, posed.field.normal);
  const double offset = plane.offset - dot(plane.normal, field_from_shell.translation);
  posed.field.offset = static_cast<float>(offset);
  posed.slack = compute_rounding_slack(std::abs(offset) + compute_reach(shell));
  return posed;
}

/// Calls `visit` with the field and its view, whatever its type.
template <class Visit>
auto with_view(const Field& field, const Visit& visit) {
  return std::visit(
      [&]<class F>(const F& typed) {
        if constexpr (std::is_same_v<F, GridField>) {
          if (typed.has_exact_cells()) return visit(typed, typed.exact_view());
        }
        return visit(typed, typed.view());
      },
      field);
}

/// Calls `visit` with the field as the shell sees it, whatever its type.
template <class Visit>
auto with_posed(const Field& field, const PointShell& shell, const Pose& field_from_shell,
                const Visit& visit) {
  return with_view(field, [&](const auto& typed, const auto& view) {
    return visit(make_posed(typed, view, shell, field_from_shell));
  });
}

inline simd::TreeView view_tree(const PointShell& shell) {
  simd::TreeView tree = shell.tree().view();
  tree.normals = &shell.normals().data()->x;
  return tree;
}

}  // namespace voxshell
