#include "field/brick_bounds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>

#include "base/parallel.h"
#include "field/bfloat16.h"
#include "field/brick_entry.h"

namespace voxshell {
namespace {

using simd::kBrickCells;

/// Neighbours may disagree by this much on the face between them and still count as continuous.
constexpr double kLargestMismatch = 1.0 / 64.0;  // voxels
/// Outweighs the rounding of float32 in what follows.
constexpr float kRoundingFactor = 1.00001f;

/// What one brick's values do within it, metres.
struct BrickRange {
  float lowest;
  float slope;
};

/// All values of a brick at its nodes.
class BrickValues {
 public:
  BrickValues(const GridFieldData& data, std::size_t brick)
      : entry_(BrickEntry::unpack(data.entries[brick])) {
    if (entry_.is_plane) {
      const auto nx = static_cast<std::size_t>(data.bricks[0]);
      const auto ny = static_cast<std::size_t>(data.bricks[1]);
      const float* plane = &data.planes[4 * entry_.first];
      normal_ = static_cast<Vec3>(Vec3f{plane[0], plane[1], plane[2]});
      const double edge = kBrickCells * data.voxel_size;
      const std::array<std::size_t, 3> place{brick % nx, brick / nx % ny, brick / (nx * ny)};
      const Vec3 corner =
          data.origin + edge * Vec3{static_cast<double>(place[0]), static_cast<double>(place[1]),
                                    static_cast<double>(place[2])};
      at_corner_ = dot(normal_, corner) - static_cast<double>(plane[3]);
      unit_ = edge;
    } else {
      samples_ = &data.samples[entry_.first];
      unit_ = data.voxel_size / simd::kQuantaPerVoxel * std::ldexp(1.0, entry_.exponent);
    }
  }

  bool is_plane() const { return entry_.is_plane; }
  int cells() const { return entry_.cells; }
  double quantum() const { return unit_; }
  const std::int16_t* samples() const { return samples_; }

  /// At a place in units of 1/`parts` of the brick, which divide its cells or are a plane's.
  double at(const std::array<int, 3>& place, int parts) const {
    if (entry_.is_plane) {
      const Vec3 cells{1.0 * place[0], 1.0 * place[1], 1.0 * place[2]};
      return at_corner_ + unit_ / parts * dot(normal_, cells);
    }
    const int n = entry_.cells;
    const int step = parts / n;
    double weights[3][2];
    std::array<int, 3> cell{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      cell[axis] = std::min(place[axis] / step, n - 1);
      weights[axis][1] = static_cast<double>(place[axis] - cell[axis] * step) / step;
      weights[axis][0] = 1.0 - weights[axis][1];
    }
    double sum = 0.0;
    for (int k = 0; k < 2; ++k) {
      for (int j = 0; j < 2; ++j) {
        for (int i = 0; i < 2; ++i) {
          const double weight = weights[0][i] * weights[1][j] * weights[2][k];
          if (weight == 0.0) continue;
          const int index = cell[0] + i + (n + 1) * (cell[1] + j + (n + 1) * (cell[2] + k));
          sum += weight * samples_[index];
        }
      }
    }
    return sum * unit_;
  }

  BrickRange range(double voxel_size) const {
    if (entry_.is_plane) {
      double lowest = at({0, 0, 0}, 1);
      for (int corner = 1; corner < 8; ++corner) {
        lowest = std::min(lowest, at({corner & 1, corner >> 1 & 1, corner >> 2}, 1));
      }
      return {static_cast<float>(lowest), static_cast<float>(length(normal_))};
    }
    const int n = entry_.cells;
    const int row = n + 1;
    const int layer = row * row;
    // Along an axis the derivative of a trilinear cell is a mean of its four edges' slopes.
    std::int64_t steepest = 0;
    for (int k = 0; k < n; ++k) {
      for (int j = 0; j < n; ++j) {
        const std::int16_t* c = samples_ + row * j + layer * k;
        for (int i = 0; i < n; ++i, ++c) {
          const auto steep = [&](int along, int side, int up) {
            const int s =
                std::max(std::max(std::abs(c[along] - c[0]), std::abs(c[along + side] - c[side])),
                         std::max(std::abs(c[along + up] - c[up]),
                                  std::abs(c[along + side + up] - c[side + up])));
            return std::int64_t{s} * s;
          };
          steepest = std::max(steepest,
                              steep(1, row, layer) + steep(row, 1, layer) + steep(layer, 1, row));
        }
      }
    }
    const std::int16_t lowest = *std::min_element(samples_, samples_ + layer * row);
    const double cell = voxel_size * kBrickCells / n;
    return {static_cast<float>(lowest * unit_),
            static_cast<float>(std::sqrt(static_cast<double>(steepest)) * unit_ / cell)};
  }

 private:
  BrickEntry entry_;
  const std::int16_t* samples_ = nullptr;
  Vec3 normal_{};
  double at_corner_ = 0.0;
  double unit_ = 0.0;  ///< metres of a sample's unit; of a plane the brick's edge
};

/// How far the values of two neighbours along `axis` are apart at most, on the face between them.
double find_mismatch(const BrickValues& below, const BrickValues& above, std::size_t axis) {
  const int n = std::max(below.cells(), above.cells());
  const std::size_t side = (axis + 1) % 3;
  const std::size_t up = (axis + 2) % 3;
  const auto index_of = [&](const std::array<int, 3>& place) {
    return place[0] + (n + 1) * (place[1] + (n + 1) * place[2]);
  };
  const bool share_nodes = !below.is_plane() && !above.is_plane() &&
                           below.cells() == above.cells() && below.quantum() == above.quantum();
  double largest = 0.0;
  int largest_in_quanta = 0;
  for (int u = 0; u <= n; ++u) {
    for (int v = 0; v <= n; ++v) {
      std::array<int, 3> place{};
      place[side] = u;
      place[up] = v;
      std::array<int, 3> end = place;
      end[axis] = n;
      if (share_nodes) {
        largest_in_quanta = std::max(largest_in_quanta, std::abs(below.samples()[index_of(end)] -
                                                                 above.samples()[index_of(place)]));
      } else {
        largest = std::max(largest, std::abs(below.at(end, n) - above.at(place, n)));
      }
    }
  }
  return share_nodes ? largest_in_quanta * below.quantum() : largest;
}

}  // namespace

bool compute_brick_bounds(GridFieldData& data, unsigned threads, const Progress& progress) {
  const auto nx = static_cast<std::size_t>(data.bricks[0]);
  const auto ny = static_cast<std::size_t>(data.bricks[1]);
  const auto nz = static_cast<std::size_t>(data.bricks[2]);
  const std::size_t count = nx * ny * nz;
  const std::array<std::size_t, 3> sizes{nx, ny, nz};
  const std::array<std::size_t, 3> strides{1, nx, nx * ny};
  const auto allowed = static_cast<float>(kLargestMismatch * data.voxel_size);

  std::vector<BrickRange> ranges(count);
  /// Of each brick with the next along an axis.
  std::vector<std::array<float, 3>> mismatches(count);
  const auto measure_row = [&](std::size_t row) {
    for (std::size_t brick = row * nx; brick < (row + 1) * nx; ++brick) {
      const BrickValues values(data, brick);
      ranges[brick] = values.range(data.voxel_size);
      const std::array<std::size_t, 3> place{brick % nx, brick / nx % ny, brick / (nx * ny)};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (place[axis] + 1 == sizes[axis]) continue;
        mismatches[brick][axis] = static_cast<float>(
            find_mismatch(values, BrickValues(data, brick + strides[axis]), axis));
      }
    }
  };
  if (!parallel_for(ny * nz, threads, "distance field", progress, measure_row)) return false;

  data.bounds.resize(count);
  std::vector<float> largest_of_row(ny * nz);
  const auto bound_row = [&](std::size_t row) {
    const std::size_t j = row % ny;
    const std::size_t k = row / ny;
    for (std::size_t i = 0; i < nx; ++i) {
      float slope = 0.0f;
      float mismatch = 0.0f;
      const std::size_t last_x = std::min(i + 1, nx - 1);
      const std::size_t last_y = std::min(j + 1, ny - 1);
      const std::size_t last_z = std::min(k + 1, nz - 1);
      for (std::size_t z = k - (k > 0 ? 1 : 0); z <= last_z; ++z) {
        for (std::size_t y = j - (j > 0 ? 1 : 0); y <= last_y; ++y) {
          for (std::size_t x = i - (i > 0 ? 1 : 0); x <= last_x; ++x) {
            const std::size_t near = x + nx * (y + ny * z);
            slope = std::max(slope, ranges[near].slope);
            if (x < last_x) mismatch = std::max(mismatch, mismatches[near][0]);
            if (y < last_y) mismatch = std::max(mismatch, mismatches[near][1]);
            if (z < last_z) mismatch = std::max(mismatch, mismatches[near][2]);
          }
        }
      }
      const std::size_t brick = i + nx * row;
      const BrickEntry entry = BrickEntry::unpack(data.entries[brick]);
      const double cell = entry.is_plane ? 1.0 : static_cast<double>(kBrickCells) / entry.cells;
      const double lowest = static_cast<double>(ranges[brick].lowest) - data.error * cell;
      const auto rounding = static_cast<float>(1e-6 * std::abs(lowest));
      const bool has_slope = mismatch <= allowed;
      if (has_slope) largest_of_row[row] = std::max(largest_of_row[row], mismatch);
      data.bounds[brick] = round_down_to_bfloat16(static_cast<float>(lowest) - rounding) |
                           (has_slope ? round_up_to_bfloat16(slope * kRoundingFactor)
                                      : round_up_to_bfloat16(simd::kNoLipschitzConstant)) >>
                               16;
    }
  };
  if (!parallel_for(ny * nz, threads, "distance field", {}, bound_row)) return false;
  const float largest = *std::max_element(largest_of_row.begin(), largest_of_row.end());
  // A way that leaves a brick by at most its width crosses three faces at most.
  data.jump = 3.0 * static_cast<double>(largest * kRoundingFactor);
  return true;
}

}  // namespace voxshell
