#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <variant>

#include "simd/exact_view.h"
#include "simd/posed_view.h"
#include "simd/tree_view.h"
#include "voxshell/field.h"
#include "voxshell/point_shell.h"
#include "voxshell/pose.h"

namespace voxshell {

/// The most that float32 arithmetic on coordinates up to `magnitude` meters adds to or takes from a
/// distance: 32 units in the last place, several times what the longest chain of operations needs.
inline float compute_rounding_slack(double magnitude) {
  constexpr double kUlp = 1.0 / (1 << 23);
  return static_cast<float>(32.0 * kUlp * magnitude);
}

inline double compute_reach(const PointSphereTree& tree) {
  const Sphere& root = tree.spheres(1)[0];
  return length(static_cast<Vec3>(root.center)) + static_cast<double>(root.radius);
}

/// The radius about the shell's origin that holds all its points and edges.
inline double compute_reach(const PointShell& shell) {
  const double of_points = compute_reach(shell.tree());
  const EdgeSegments* edges = shell.edges();
  if (edges == nullptr) return of_points;
  return std::max(of_points, compute_reach(edges->tree()) + static_cast<double>(edges->reach()));
}

/// Rounds to a multiple of a power of two times `size`: to a sixty-fourth or less of what float32
/// can tell at coordinates of that size. float32 would keep far smaller digits of numbers near
/// zero, and the sign of zero; without them, bodies that tremble by less ask the same questions
/// again.
class Quantum {
 public:
  explicit Quantum(double size) {
    int exponent = 0;
    std::frexp(size, &exponent);
    constexpr int kBits = 30;
    constexpr int kMantissaBits = 52;
    shift_ = std::ldexp(1.5, exponent - kBits + kMantissaBits);
  }
  void round(const Vec3& from, float (&to)[3]) const {
    to[0] = round(from.x);
    to[1] = round(from.y);
    to[2] = round(from.z);
  }
  /// A sum so large has no room for smaller digits.
  float round(double number) const { return static_cast<float>((number + shift_) - shift_); }

 private:
  double shift_;
};

/// The field as the shell sees it; `view` is the field's, which callers have at hand. The pose is
/// worked out in float64 and applied in float32.
template <class F, class V>
simd::PosedView<V> make_posed(const F& field, const V& view, const PointShell& shell,
                              const Pose& field_from_shell) {
  simd::PosedView<V> posed;
  posed.field = view;
  const Quantum of_turns(1.0);
  of_turns.round(field_from_shell.rotation.row_x, posed.row_x);
  of_turns.round(field_from_shell.rotation.row_y, posed.row_y);
  of_turns.round(field_from_shell.rotation.row_z, posed.row_z);
  const double reach = field.reach() + compute_reach(shell);
  Quantum(reach).round(field_from_shell.translation, posed.translation);
  posed.slack = compute_rounding_slack(reach + length(field_from_shell.translation));
  return posed;
}

/// A plane is carried into the shell's frame once, in float64: cheaper, and as precise far from its
/// origin as near it.
inline simd::PosedView<simd::PlaneView> make_posed(const PlaneField& plane, const simd::PlaneView&,
                                                   const PointShell& shell,
                                                   const Pose& field_from_shell) {
  simd::PosedView<simd::PlaneView> posed;
  Quantum(1.0).round(field_from_shell.rotation.transposed() * plane.normal, posed.field.normal);
  const double offset = plane.offset - dot(plane.normal, field_from_shell.translation);
  const double reach = compute_reach(shell);
  posed.field.offset = Quantum(reach).round(offset);
  posed.slack = compute_rounding_slack(std::abs(offset) + reach);
  return posed;
}

/// All that an answer depends on beside field, shell and options. Not the slack, by which no answer
/// differs.
using PosedBits = std::array<std::uint32_t, 12>;

template <class V>
PosedBits bits_of(const simd::PosedView<V>& posed) {
  PosedBits bits{};
  std::size_t count = 0;
  const auto append = [&](const auto& floats) {
    for (const float value : floats) bits[count++] = std::bit_cast<std::uint32_t>(value);
  };
  append(posed.row_x);
  append(posed.row_y);
  append(posed.row_z);
  append(posed.translation);
  return bits;
}

inline PosedBits bits_of(const simd::PosedView<simd::PlaneView>& posed) {
  const float (&normal)[3] = posed.field.normal;
  return {std::bit_cast<std::uint32_t>(normal[0]), std::bit_cast<std::uint32_t>(normal[1]),
          std::bit_cast<std::uint32_t>(normal[2]),
          std::bit_cast<std::uint32_t>(posed.field.offset)};
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
