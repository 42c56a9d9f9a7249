#pragma once

#include <array>

namespace voxshell::bullet {

inline constexpr double kDiagonal = 0.70710678118654752;  ///< the cosine of 45 degrees

/// All around in a plane, by 45 degrees each, unit length.
inline constexpr std::array<std::array<double, 2>, 8> kEightDirections{{{1, 0},
                                                                        {kDiagonal, kDiagonal},
                                                                        {0, 1},
                                                                        {-kDiagonal, kDiagonal},
                                                                        {-1, 0},
                                                                        {-kDiagonal, -kDiagonal},
                                                                        {0, -1},
                                                                        {kDiagonal, -kDiagonal}}};

}  // namespace voxshell::bullet
