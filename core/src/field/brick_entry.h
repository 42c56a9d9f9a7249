#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "simd/grid_view.h"

namespace voxshell {

/// The contents of a brick's entry, see simd/grid_view.h.
struct BrickEntry {
  bool is_plane = false;
  int cells = 1;          ///< of its samples, along each axis; 1 where it is a plane
  int exponent = 0;       ///< of its samples' scale
  int radius = 0;         ///< bricks around it, in each direction, that hold the same plane
  std::size_t first = 0;  ///< index of its first sample, or of its plane

  std::uint32_t pack() const {
    if (is_plane) {
      return static_cast<std::uint32_t>(first << simd::kPayloadShift) |
             static_cast<std::uint32_t>(radius << simd::kFieldShift) | simd::kPlaneBit;
    }
    const int level = cells == 8 ? 3 : cells / 2;
    return static_cast<std::uint32_t>(first / unit_of(cells) << simd::kPayloadShift) |
           static_cast<std::uint32_t>(exponent << simd::kFieldShift) |
           static_cast<std::uint32_t>(level);
  }

  static BrickEntry unpack(std::uint32_t bits) {
    BrickEntry entry;
    entry.is_plane = (bits & simd::kPlaneBit) != 0;
    const auto field = static_cast<int>(bits >> simd::kFieldShift) & simd::kFieldMask;
    const std::size_t payload = bits >> simd::kPayloadShift;
    if (entry.is_plane) {
      entry.radius = field;
      entry.first = payload;
    } else {
      entry.cells = 1 << (bits & 3);
      entry.exponent = field;
      entry.first = payload * unit_of(entry.cells);
    }
    return entry;
  }

  /// How far its samples are apart along y and z, of a grid of these bricks.
  std::array<std::size_t, 2> strides(const std::array<int, 3>& bricks) const {
    const auto along = [&](std::size_t axis) {
      return static_cast<std::size_t>(cells == 1 ? bricks[axis] : cells) + 1;
    };
    return {along(0), along(0) * along(1)};
  }

 private:
  static std::size_t unit_of(int cells) { return cells == 1 ? 1 : simd::kSampleAlignment; }
};

/// The most samples and planes that entries can number.
inline constexpr std::size_t kMostPayloads = std::size_t{1} << (32 - simd::kPayloadShift);

constexpr std::size_t cube(std::size_t n) { return n * n * n; }

}  // namespace voxshell
