#pragma once

#include <LinearMath/btTransform.h>

#include "voxshell/pose.h"

namespace voxshell::bullet {

inline btVector3 to_bullet(const Vec3& v) {
  return {static_cast<btScalar>(v.x), static_cast<btScalar>(v.y), static_cast<btScalar>(v.z)};
}

inline btTransform to_bullet(const Pose& pose) {
  const btVector3 x = to_bullet(pose.rotation.row_x);
  const btVector3 y = to_bullet(pose.rotation.row_y);
  const btVector3 z = to_bullet(pose.rotation.row_z);
  return btTransform(btMatrix3x3(x.x(), x.y(), x.z(), y.x(), y.y(), y.z(), z.x(), z.y(), z.z()),
                     to_bullet(pose.translation));
}

inline Vec3 from_bullet(const btVector3& v) {
  return {static_cast<double>(v.x()), static_cast<double>(v.y()), static_cast<double>(v.z())};
}

inline Pose from_bullet(const btTransform& t) {
  const btMatrix3x3& basis = t.getBasis();
  return {{from_bullet(basis[0]), from_bullet(basis[1]), from_bullet(basis[2])},
          from_bullet(t.getOrigin())};
}

}  // namespace voxshell::bullet
