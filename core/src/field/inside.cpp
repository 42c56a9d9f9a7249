#include "field/inside.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

#include "simd/grid_view.h"

namespace voxshell {
namespace {

using simd::kBrickCells;

constexpr std::size_t kNodes = kBrickCells + 1;

bool is_inside(double number) { return number > 0.5; }
bool is_clear(double number) { return std::abs(number - 0.5) >= kUnsure; }

}  // namespace

BrickSides decide_sides(std::span<const double> numbers) {
  BrickSides sides;
  for (std::size_t node = 0; node < BrickSides::kNodes; ++node) {
    sides.is_inside[node] = is_inside(numbers[node]);
    sides.is_clear[node] = is_clear(numbers[node]);
  }
  return sides;
}

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

void InsideByWindingNumbers::compute(std::span<const Vec3> places,
                                     std::span<double> numbers) const {
  // From outside its bounds a mesh covers no more than half of all directions.
  std::vector<Vec3> within;
  within.reserve(places.size());
  std::ranges::copy_if(places, std::back_inserter(within),
                       [&](const Vec3& p) { return !(squared_distance(bounds_, p) > 0.0); });
  std::vector<double> there(within.size());
  surface_.compute_numbers(within, there);
  auto next = there.begin();
  for (std::size_t i = 0; i < places.size(); ++i) {
    numbers[i] = squared_distance(bounds_, places[i]) > 0.0 ? 0.0 : *next++;
  }
}

void InsideByWindingNumbers::find_corners(std::size_t brick_y, std::size_t brick_z,
                                          std::span<int> layers) const {
  std::vector<Vec3> places(layers.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    places[i] = grid_.node(kBrickCells * i, kBrickCells * brick_y, kBrickCells * brick_z);
  }
  std::vector<double> numbers(places.size());
  compute(places, numbers);
  for (std::size_t i = 0; i < layers.size(); ++i) layers[i] = is_inside(numbers[i]) ? 1 : 0;
}

void InsideByWindingNumbers::find_nodes(const std::array<std::size_t, 3>& brick,
                                        std::span<const float> distances,
                                        std::span<int> layers) const {
  constexpr std::size_t kCount = kNodes * kNodes * kNodes;
  constexpr std::array<std::size_t, 3> kStrides{1, kNodes, kNodes * kNodes};
  const auto place_of = [&](std::size_t node) {
    return std::array{node % kNodes, node / kNodes % kNodes, node / (kNodes * kNodes)};
  };
  const auto known =
      known_.find(brick[0] + grid_.bricks[0] * (brick[1] + grid_.bricks[1] * brick[2]));
  struct Side {
    bool is_inside;
    bool is_clear;
  };
  const auto find_sides = [&](std::span<const std::uint16_t> nodes) {
    std::vector<Side> sides;
    sides.reserve(nodes.size());
    if (known != known_.end()) {
      for (const std::size_t node : nodes) {
        sides.push_back({known->second.is_inside[node], known->second.is_clear[node]});
      }
      return sides;
    }
    std::vector<Vec3> places;
    places.reserve(nodes.size());
    for (const std::size_t node : nodes) {
      const auto [i, j, k] = place_of(node);
      places.push_back(grid_.node(kBrickCells * brick[0] + i, kBrickCells * brick[1] + j,
                                  kBrickCells * brick[2] + k));
    }
    std::vector<double> numbers(places.size());
    compute(places, numbers);
    for (const double number : numbers) sides.push_back({is_inside(number), is_clear(number)});
    return sides;
  };
  // Its node farthest from the surface speaks for a part, and those in the middle and at the
  // corners of the brick.
  const auto is_speaker = [&](std::size_t node) {
    const auto [i, j, k] = place_of(node);
    return i % 4 == 0 && j % 4 == 0 && k % 4 == 0;
  };
  // Parts of the brick that the surface does not cut, by flooding.
  std::array<bool, kCount> was_seen{};
  std::array<std::uint16_t, kCount> waiting{};
  std::array<std::uint16_t, kCount> members{};  // part by part
  std::size_t seen = 0;
  struct Part {
    std::size_t end_of_members;
    std::size_t end_of_speakers;
  };
  std::vector<Part> parts;
  std::vector<std::uint16_t> speakers;
  for (std::size_t seed = 0; seed < kCount; ++seed) {
    if (was_seen[seed]) continue;
    const std::size_t begin = seen;
    std::size_t waits = 0;
    waiting[waits++] = static_cast<std::uint16_t>(seed);
    was_seen[seed] = true;
    while (waits > 0) {
      const std::size_t node = waiting[--waits];
      members[seen++] = static_cast<std::uint16_t>(node);
      const auto place = place_of(node);
      for (std::size_t axis = 0; axis < 3; ++axis) {
        for (const bool ahead : {false, true}) {
          if (place[axis] == (ahead ? kNodes - 1 : 0)) continue;
          const std::size_t other = ahead ? node + kStrides[axis] : node - kStrides[axis];
          if (was_seen[other] || distances[node] + distances[other] <= 1.0f + 1e-3f) continue;
          was_seen[other] = true;
          waiting[waits++] = static_cast<std::uint16_t>(other);
        }
      }
    }
    const auto of_part = std::span(members).subspan(begin, seen - begin);
    const std::uint16_t farthest =
        *std::ranges::max_element(of_part, {}, [&](std::uint16_t node) { return distances[node]; });
    std::ranges::copy_if(of_part, std::back_inserter(speakers),
                         [&](std::uint16_t node) { return node == farthest || is_speaker(node); });
    parts.push_back({seen, speakers.size()});
  }
  const std::vector<Side> spoken = find_sides(speakers);
  // Where they do not agree clearly, each node speaks for itself.
  std::vector<std::uint16_t> in_doubt;
  Part before{0, 0};
  for (const Part& part : parts) {
    const auto of_part = std::span(members).subspan(before.end_of_members,
                                                    part.end_of_members - before.end_of_members);
    const auto sides = std::span(spoken).subspan(before.end_of_speakers,
                                                 part.end_of_speakers - before.end_of_speakers);
    before = part;
    const bool is_in = sides.front().is_inside;
    if (!std::ranges::all_of(
            sides, [&](const Side& side) { return side.is_clear && side.is_inside == is_in; })) {
      in_doubt.insert(in_doubt.end(), of_part.begin(), of_part.end());
      continue;
    }
    for (const std::uint16_t node : of_part) layers[node] = is_in ? 1 : 0;
  }
  const std::vector<Side> of_each = find_sides(in_doubt);
  for (std::size_t i = 0; i < in_doubt.size(); ++i) {
    layers[in_doubt[i]] = of_each[i].is_inside ? 1 : 0;
  }
}

}  // namespace voxshell
