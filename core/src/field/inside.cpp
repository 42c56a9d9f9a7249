#include "field/inside.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "simd/grid_view.h"

namespace voxshell {
namespace {

using simd::kBrickCells;

constexpr std::size_t kNodes = kBrickCells + 1;

}  // namespace

void InsideByRows::find_corners(std::size_t brick_y, std::size_t brick_z,
                                std::span<int> layers) const {
  std::vector<double> row_x(layers.size());
  for (std::size_t i = 0; i < row_x.size(); ++i) row_x[i] = grid_.node(kBrickCells * i, 0, 0).x;
  const std::size_t rows_y = kBrickCells * grid_.bricks[1] + 1;
  compute(kBrickCells * (brick_y + rows_y * brick_z), row_x, layers);
}

void InsideByRows::find_nodes(const std::array<std::size_t, 3>& brick,
                              std::span<const float> /*distances*/, std::span<int> layers) const {
  std::array<double, kNodes> row_x{};
  for (std::size_t i = 0; i < kNodes; ++i)
    row_x[i] = grid_.node(kBrickCells * brick[0] + i, 0, 0).x;
  const std::size_t rows_y = kBrickCells * grid_.bricks[1] + 1;
  for (std::size_t row = 0; row < kNodes * kNodes; ++row) {
    const std::size_t y = kBrickCells * brick[1] + row % kNodes;
    const std::size_t z = kBrickCells * brick[2] + row / kNodes;
    compute(y + z * rows_y, row_x, layers.subspan(row * kNodes, kNodes));
  }
}

/// At ascending places `x` of a row.
void InsideByRows::compute(std::size_t row, std::span<const double> x,
                           std::span<int> layers) const {
  if (!is_union_) return winding_.compute(row, x, layers);
  std::vector<double> aside(x.begin(), x.end());
  std::vector<int> there(layers.size());
  std::ranges::fill(layers, 0);
  for (const double by : {-rounding_, rounding_}) {
    std::ranges::transform(x, aside.begin(), [&](double place) { return place + by; });
    winding_.compute(row, aside, there);
    for (std::size_t i = 0; i < layers.size(); ++i) {
      if (there[i] > 0) layers[i] = 1;
    }
  }
}

double InsideByWindingNumbers::compute(const Vec3& p) const {
  // From outside its bounds a mesh covers no more than half of all directions.
  if (squared_distance(bounds_, p) > 0.0) return 0.0;
  return surface_.compute_number(p);
}

void InsideByWindingNumbers::find_corners(std::size_t brick_y, std::size_t brick_z,
                                          std::span<int> layers) const {
  for (std::size_t i = 0; i < layers.size(); ++i) {
    const Vec3 p = grid_.node(kBrickCells * i, kBrickCells * brick_y, kBrickCells * brick_z);
    layers[i] = compute(p) > 0.5 ? 1 : 0;
  }
}

void InsideByWindingNumbers::find_nodes(const std::array<std::size_t, 3>& brick,
                                        std::span<const float> distances,
                                        std::span<int> layers) const {
  constexpr std::size_t kCount = kNodes * kNodes * kNodes;
  constexpr std::array<std::size_t, 3> kStrides{1, kNodes, kNodes * kNodes};
  const auto place_of = [&](std::size_t node) {
    return std::array{node % kNodes, node / kNodes % kNodes, node / (kNodes * kNodes)};
  };
  const auto number_at = [&](std::size_t node) {
    const auto [i, j, k] = place_of(node);
    return compute(grid_.node(kBrickCells * brick[0] + i, kBrickCells * brick[1] + j,
                              kBrickCells * brick[2] + k));
  };
  // Parts of the brick that the surface does not cut, by flooding.
  std::array<std::uint16_t, kCount> part_of{};
  std::array<std::uint16_t, kCount> waiting{};
  std::array<std::uint16_t, kCount> members{};
  std::fill(layers.begin(), layers.end(), -1);
  std::uint16_t part = 0;
  for (std::size_t seed = 0; seed < kCount; ++seed) {
    if (part_of[seed] != 0) continue;
    ++part;
    std::size_t waits = 0;
    std::size_t size = 0;
    waiting[waits++] = static_cast<std::uint16_t>(seed);
    part_of[seed] = part;
    while (waits > 0) {
      const std::size_t node = waiting[--waits];
      members[size++] = static_cast<std::uint16_t>(node);
      const auto place = place_of(node);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const bool ahead : {false, true}) {
          if (place[axis] == (ahead ? kNodes - 1 : 0)) continue;
          const std::size_t other = ahead ? node + kStrides[axis] : node - kStrides[axis];
          if (part_of[other] != 0 || distances[node] + distances[other] <= 1.0f + 1e-3f) continue;
          part_of[other] = part;
          waiting[waits++] = static_cast<std::uint16_t>(other);
        }
      }
    }
    // Its node farthest from the surface speaks for it, and those in the middle and at the corners
    // of the brick. Where they do not agree clearly, each node speaks for itself.
    const auto is_speaker = [&](std::size_t node) {
      const auto [i, j, k] = place_of(node);
      return i % 4 == 0 && j % 4 == 0 && k % 4 == 0;
    };
    std::size_t farthest = members[0];
    for (std::size_t m = 0; m < size; ++m) {
      if (distances[members[m]] > distances[farthest]) farthest = members[m];
    }
    bool is_clear = true;
    int layer = -1;
    for (std::size_t m = 0; m < size && is_clear; ++m) {
      const std::size_t node = members[m];
      if (node != farthest && !is_speaker(node)) continue;
      const double number = number_at(node);
      const int of_node = number > 0.5 ? 1 : 0;
      is_clear = std::abs(number - 0.5) >= kUnsure && (layer < 0 || layer == of_node);
      layer = of_node;
    }
    for (std::size_t m = 0; m < size; ++m) {
      const std::size_t node = members[m];
      layers[node] = is_clear ? layer : (number_at(node) > 0.5 ? 1 : 0);
    }
  }
}

}  // namespace voxshell
