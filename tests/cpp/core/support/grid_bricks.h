#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "field/brick_entry.h"
#include "voxshell/grid_field.h"

namespace voxshell::test_support {

/// The brick at a place given in cells from the grid's origin.
inline std::size_t brick_at(const GridField& field, const std::array<int, 3>& cell) {
  const auto& bricks = field.data().bricks;
  std::array<std::size_t, 3> place{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    place[axis] =
        static_cast<std::size_t>(std::clamp(cell[axis] / simd::kBrickCells, 0, bricks[axis] - 1));
  }
  const auto nx = static_cast<std::size_t>(bricks[0]);
  const auto ny = static_cast<std::size_t>(bricks[1]);
  return place[0] + nx * (place[1] + ny * place[2]);
}

inline std::size_t brick_at(const GridField& field, const Vec3& p) {
  std::array<int, 3> cell{};
  for (int axis = 0; axis < 3; ++axis) {
    cell[static_cast<std::size_t>(axis)] =
        static_cast<int>((p[axis] - field.origin()[axis]) / field.voxel_size());
  }
  return brick_at(field, cell);
}

inline BrickEntry entry_of(const GridField& field, std::size_t brick) {
  return BrickEntry::unpack(field.data().entries[brick]);
}

/// Voxels along the cells of a brick; 1 where it holds a plane.
inline double cell_size_of(const GridField& field, std::size_t brick) {
  const BrickEntry entry = entry_of(field, brick);
  return entry.is_plane ? 1.0 : static_cast<double>(simd::kBrickCells) / entry.cells;
}

/// Calls `visit(position, value)` on every node that a brick holds, in float64 and from the stored
/// numbers alone.
template <class Visit>
void visit_nodes(const GridField& field, std::size_t brick, const Visit& visit) {
  const GridFieldData& data = field.data();
  const BrickEntry entry = entry_of(field, brick);
  const auto nx = static_cast<std::size_t>(data.bricks[0]);
  const auto ny = static_cast<std::size_t>(data.bricks[1]);
  const double edge = simd::kBrickCells * data.voxel_size;
  const Vec3 corner = data.origin + edge * Vec3{static_cast<double>(brick % nx),
                                                static_cast<double>(brick / nx % ny),
                                                static_cast<double>(brick / (nx * ny))};
  const int n = entry.is_plane ? simd::kBrickCells : entry.cells;
  const double quantum = data.voxel_size / data.quanta_per_voxel * std::ldexp(1.0, entry.exponent);
  const auto [row, layer] = entry.strides(data.bricks);
  for (int k = 0; k <= n; ++k) {
    for (int j = 0; j <= n; ++j) {
      for (int i = 0; i <= n; ++i) {
        const Vec3 p = corner + (edge / n) * Vec3{1.0 * i, 1.0 * j, 1.0 * k};
        if (entry.is_plane) {
          const float* plane = &data.planes[4 * entry.first];
          const Vec3 normal = static_cast<Vec3>(Vec3f{plane[0], plane[1], plane[2]});
          visit(p, dot(normal, p) - static_cast<double>(plane[3]));
        } else {
          const std::size_t index = static_cast<std::size_t>(i) +
                                    static_cast<std::size_t>(j) * row +
                                    static_cast<std::size_t>(k) * layer;
          visit(p, quantum * data.samples[entry.first + index]);
        }
      }
    }
  }
}

}  // namespace voxshell::test_support
