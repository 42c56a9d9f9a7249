#include "model/shell_elements.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace voxshell {
namespace {

using namespace simd::portable;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Cosine. What is square to a normal does not face away from it.
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
  elements.reserve(shell.size());
  std::size_t id = 0;
  for (const Vec3f& p : shell.points()) {
    const Vec3f& normal = shell.normals()[id++];
    elements.push_back({p, p, normal, normal});
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
    block.per_length[k] = squared > 0.0f ? 1.0f / squared : 0.0f;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int i3 = static_cast<int>(axis);
      block.from[axis][k] = e.from[i3];
      block.along[axis][k] = along[i3];
      block.normal[axis][k] = e.normal[i3];
      block.other_normal[axis][k] = e.other_normal[i3];
    }
  }
}

ShellElements::Measured ShellElements::measure(const Block& block, const Vec3f& place,
                                               const Vec3f& normal) {
  const auto along_normal = [&](const std::array<F8, 3>& v) {
    return v[0] * normal.x + v[1] * normal.y + v[2] * normal.z;
  };
  std::array<F8, 3> off{place.x - block.from[0], place.y - block.from[1], place.z - block.from[2]};
  const F8 to_end = off[0] * block.along[0] + off[1] * block.along[1] + off[2] * block.along[2];
  const F8 share = minimum(maximum(to_end * block.per_length, F8{}), splat<F8>(1.0f));
  for (std::size_t axis = 0; axis < 3; ++axis) off[axis] -= share * block.along[axis];
  const F8 squared = off[0] * off[0] + off[1] * off[1] + off[2] * off[2];
  const F8 facing = maximum(along_normal(block.normal), along_normal(block.other_normal));
  return {select(facing > kFacesAway, squared, splat<F8>(kInfinity)), along_normal(off)};
}

ShellElements::Nearest ShellElements::find_nearest(const Vec3& place, const Vec3& normal,
                                                   std::size_t& guess) const {
  constexpr float kAround = 4.0f;  // squared distances: twice as far as the nearest
  constexpr float kRounding = 1.0f + 1e-5f;
  const auto p = static_cast<Vec3f>(place);
  const auto n = static_cast<Vec3f>(normal);
  const auto measure_boxes = [&](const BoxHierarchy::Node& node) {
    const F8 x = maximum(maximum(node.lower[0] - p.x, p.x - node.upper[0]), F8{});
    const F8 y = maximum(maximum(node.lower[1] - p.y, p.y - node.upper[1]), F8{});
    const F8 z = maximum(maximum(node.lower[2] - p.z, p.z - node.upper[2]), F8{});
    return x * x + y * y + z * z;
  };

  float nearest = kInfinity;
  float height = 0.0f;
  float limit = kInfinity;
  const auto look_at = [&](std::size_t run) {
    const Measured measured = measure(blocks_[run], p, n);
    for (std::size_t k = 0; k < kEach; ++k) {
      if (!(measured.squared[k] < nearest)) continue;
      nearest = measured.squared[k];
      height = measured.height[k];
      guess = run;
    }
    limit = nearest * kRounding;
  };
  look_at(guess);
  hierarchy_.search(limit, measure_boxes, look_at);
  if (nearest == kInfinity) return {kInfinity, kInfinity};
  const auto distance = std::sqrt(static_cast<double>(nearest));
  if (height <= 0.0f) return {distance, 0.0};

  const float around = kAround * nearest;
  limit = around * kRounding;
  hierarchy_.search(limit, measure_boxes, [&](std::size_t run) {
    const Measured measured = measure(blocks_[run], p, n);
    for (std::size_t k = 0; k < kEach; ++k) {
      if (measured.squared[k] <= around) height = std::min<float>(height, measured.height[k]);
    }
    if (height <= 0.0f) limit = -1.0f;  // there is nothing left to find
  });
  return {distance, std::max(static_cast<double>(height), 0.0)};
}

}  // namespace voxshell
