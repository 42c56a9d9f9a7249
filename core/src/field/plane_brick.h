#pragma once

#include <cstddef>

#include "voxshell/grid_field.h"

namespace voxshell {

/// A plane that bricks of a grid hold.
class PlaneOfBricks {
 public:
  PlaneOfBricks(const GridFieldData& data, std::size_t index)
      : normal_(static_cast<Vec3>(
            Vec3f{data.planes[4 * index], data.planes[4 * index + 1], data.planes[4 * index + 2]})),
        edge_(simd::kBrickCells * data.voxel_size),
        at_origin_(dot(normal_, data.origin) - static_cast<double>(data.planes[4 * index + 3])) {}

  /// Its smallest distance in a box whose corners are told in bricks from the grid's, metres.
  double lowest_in(const Vec3& lower, const Vec3& upper) const {
    Vec3 lowest;
    for (int axis = 0; axis < 3; ++axis) {
      lowest[axis] = normal_[axis] > 0.0 ? lower[axis] : upper[axis];
    }
    return at_origin_ + edge_ * dot(normal_, lowest);
  }

 private:
  Vec3 normal_;
  double edge_;
  double at_origin_;
};

}  // namespace voxshell
