#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "shell/shell_samples.h"

namespace voxshell {

/// Finds points that share a place.
class PlaceTable {
 public:
  /// `points` stays where it is.
  explicit PlaceTable(const std::vector<ShellPoint>& points)
      : points_(points), slots_(std::bit_ceil(2 * points.size() + 1), kFree) {}

  /// The point at the place of `candidate`, which is `candidate` itself if it is the first.
  std::uint32_t take(std::uint32_t candidate) {
    const Vec3f& p = points_[candidate].point;
    std::size_t i = hash(p) & (slots_.size() - 1);
    while (slots_[i] != kFree && points_[slots_[i]].point != p) i = (i + 1) & (slots_.size() - 1);
    if (slots_[i] == kFree) slots_[i] = candidate;
    return slots_[i];
  }

 private:
  static constexpr auto kFree = static_cast<std::uint32_t>(-1);

  /// Spreads the bits of three floats (the steps of SplitMix64).
  static std::uint64_t hash(const Vec3f& p) {
    std::uint64_t h = 0;
    for (int axis = 0; axis < 3; ++axis) {
      h += std::bit_cast<std::uint32_t>(p[axis] + 0.0f);  // -0 becomes 0
      h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9u;
      h = (h ^ (h >> 27)) * 0x94D049BB133111EBu;
    }
    return h >> 32;
  }

  const std::vector<ShellPoint>& points_;
  std::vector<std::uint32_t> slots_;
};

}  // namespace voxshell
