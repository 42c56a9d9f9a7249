#pragma once

#include <LinearMath/btTransform.h>

#include "voxshell/pose.h"

namespace voxshell::bullet {

inline btVector3 to_bullet(const Vec3& v) {
  return {static_cast<btScalar>(v.x), static_cast<btScalar>(v.y), static_cast<btScalar>(v.z)};
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
