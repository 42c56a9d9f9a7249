#pragma once

#include <algorithm>
#include <cmath>

#include "voxshell/field.h"
#include "voxshell/point_sphere_tree.h"
#include "voxshell/pose.h"

namespace voxshell {

/// What float32 arithmetic on coordinates up to `magnitude` metres may add to or take from a
/// distance: 32 units in the last place, several times what the longest chain of operations needs.
inline float compute_rounding_slack(double magnitude) {
  constexpr double kUlp = 1.0 / (1 << 23);
  return static_cast<float>(32.0 * kUlp * magnitude);
}

/// A field as a point shell sees it: all coordinates in the shell's frame. The pose is worked out
/// in float64 and applied in float32. Every query evaluates points through this one class, which is
/// what makes their answers equal bit for bit.
template <class F>
class PosedField {
 public:
  /// `shell_reach`: no point of the shell is farther than this from its origin, metres.
  PosedField(const F& field, const Pose& field_from_shell, double shell_reach)
      : field_(field),
        row_x_(static_cast<Vec3f>(field_from_shell.rotation.row_x)),
        row_y_(static_cast<Vec3f>(field_from_shell.rotation.row_y)),
        row_z_(static_cast<Vec3f>(field_from_shell.rotation.row_z)),
        translation_(static_cast<Vec3f>(field_from_shell.translation)),
        slack_(compute_rounding_slack(field.reach() + shell_reach +
                                      length(field_from_shell.translation))) {}

  float distance(const Vec3f& p) const { return field_.distance(to_field(p)); }

  /// Outward unit normal; zero where the field has no gradient.
  Vec3f normal(const Vec3f& p) const {
    const Vec3f g = field_.gradient(to_field(p));
    return normalized(row_x_ * g.x + row_y_ * g.y + row_z_ * g.z);
  }

  /// False only if no point in the sphere can have a distance below `margin`.
  bool may_contain_below(const Sphere& sphere, float margin) const {
    return !(field_.lower_bound(to_field(sphere.centre), sphere.radius) - slack_ >= margin);
  }

 private:
  Vec3f to_field(const Vec3f& p) const {
    return Vec3f{dot(row_x_, p), dot(row_y_, p), dot(row_z_, p)} + translation_;
  }

  const F& field_;
  Vec3f row_x_, row_y_, row_z_;
  Vec3f translation_;
  float slack_;
};

/// A plane is carried into the shell's frame once, in float64: cheaper, and as precise far from its
/// origin as near it.
template <>
class PosedField<PlaneField> {
 public:
  PosedField(const PlaneField& plane, const Pose& field_from_shell, double shell_reach)
      : normal_(static_cast<Vec3f>(field_from_shell.rotation.transposed() * plane.normal)),
        offset_(static_cast<float>(plane.offset - dot(plane.normal, field_from_shell.translation))),
        slack_(compute_rounding_slack(std::abs(static_cast<double>(offset_)) + shell_reach)) {}

  float distance(const Vec3f& p) const { return dot(normal_, p) - offset_; }
  Vec3f normal(const Vec3f&) const { return normalized(normal_); }
  bool may_contain_below(const Sphere& sphere, float margin) const {
    return !(distance(sphere.centre) - sphere.radius - slack_ >= margin);
  }

 private:
  Vec3f normal_;
  float offset_;
  float slack_;
};

}  // namespace voxshell
