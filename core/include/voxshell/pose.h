#pragma once

#include <array>

#include "voxshell/result.h"
#include "voxshell/vector.h"

namespace voxshell {

/// A 3x3 matrix by rows.
struct Matrix3 {
  Vec3 row_x{1.0, 0.0, 0.0};
  Vec3 row_y{0.0, 1.0, 0.0};
  Vec3 row_z{0.0, 0.0, 1.0};

  Vec3 operator*(const Vec3& v) const { return {dot(row_x, v), dot(row_y, v), dot(row_z, v)}; }
  Matrix3 operator*(const Matrix3& m) const {
    const Matrix3 t = m.transposed();
    return {t * row_x, t * row_y, t * row_z};
  }
  Matrix3 transposed() const {
    return {{row_x.x, row_y.x, row_z.x}, {row_x.y, row_y.y, row_z.y}, {row_x.z, row_y.z, row_z.z}};
  }
};

/// A rigid transform. `a_from_b` maps coordinates in frame b to frame a, so `world_from_a.inverse()
/// * world_from_b` is `a_from_b`.
struct Pose {
  Matrix3 rotation;
  Vec3 translation;

  /// From a row-major 4x4 matrix. Error kInvalidPose unless all numbers are finite, the last row is
  /// (0, 0, 0, 1), the rotation is orthonormal with determinant 1, each to 1e-6, and the
  /// translation is within 1e15 m.
  static Result<Pose> from_matrix(const std::array<double, 16>& matrix);

  Vec3 transform_point(const Vec3& p) const { return rotation * p + translation; }
  Vec3 rotate(const Vec3& v) const { return rotation * v; }
  Pose inverse() const {
    const Matrix3 inverse_rotation = rotation.transposed();
    return {inverse_rotation, -(inverse_rotation * translation)};
  }
  Pose operator*(const Pose& other) const {
    return {rotation * other.rotation, transform_point(other.translation)};
  }
};

}  // namespace voxshell
