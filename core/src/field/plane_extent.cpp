#include "field/plane_extent.h"

#include <algorithm>
#include <cstddef>

#include "simd/grid_view.h"

namespace voxshell {

std::vector<int> measure_same_around(const BrickGrid& grid, std::span<const std::uint32_t> planes) {
  const auto [nx, ny, nz] = grid.bricks;
  std::vector<int> radii(planes.size(), simd::kFieldMask);
  const auto visit = [&](std::size_t brick, bool is_first_pass) {
    const auto [x, y, z] = grid.place(brick);
    if (planes[brick] == kNoPlane || x == 0 || y == 0 || z == 0 || x + 1 == nx || y + 1 == ny ||
        z + 1 == nz) {
      radii[brick] = 0;
      return;
    }
    int least = radii[brick];
    for (std::size_t c = z - 1; c <= z + 1; ++c) {
      for (std::size_t b = y - 1; b <= y + 1; ++b) {
        for (std::size_t a = x - 1; a <= x + 1; ++a) {
          const std::size_t other = a + nx * (b + ny * c);
          if (planes[other] != planes[brick]) {
            least = 0;
          } else if (is_first_pass ? other < brick : other > brick) {
            least = std::min(least, radii[other] + 1);
          }
        }
      }
    }
    radii[brick] = least;
  };
  for (std::size_t brick = 0; brick < planes.size(); ++brick) visit(brick, true);
  for (std::size_t brick = planes.size(); brick-- > 0;) visit(brick, false);
  return radii;
}

}  // namespace voxshell
