#include "voxshell/rigid_motion.h"

#include <array>
#include <cmath>
#include <cstddef>

#include "base/portable_math.h"

namespace voxshell {
namespace {

/// Of a rotation, its unit quaternion: from the largest of its four components, by which the others
/// are divided (Shepperd 1978).
struct Quaternion {
  double w;
  Vec3 v;
};

Quaternion to_quaternion(const Matrix3& m) {
  const Vec3& x = m.row_x;
  const Vec3& y = m.row_y;
  const Vec3& z = m.row_z;
  const std::array<double, 4> squares{1.0 + x.x + y.y + z.z, 1.0 + x.x - y.y - z.z,
                                      1.0 - x.x + y.y - z.z, 1.0 - x.x - y.y + z.z};
  std::size_t largest = 0;
  for (std::size_t i = 1; i < squares.size(); ++i) {
    if (squares[i] > squares[largest]) largest = i;
  }
  const double s = squares[largest];
  const double wx = z.y - y.z;
  const double wy = x.z - z.x;
  const double wz = y.x - x.y;
  const double xy = y.x + x.y;
  const double xz = z.x + x.z;
  const double yz = z.y + y.z;
  const std::array<Quaternion, 4> candidates{
      {{s, {wx, wy, wz}}, {wx, {s, xy, xz}}, {wy, {xy, s, yz}}, {wz, {xz, yz, s}}}};
  const Quaternion& q = candidates[largest];
  const double length = std::sqrt(q.w * q.w + squared_length(q.v));
  return {q.w / length, q.v / length};
}

/// Rodrigues' formula.
Matrix3 make_rotation(const Vec3& axis, double angle) {
  const double c = portable_cos(angle);
  const double s = portable_sin(angle);
  const auto turned = [&](const Vec3& v) {
    return c * v + s * cross(axis, v) + (1.0 - c) * dot(axis, v) * axis;
  };
  return Matrix3{turned({1, 0, 0}), turned({0, 1, 0}), turned({0, 0, 1})}.transposed();
}

bool is_first_positive(const Vec3& v) {
  if (v.x != 0.0) return v.x > 0.0;
  if (v.y != 0.0) return v.y > 0.0;
  return v.z > 0.0;
}

}  // namespace

RigidMotion RigidMotion::between(const Pose& start, const Pose& end) {
  const Quaternion q = to_quaternion(end.rotation * start.rotation.transposed());
  const double sine = length(q.v);
  // A smaller number is zero but for rounding, and its sign says nothing.
  constexpr double kZero = 1e-15;
  const bool is_half = std::abs(q.w) < kZero;
  const bool is_reversed = is_half ? !is_first_positive(q.v) : q.w < 0.0;
  Vec3 turn;
  if (sine > 0.0) turn = (2.0 * portable_atan2(sine, std::abs(q.w)) / sine) * q.v;
  return {start, end.translation - start.translation, is_reversed ? -turn : turn};
}

Pose RigidMotion::at(double fraction) const {
  const Vec3 origin = start.translation + fraction * displacement;
  const double angle = length(turn);
  if (!(angle > 0.0)) return {start.rotation, origin};
  return {make_rotation(turn / angle, fraction * angle) * start.rotation, origin};
}

}  // namespace voxshell
