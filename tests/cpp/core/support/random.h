#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

#include "voxshell/pose.h"
#include "voxshell/vector.h"

namespace voxshell::test_support {

/// SplitMix64: the same numbers with every standard library, so that a failure can be repeated.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {
    state_ += 0x9E3779B97F4A7C15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }

  /// In [0, 1).
  double unit() { return static_cast<double>(next() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * unit(); }
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(next() % count); }

  Vec3 in_box(const Vec3& low, const Vec3& high) {
    return {uniform(low.x, high.x), uniform(low.y, high.y), uniform(low.z, high.z)};
  }
  Vec3 in_cube(double half_side) {
    return in_box({-half_side, -half_side, -half_side}, {half_side, half_side, half_side});
  }
  Vec3 direction() {
    while (true) {
      const Vec3 v = in_cube(1.0);
      const double squared = squared_length(v);
      if (squared > 1e-4 && squared <= 1.0) return normalized(v);
    }
  }

  /// Uniform over all rotations (Shoemake 1992).
  Matrix3 rotation() {
    constexpr double kTau = 6.283185307179586;
    const double u = unit();
    const double first = kTau * unit();
    const double second = kTau * unit();
    const double x = std::sqrt(1.0 - u) * std::sin(first);
    const double y = std::sqrt(1.0 - u) * std::cos(first);
    const double z = std::sqrt(u) * std::sin(second);
    const double w = std::sqrt(u) * std::cos(second);
    return {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
            {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
            {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
  }

  Pose pose(double reach) { return {rotation(), in_cube(reach)}; }

 private:
  std::uint64_t state_;
};

}  // namespace voxshell::test_support
