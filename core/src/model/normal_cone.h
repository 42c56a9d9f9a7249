#pragma once

#include <array>
#include <cstddef>

#include "voxshell/vector.h"

namespace voxshell {

/// Between unit vectors that point in opposite directions.
inline constexpr double kLongestChord = 2.0;

/// The angle, radians, between unit vectors whose ends are `chord` apart. Of sums, products and
/// square roots alone, so that it has the same bits on every machine.
double angle_of_chord(double chord);

/// The directions between some normals: sums of them with weights that are not negative.
class NormalCone {
 public:
  /// A unit vector. Normals that are almost the same count once; beyond a number, they are left
  /// out.
  void add(const Vec3& normal);

  /// The chord from a unit vector to the nearest unit vector of the cone, which is 0 within it.
  /// kLongestChord where there are no normals.
  double chord_to(const Vec3& direction) const;

 private:
  static constexpr std::size_t kMost = 24;

  std::array<Vec3, kMost> normals_{};
  std::size_t count_ = 0;
};

}  // namespace voxshell
