#include "field/plane_surroundings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "field/brick_entry.h"
#include "voxshell/parallel.h"

namespace voxshell {
namespace {

/// Farther than most spheres reach that are worth telling.
constexpr int kMostAround = 7;  // bricks
static_assert(kMostAround <= simd::kFieldMask);

using Place = std::array<int, 3>;

/// A plane that bricks of a grid hold.
class PlaneOfBricks {
 public:
  PlaneOfBricks(const GridFieldData& data, std::size_t index)
      : normal_(static_cast<Vec3>(
            Vec3f{data.planes[4 * index], data.planes[4 * index + 1], data.planes[4 * index + 2]})),
        edge_(simd::kBrickCells * data.voxel_size),
        at_origin_(dot(normal_, data.origin) - static_cast<double>(data.planes[4 * index + 3])) {}

  /// Its smallest distance in a box whose corners are told in bricks from the grid's, meters.
  double lowest_in(const Vec3& lower, const Vec3& upper) const {
    Vec3 lowest;
    for (int axis = 0; axis < 3; ++axis) {
      lowest[axis] = normal_[axis] > 0.0 ? lower[axis] : upper[axis];
    }
    return at_origin_ + edge_ * dot(normal_, lowest);
  }

 private:
  Vec3 normal_;
  double edge_;
  double at_origin_;
};

Vec3 corner_of(const Place& place) { return {1.0 * place[0], 1.0 * place[1], 1.0 * place[2]}; }

double find_lowest_value(const GridFieldData& data, const BrickEntry& entry, const Place& place) {
  if (entry.is_plane) {
    const Vec3 corner = corner_of(place);
    return PlaneOfBricks(data, entry.first).lowest_in(corner, corner + Vec3{1, 1, 1});
  }
  const auto nodes = static_cast<std::size_t>(entry.cells) + 1;
  const auto [row, layer] = entry.strides(data.bricks);
  int lowest = INT16_MAX;
  for (std::size_t k = 0; k < nodes; ++k) {
    for (std::size_t j = 0; j < nodes; ++j) {
      const std::int16_t* along_x = &data.samples[entry.first + layer * k + row * j];
      lowest = std::min<int>(lowest, *std::min_element(along_x, along_x + nodes));
    }
  }
  return lowest * data.voxel_size / data.quanta_per_voxel * std::ldexp(1.0, entry.exponent);
}

class Surroundings {
 public:
  Surroundings(const GridFieldData& data, const std::vector<double>& lowest_values,
               std::size_t plane)
      : data_(data), lowest_values_(lowest_values), plane_index_(plane), plane_(data, plane) {}

  /// How many bricks around one matter not, in every direction; `known` of them do not.
  int measure(const Place& center, int known) const {
    int around = known;
    while (around < kMostAround && is_clear(center, around + 1)) ++around;
    return around;
  }

 private:
  /// Whether all bricks that are `away` from the center along some axis, and no farther along any,
  /// hold the plane, or neither it nor the field is below the margin there.
  bool is_clear(const Place& center, int away) const {
    const auto [x, y, z] = center;
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

  bool is_clear_at(const Place& place) const {
    // Beyond the grid no value is below that of the nearest place at its border.
    const Vec3 lower = corner_of(place);
    const Vec3 upper = lower + Vec3{1, 1, 1};
    Place nearest{};
    Vec3 nearest_lower;
    Vec3 nearest_upper;
    for (int axis = 0; axis < 3; ++axis) {
      const auto k = static_cast<std::size_t>(axis);
      nearest[k] = std::clamp(place[k], 0, data_.bricks[k] - 1);
      nearest_lower[axis] = std::clamp(lower[axis], 0.0, 1.0 * data_.bricks[k]);
      nearest_upper[axis] = std::clamp(upper[axis], 0.0, 1.0 * data_.bricks[k]);
    }
    const int index = nearest[0] + data_.bricks[0] * (nearest[1] + data_.bricks[1] * nearest[2]);
    const auto brick = static_cast<std::size_t>(index);
    const BrickEntry entry = BrickEntry::unpack(data_.entries[brick]);
    const bool is_same = entry.is_plane && entry.first == plane_index_;
    if (is_same && place == nearest) return true;
    const double value =
        is_same ? plane_.lowest_in(nearest_lower, nearest_upper) : lowest_values_[brick];
    const double margin = data_.plane_margin();
    return value >= margin && plane_.lowest_in(lower, upper) >= margin;
  }

  const GridFieldData& data_;
  const std::vector<double>& lowest_values_;
  std::size_t plane_index_;
  PlaneOfBricks plane_;
};

}  // namespace

void measure_plane_surroundings(GridFieldData& data, unsigned threads) {
  if (data.planes.empty()) return;
  const int nx = data.bricks[0];
  const int ny = data.bricks[1];
  const int nz = data.bricks[2];
  const auto for_each_row = [&](const auto& visit) {
    const auto visit_row = [&](std::size_t row) {
      Place place{0, static_cast<int>(row) % ny, static_cast<int>(row) / ny};
      std::size_t brick = row * static_cast<std::size_t>(nx);
      for (; place[0] < nx; ++place[0], ++brick) {
        visit(brick, place, BrickEntry::unpack(data.entries[brick]));
      }
    };
    parallel_for(static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz), threads, {}, {},
                 visit_row);
  };
  std::vector<double> lowest_values(data.entries.size());
  for_each_row([&](std::size_t brick, const Place& place, const BrickEntry& entry) {
    lowest_values[brick] = find_lowest_value(data, entry, place);
  });
  std::vector<int> around(data.entries.size(), 0);
  for_each_row([&](std::size_t brick, const Place& place, const BrickEntry& entry) {
    if (!entry.is_plane) return;
    int known = 0;
    if (place[0] > 0) {
      const BrickEntry last = BrickEntry::unpack(data.entries[brick - 1]);
      if (last.is_plane && last.first == entry.first) known = std::max(around[brick - 1] - 1, 0);
    }
    around[brick] = Surroundings(data, lowest_values, entry.first).measure(place, known);
  });
  for_each_row([&](std::size_t brick, const Place&, BrickEntry entry) {
    if (!entry.is_plane) return;
    entry.radius = around[brick];
    data.entries[brick] = entry.pack();
  });
}

}  // namespace voxshell
