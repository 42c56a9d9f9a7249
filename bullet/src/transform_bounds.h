#pragma once

#include <cmath>

#include "voxshell/bounds.h"
#include "voxshell/pose.h"

namespace voxshell::bullet {

/// The bounds of `box` after a rigid transform.
inline Bounds transform_bounds(const Pose& pose, const Bounds& box) {
  const Vec3 center = pose.transform_point(box.center());
  const Vec3 half = 0.5 * box.extents();
  const auto reach = [&](const Vec3& row) {
    return std::abs(row.x) * half.x + std::abs(row.y) * half.y + std::abs(row.z) * half.z;
  };
  const Vec3 r{reach(pose.rotation.row_x), reach(pose.rotation.row_y), reach(pose.rotation.row_z)};
  return {center - r, center + r};
}

}  // namespace voxshell::bullet
