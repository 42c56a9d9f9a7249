#include "model/shell_elements.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace voxshell {
namespace {

using namespace simd::portable;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Cosine. A direction square to a normal does not face away from it.
constexpr float kFacesAway = -1e-3f;

std::vector<Bounds> bound_elements(std::span<const ShellElement> elements) {
  std::vector<Bounds> boxes(elements.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    boxes[i].extend(static_cast<Vec3>(elements[i].from));
    boxes[i].extend(static_cast<Vec3>(elements[i].to));
  }
  return boxes;
}

}  // namespace

std::vector<ShellElement> list_elements(const PointShell& shell) {
  std::vector<ShellElement> elements;
  elements.reserve(shell.element_count());
  std::size_t id = 0;
  for (const Vec3f& p : shell.points()) {
    const Vec3f& normal = shell.normals()[id++];
    elements.push_back({p, p, normal});
  }
  if (const EdgeSegments* edges = shell.edges()) {
    std::size_t piece = 0;
    for (const Vec3f& middle : edges->middles()) {
      const Vec3f& half = edges->halves()[piece];
      const Vec3f& normal = edges->normals()[piece++];
      elements.push_back({middle - half, middle + half, normal});
    }
  }
  return elements;
}

ShellElements::ShellElements(std::span<const ShellElement> elements)
    : blocks_((elements.size() + kEach - 1) / kEach), hierarchy_(bound_elements(elements), 0.0) {
  for (std::size_t i = 0; i < kEach * blocks_.size(); ++i) {
    Block& block = blocks_[i / kEach];
    const std::size_t k = i % kEach;
    // Blocks are filled up with their last element.
    const ShellElement& e = elements[std::min(i, elements.size() - 1)];
    const Vec3f along = e.to - e.from;
    const float squared = squared_length(along);
    if (squared > 0.0f) block.has_segments = true;
    set_lane(block.per_length, k, squared > 0.0f ? 1.0f / squared : 0.0f);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int i3 = static_cast<int>(axis);
      set_lane(block.from[axis], k, e.from[i3]);
      set_lane(block.along[axis], k, along[i3]);
      set_lane(block.normal[axis], k, e.normal[i3]);
    }
  }
}

ShellElements::Measured ShellElements::measure(const Block& block, const Place& at) {
  const Vec3f& place = at.point;
  const Vec3f& normal = at.normal;
  const auto along_normal = [&](const std::array<F8, 3>& v) {
    return v[0] * normal.x + v[1] * normal.y + v[2] * normal.z;
  };
  std::array<F8, 3> off{place.x - block.from[0], place.y - block.from[1], place.z - block.from[2]};
  const F8 facing = along_normal(block.normal);
  if (block.has_segments) {
    const F8 to_end = off[0] * block.along[0] + off[1] * block.along[1] + off[2] * block.along[2];
    const F8 fraction = minimum(maximum(to_end * block.per_length, F8{}), splat<F8>(1.0f));
    for (std::size_t axis = 0; axis < 3; ++axis) off[axis] -= fraction * block.along[axis];
  }
  const F8 squared = off[0] * off[0] + off[1] * off[1] + off[2] * off[2];
  return {select(facing > kFacesAway, squared, splat<F8>(kInfinity)), along_normal(off)};
}

/// The blocks that come within `reach` of a box.
void ShellElements::find_blocks(const Bounds& around, float reach,
                                std::vector<std::size_t>& found) const {
  const auto lower = static_cast<Vec3f>(around.lower);
  const auto upper = static_cast<Vec3f>(around.upper);
  const auto measure_boxes = [&](const BoxHierarchy::Node& node) {
    const F8 x = maximum(maximum(node.lower[0] - upper.x, lower.x - node.upper[0]), F8{});
    const F8 y = maximum(maximum(node.lower[1] - upper.y, lower.y - node.upper[1]), F8{});
    const F8 z = maximum(maximum(node.lower[2] - upper.z, lower.z - node.upper[2]), F8{});
    return x * x + y * y + z * z;
  };
  constexpr float kRounding = 1.0f + 1e-5f;
  const float limit = reach * reach * kRounding;
  found.clear();
  hierarchy_.search(limit, measure_boxes, [&](std::size_t run) { found.push_back(run); });
}

void ShellElements::find_nearest(std::span<const Place> places, float& reach,
                                 std::span<Nearest> found) const {
  constexpr float kAround = 2.0f;  // times as far as the nearest
  constexpr float kMoreReach = 1.25f;
  std::ranges::fill(found, Nearest{kInfinity, kInfinity});
  std::vector<std::size_t> blocks;
  std::vector<Measured> measured;
  std::vector<std::size_t> waiting(places.size());
  std::iota(waiting.begin(), waiting.end(), std::size_t{0});
  float farthest = 0.0f;
  bool is_last = false;
  // All elements within the reach are looked at: an answer counts that needs none farther away.
  while (!waiting.empty()) {
    Bounds around;
    for (const std::size_t i : waiting) around.extend(static_cast<Vec3>(places[i].point));
    find_blocks(around, reach, blocks);
    is_last = blocks.size() == blocks_.size();
    measured.resize(blocks.size());
    std::erase_if(waiting, [&](std::size_t i) {
      F8 least = splat<F8>(kInfinity);
      for (std::size_t k = 0; k < blocks.size(); ++k) {
        measured[k] = measure(blocks_[blocks[k]], places[i]);
        least = minimum(least, measured[k].squared);
      }
      float nearest = kInfinity;
      for (std::size_t k = 0; k < kEach; ++k) nearest = std::min<float>(nearest, least[k]);
      const float distance = std::sqrt(nearest);
      if (!is_last && !(kAround * distance <= reach)) return false;
      if (nearest == kInfinity) return true;
      const F8 limit = splat<F8>(kAround * kAround * nearest);
      F8 height = splat<F8>(kInfinity);
      for (const Measured& each : measured) {
        height = select(each.squared <= limit, minimum(height, each.height), height);
      }
      float lowest = kInfinity;
      for (std::size_t k = 0; k < kEach; ++k) lowest = std::min<float>(lowest, height[k]);
      found[i] = {distance, lowest > 0.0f ? lowest : 0.0f};
      farthest = std::max(farthest, distance);
      return true;
    });
    if (!waiting.empty()) reach *= 2.0f;
  }
  if (farthest > 0.0f) reach = kMoreReach * kAround * farthest;
}

}  // namespace voxshell
