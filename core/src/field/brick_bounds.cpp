#include "field/brick_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "field/brick_entry.h"
#include "field/plane_brick.h"

namespace voxshell {
namespace {

using simd::kBrickCells;

double find_lowest_value(const GridFieldData& data, const BrickEntry& entry,
                         const std::array<int, 3>& place) {
  if (entry.is_plane) {
    const Vec3 lower{1.0 * place[0], 1.0 * place[1], 1.0 * place[2]};
    return PlaneOfBricks(data, entry.first).lowest_in(lower, lower + Vec3{1, 1, 1});
  }
  const auto begin = data.samples.begin() + static_cast<std::ptrdiff_t>(entry.first);
  const auto nodes = static_cast<std::ptrdiff_t>(cube(static_cast<std::size_t>(entry.cells) + 1));
  const double unit = data.voxel_size / simd::kQuantaPerVoxel * std::ldexp(1.0, entry.exponent);
  return *std::min_element(begin, begin + nodes) * unit;
}

}  // namespace

bool compute_brick_bounds(GridFieldData& data, unsigned threads, const Progress& progress) {
  const auto [nx, ny, nz] = data.bricks;
  data.bounds.resize(data.entries.size());
  const auto bound_row = [&](std::size_t row) {
    std::array<int, 3> place{0, static_cast<int>(row) % ny, static_cast<int>(row) / ny};
    for (; place[0] < nx; ++place[0]) {
      const std::size_t brick =
          row * static_cast<std::size_t>(nx) + static_cast<std::size_t>(place[0]);
      const BrickEntry entry = BrickEntry::unpack(data.entries[brick]);
      // The nodes whose mean a value is are spread about its point, see simd::GridView.
      const double cell = entry.is_plane ? 1.0 : static_cast<double>(kBrickCells) / entry.cells;
      const double size = cell * data.voxel_size;
      const double error = std::sqrt(0.75 * size * size + data.gap()) + data.node_error * cell;
      const double lowest = find_lowest_value(data, entry, place) - error;
      data.bounds[brick] = static_cast<float>(lowest - 1e-6 * std::abs(lowest));
    }
  };
  return parallel_for(static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz), threads,
                      "distance field", progress, bound_row);
}

}  // namespace voxshell
