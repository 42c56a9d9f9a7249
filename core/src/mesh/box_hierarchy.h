#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "voxshell/bounds.h"
#include "voxshell/vector.h"

namespace voxshell {

/// Indices of points in an order that keeps near ones together: along a Morton curve through the
/// box around them. Points in the same cell of its 1024^3 keep their order.
std::vector<std::uint32_t> order_by_place(std::span<const Vec3> points);

/// A complete binary tree of boxes around items in a given order: a leaf holds kRun consecutive
/// items, and the children of node i are 2 i and 2 i + 1. Cheap to build; as tight as the order.
class BoxHierarchy {
 public:
  static constexpr std::size_t kRun = 8;
  static constexpr std::size_t kRoot = 1;

  /// `items` are the boxes of the items; some may be empty.
  explicit BoxHierarchy(std::span<const Bounds> items);

  bool is_leaf(std::size_t node) const { return node >= leaves_; }
  std::size_t run_of(std::size_t leaf) const { return leaf - leaves_; }  ///< items / kRun
  const Bounds& box(std::size_t node) const { return boxes_[node]; }

  /// A stack for a walk from the root: one node waits at each level.
  static constexpr std::size_t kStack = 64;

 private:
  std::size_t leaves_;
  std::vector<Bounds> boxes_;
};

}  // namespace voxshell
