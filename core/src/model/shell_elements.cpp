#include "model/shell_elements.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace voxshell {
namespace {

/// Cosine. What is square to a normal does not face away from it.
constexpr float kFacesAway = -1e-3f;

std::vector<std::uint32_t> order_elements(std::span<const ShellElement> elements) {
  std::vector<Vec3> middles(elements.size());
  std::ranges::transform(elements, middles.begin(), [](const ShellElement& e) {
    return 0.5 * (static_cast<Vec3>(e.from) + static_cast<Vec3>(e.to));
  });
  return order_by_place(middles);
}

std::vector<Bounds> bound_elements(std::span<const ShellElement> elements,
                                   std::span<const std::uint32_t> order) {
  std::vector<Bounds> boxes(elements.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    boxes[i].extend(static_cast<Vec3>(elements[order[i]].from));
    boxes[i].extend(static_cast<Vec3>(elements[order[i]].to));
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
    : order_(order_elements(elements)),
      blocks_((elements.size() + kEach - 1) / kEach),
      hierarchy_(bound_elements(elements, order_)) {
  for (std::size_t i = 0; i < kEach * blocks_.size(); ++i) {
    Block& block = blocks_[i / kEach];
    const std::size_t k = i % kEach;
    // Blocks are filled up with their last element.
    const ShellElement& e = elements[order_[std::min(i, elements.size() - 1)]];
    const Vec3f along = e.to - e.from;
    const float squared = squared_length(along);
    block.per_length[k] = squared > 0.0f ? 1.0f / squared : 0.0f;
    for (int axis = 0; axis < 3; ++axis) {
      block.from[axis][k] = e.from[axis];
      block.along[axis][k] = along[axis];
      block.normal[axis][k] = e.normal[axis];
      block.other_normal[axis][k] = e.other_normal[axis];
    }
  }
}

void ShellElements::measure(const Block& block, const Vec3f& place, const Vec3f& normal,
                            Measured& out) {
  for (std::size_t k = 0; k < kEach; ++k) {
    const float x = place.x - block.from[0][k];
    const float y = place.y - block.from[1][k];
    const float z = place.z - block.from[2][k];
    const float to_end = x * block.along[0][k] + y * block.along[1][k] + z * block.along[2][k];
    const float share = std::min(std::max(to_end * block.per_length[k], 0.0f), 1.0f);
    const float dx = x - share * block.along[0][k];
    const float dy = y - share * block.along[1][k];
    const float dz = z - share * block.along[2][k];
    out.squared[k] = dx * dx + dy * dy + dz * dz;
    out.height[k] = dx * normal.x + dy * normal.y + dz * normal.z;
    const float one = normal.x * block.normal[0][k] + normal.y * block.normal[1][k] +
                      normal.z * block.normal[2][k];
    const float other = normal.x * block.other_normal[0][k] + normal.y * block.other_normal[1][k] +
                        normal.z * block.other_normal[2][k];
    out.faces[k] = std::max(one, other) > kFacesAway;
  }
}

/// Calls `visit(block)` for the blocks that come nearer than most_squared, which it may lower.
template <class Visit>
void ShellElements::visit_near(const Vec3& place, double& most_squared, const Visit& visit) const {
  std::array<std::pair<std::size_t, double>, BoxHierarchy::kStack> stack{};
  std::size_t waiting = 0;
  stack[waiting++] = {BoxHierarchy::kRoot, 0.0};
  while (waiting > 0) {
    const auto [node, distance] = stack[--waiting];
    if (!(distance <= most_squared)) continue;
    if (hierarchy_.is_leaf(node)) {
      visit(blocks_[hierarchy_.run_of(node)]);
      continue;
    }
    const std::size_t left = 2 * node;
    std::pair near{left, squared_distance(hierarchy_.box(left), place)};
    std::pair far{left + 1, squared_distance(hierarchy_.box(left + 1), place)};
    if (far.second < near.second) std::swap(near, far);
    // Empty boxes are infinitely far away.
    if (far.second <= most_squared) stack[waiting++] = far;
    if (near.second <= most_squared) stack[waiting++] = near;
  }
}

ShellElements::Nearest ShellElements::find_nearest(const Vec3& place, const Vec3& normal,
                                                   double guess) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kAround = 2.0;  // times as far as the nearest
  if (blocks_.empty()) return {kInfinity, kInfinity};
  const auto p = static_cast<Vec3f>(place);
  const auto n = static_cast<Vec3f>(normal);
  Measured measured;

  // Float32 places differ a little from those of the boxes.
  const auto widen = [&](double squared) { return squared * (1.0 + 1e-5); };
  double most = widen(guess * guess);
  double nearest = kInfinity;
  double height = 0.0;
  visit_near(place, most, [&](const Block& block) {
    measure(block, p, n, measured);
    for (std::size_t k = 0; k < kEach; ++k) {
      const double squared = measured.squared[k];
      if (!measured.faces[k] || !(squared < nearest)) continue;
      nearest = squared;
      height = measured.height[k];
      most = std::min(most, widen(squared));
    }
  });
  if (nearest == kInfinity) return {kInfinity, kInfinity};
  const double distance = std::sqrt(nearest);
  if (height <= 0.0) return {distance, 0.0};

  const double around = kAround * kAround * nearest;
  most = widen(around);
  visit_near(place, most, [&](const Block& block) {
    measure(block, p, n, measured);
    for (std::size_t k = 0; k < kEach; ++k) {
      if (!measured.faces[k] || static_cast<double>(measured.squared[k]) > around) continue;
      height = std::min(height, static_cast<double>(measured.height[k]));
    }
  });
  return {distance, std::max(height, 0.0)};
}

}  // namespace voxshell
