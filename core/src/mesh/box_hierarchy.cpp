#include "mesh/box_hierarchy.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace voxshell {
namespace {

/// The lowest ten bits of x, each followed by two zeros.
std::uint64_t spread_bits(std::uint64_t x) {
  x = (x | x << 16) & 0x030000FFu;
  x = (x | x << 8) & 0x0300F00Fu;
  x = (x | x << 4) & 0x030C30C3u;
  return (x | x << 2) & 0x09249249u;
}

}  // namespace

std::vector<std::uint32_t> order_by_place(std::span<const Vec3> points) {
  constexpr int kIndexBits = 32;
  constexpr int kDigitBits = 10;
  constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
  Bounds bounds;
  for (const Vec3& p : points) bounds.extend(p);
  const double side = points.empty() ? 0.0 : bounds.extents()[bounds.longest_axis()];
  const double scale = side > 0.0 ? (kDigits - 1) / side : 0.0;

  std::vector<std::uint64_t> keys(points.size());  // the place on the curve, then the index
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 cell = scale * (points[i] - bounds.lower);
    const std::uint64_t code = spread_bits(static_cast<std::uint64_t>(cell.x)) |
                               spread_bits(static_cast<std::uint64_t>(cell.y)) << 1 |
                               spread_bits(static_cast<std::uint64_t>(cell.z)) << 2;
    keys[i] = code << kIndexBits | i;
  }
  std::vector<std::uint64_t> sorted(keys.size());
  for (int shift = kIndexBits; shift < kIndexBits + 3 * kDigitBits; shift += kDigitBits) {
    const auto digit = [&](std::uint64_t key) { return key >> shift & (kDigits - 1); };
    std::array<std::size_t, kDigits + 1> next{};
    for (const std::uint64_t key : keys) ++next[digit(key) + 1];
    for (std::size_t i = 0; i < kDigits; ++i) next[i + 1] += next[i];
    for (const std::uint64_t key : keys) sorted[next[digit(key)]++] = key;
    keys.swap(sorted);
  }
  std::vector<std::uint32_t> order(keys.size());
  std::ranges::transform(keys, order.begin(),
                         [](std::uint64_t key) { return static_cast<std::uint32_t>(key); });
  return order;
}

BoxHierarchy::BoxHierarchy(std::span<const Bounds> items, double slack) {
  const auto set = [](Node& node, std::size_t k, const Vec3& lower, const Vec3& upper) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int i3 = static_cast<int>(axis);
      set_lane(node.lower[axis], k, std::nextafter(static_cast<float>(lower[i3]), -kInfinity));
      set_lane(node.upper[axis], k, std::nextafter(static_cast<float>(upper[i3]), kInfinity));
    }
  };
  const auto clear = [](Node& node) {
    constexpr float kInfinity = std::numeric_limits<float>::infinity();
    node.lower.fill(simd::portable::splat<F8>(kInfinity));
    node.upper.fill(simd::portable::splat<F8>(-kInfinity));
  };
  std::vector<Bounds> boxes((items.size() + kEach - 1) / kEach);
  for (std::size_t i = 0; i < items.size(); ++i) boxes[i / kEach].extend(items[i]);
  const Vec3 margin{slack, slack, slack};
  for (Bounds& box : boxes) box = {box.lower - margin, box.upper + margin};
  do {
    const std::size_t count = std::max<std::size_t>(1, (boxes.size() + kEach - 1) / kEach);
    levels_[level_count_++] = {nodes_.size(), count};
    std::vector<Bounds> larger(count);
    for (std::size_t i = 0; i < count; ++i) {
      Node& node = nodes_.emplace_back();
      clear(node);
      for (std::size_t k = 0; k < kEach && kEach * i + k < boxes.size(); ++k) {
        const Bounds& box = boxes[kEach * i + k];
        set(node, k, box.lower, box.upper);
        larger[i].extend(box);
      }
    }
    boxes = std::move(larger);
  } while (boxes.size() > 1);
}

}  // namespace voxshell
