#include "field/plane_surroundings.h"

#include <algorithm>
#include <array>
#include <cstdlib>

#include "base/parallel.h"
#include "field/brick_entry.h"
#include "field/plane_brick.h"

namespace voxshell {
namespace {

/// Farther than most spheres reach that are worth telling.
constexpr int kMostAround = 7;  // bricks
static_assert(kMostAround <= simd::kFieldMask);

class Surroundings {
 public:
  Surroundings(const GridFieldData& data, std::size_t plane)
      : data_(data), plane_index_(plane), plane_(data, plane), margin_(data.plane_margin()) {}

  /// How many bricks around one matter not, in every direction; at least `known` of them.
  int measure(const std::array<int, 3>& centre, int known) const {
    int around = known;
    while (around < kMostAround && is_clear(centre, around + 1)) ++around;
    return around;
  }

 private:
  /// Whether all bricks that are `away` from the centre along some axis, and no farther along any,
  /// hold the plane, or neither it nor the surface comes near.
  bool is_clear(const std::array<int, 3>& centre, int away) const {
    const auto [x, y, z] = centre;
    for (int k = -away; k <= away; ++k) {
      for (int j = -away; j <= away; ++j) {
        const bool is_face = std::abs(k) == away || std::abs(j) == away;
        for (int i = -away; i <= away; i += is_face ? 1 : 2 * away) {
          if (!is_clear_at({x + i, y + j, z + k})) return false;
        }
      }
    }
    return true;
  }

  bool is_clear_at(const std::array<int, 3>& place) const {
    // Beyond the grid no value is below that of the nearest place at its border.
    const Vec3 lower{1.0 * place[0], 1.0 * place[1], 1.0 * place[2]};
    const Vec3 upper = lower + Vec3{1, 1, 1};
    std::array<int, 3> nearest{};
    Vec3 nearest_lower;
    Vec3 nearest_upper;
    for (int axis = 0; axis < 3; ++axis) {
      const int bricks = data_.bricks[static_cast<std::size_t>(axis)];
      nearest[static_cast<std::size_t>(axis)] =
          std::clamp(place[static_cast<std::size_t>(axis)], 0, bricks - 1);
      nearest_lower[axis] = std::clamp(lower[axis], 0.0, 1.0 * bricks);
      nearest_upper[axis] = std::clamp(upper[axis], 0.0, 1.0 * bricks);
    }
    const auto brick = static_cast<std::size_t>(
        nearest[0] + data_.bricks[0] * (nearest[1] + data_.bricks[1] * nearest[2]));
    const BrickEntry entry = BrickEntry::unpack(data_.entries[brick]);
    const bool is_same = entry.is_plane && entry.first == plane_index_;
    if (is_same && place == nearest) return true;
    const double value = is_same ? plane_.lowest_in(nearest_lower, nearest_upper)
                                 : static_cast<double>(data_.bounds[brick]);
    return value >= margin_ && plane_.lowest_in(lower, upper) >= margin_;
  }

  const GridFieldData& data_;
  std::size_t plane_index_;
  PlaneOfBricks plane_;
  double margin_;
};

}  // namespace

void measure_plane_surroundings(GridFieldData& data, unsigned threads) {
  const auto [nx, ny, nz] = data.bricks;
  std::vector<int> around(data.entries.size(), 0);
  const auto measure_row = [&](std::size_t row) {
    std::array<int, 3> place{0, static_cast<int>(row) % ny, static_cast<int>(row) / ny};
    std::size_t brick = row * static_cast<std::size_t>(nx);
    BrickEntry last;
    for (; place[0] < nx; ++place[0], ++brick) {
      const BrickEntry entry = BrickEntry::unpack(data.entries[brick]);
      if (entry.is_plane) {
        const bool continues = last.is_plane && last.first == entry.first;
        const int known = continues ? std::max(around[brick - 1] - 1, 0) : 0;
        around[brick] = Surroundings(data, entry.first).measure(place, known);
      }
      last = entry;
    }
  };
  parallel_for(static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz), threads, {}, {},
               measure_row);
  for (std::size_t brick = 0; brick < around.size(); ++brick) {
    BrickEntry entry = BrickEntry::unpack(data.entries[brick]);
    if (!entry.is_plane) continue;
    entry.radius = around[brick];
    data.entries[brick] = entry.pack();
  }
}

}  // namespace voxshell
