#pragma once

#include <cmath>
#include <span>

#include "base/finite.h"
#include "voxshell/vector.h"

namespace voxshell {

/// Finite, and no farther away than a mesh may be.
inline bool is_place(const Vec3f& p) {
  constexpr float kLargestCoordinate = 1.001e9f;  // meters: a mesh's, rounded
  return are_within(coordinates(std::span(&p, 1)), kLargestCoordinate);
}

/// Of unit length, or zero where a surface faces nowhere.
inline bool is_direction(const Vec3f& normal) {
  constexpr float kTolerance = 1e-3f;
  return std::abs(squared_length(normal) - 1.0f) <= kTolerance || normal == Vec3f{};
}

}  // namespace voxshell
