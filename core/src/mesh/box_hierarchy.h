#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "simd/wide.h"
#include "voxshell/bounds.h"
#include "voxshell/vector.h"

namespace voxshell {

/// Indices of points in an order that keeps near ones together: along a Morton curve through the
/// box around them. Points in the same cell of its 1024^3 keep their order.
std::vector<std::uint32_t> order_by_place(std::span<const Vec3> points);

/// Boxes around runs of eight items in a given order, around eight of those boxes, and so on. Cheap
/// to build, and as tight as the order.
class BoxHierarchy {
 public:
  static constexpr std::size_t kEach = 8;

  using F8 = simd::portable::F8;
  /// Eight boxes by axis, in float32 and not smaller for it. Empty ones are infinitely far away.
  struct Node {
    std::array<F8, 3> lower;
    std::array<F8, 3> upper;
  };

  /// `items` are the boxes of the items; they are grown by `slack` meters on each side.
  BoxHierarchy(std::span<const Bounds> items, double slack);

  /// Calls `visit(run)` for the runs whose boxes are not farther than `limit`, which it may lower;
  /// near ones first, roughly. `measure(node)` says how far away eight boxes are.
  template <class Measure, class Visit>
  void search(const float& limit, const Measure& measure, const Visit& visit) const;

 private:
  static constexpr std::size_t kMostLevels = 11;  // 8^11 runs are more than there is memory for

  struct Level {
    std::size_t first = 0;  ///< node
    std::size_t count = 0;
  };

  std::vector<Node> nodes_;
  std::array<Level, kMostLevels> levels_{};  ///< 0: its boxes hold runs
  std::size_t level_count_ = 0;
};

template <class Measure, class Visit>
void BoxHierarchy::search(const float& limit, const Measure& measure, const Visit& visit) const {
  constexpr float kEmpty = std::numeric_limits<float>::infinity();
  struct Waiting {
    float distance;
    std::uint32_t level;  ///< of the node that holds the box
    std::size_t box;      ///< of that level: a node of the one below, or a run
  };
  std::array<Waiting, kMostLevels * kEach> stack;  // NOLINT: filled as it is needed
  std::size_t waiting = 0;
  const auto open = [&](std::size_t level, std::size_t node) {
    const F8 distances = measure(nodes_[levels_[level].first + node]);
    const std::size_t bottom = waiting;
    for (std::size_t k = 0; k < kEach; ++k) {
      const float distance = distances[k];
      if (!(distance <= limit) || distance == kEmpty) continue;
      std::size_t at = waiting++;
      for (; at > bottom && stack[at - 1].distance < distance; --at) stack[at] = stack[at - 1];
      stack[at] = {distance, static_cast<std::uint32_t>(level), kEach * node + k};
    }
  };
  open(level_count_ - 1, 0);
  while (waiting > 0) {
    const Waiting next = stack[--waiting];
    if (!(next.distance <= limit)) continue;
    if (next.level == 0) {
      visit(next.box);
    } else {
      open(next.level - 1, next.box);
    }
  }
}

}  // namespace voxshell
