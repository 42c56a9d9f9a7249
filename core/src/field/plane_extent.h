#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "field/brick_grid.h"

namespace voxshell {

inline constexpr std::uint32_t kNoPlane = 0xffffffffu;

/// How many bricks around each, in every direction, are of the same plane, as `planes` numbers them
/// or kNoPlane; the grid ends there.
/// The chessboard distance to the nearest of another, in two passes (Rosenfeld and Pfaltz 1966).
std::vector<int> measure_same_around(const BrickGrid& grid, std::span<const std::uint32_t> planes);

}  // namespace voxshell
