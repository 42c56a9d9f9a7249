#include "voxshell/manifold.h"

#include <algorithm>
#include <cassert>

namespace voxshell {
namespace {

/// The index of the contact with the largest score above zero, the first of equals; or the number
/// of contacts where there is none.
template <class Score>
std::uint32_t find_largest(std::span<const Contact> contacts, const Score& score) {
  auto best = static_cast<std::uint32_t>(contacts.size());
  float best_score = 0.0f;
  for (std::uint32_t i = 0; i < contacts.size(); ++i) {
    const float s = score(contacts[i]);
    if (s > best_score) {
      best_score = s;
      best = i;
    }
  }
  return best;
}

std::uint32_t find_deepest(std::span<const Contact> contacts) {
  std::uint32_t deepest = 0;
  for (std::uint32_t i = 1; i < contacts.size(); ++i) {
    if (contacts[i].depth > contacts[deepest].depth) deepest = i;
  }
  return deepest;
}

}  // namespace

ManifoldPoints select_manifold(std::span<const Contact> contacts, std::size_t max_points) {
  assert(max_points >= 1 && max_points <= kManifoldSize);
  ManifoldPoints manifold;
  if (contacts.empty()) return manifold;
  const auto add = [&](std::uint32_t index) {
    if (index < contacts.size()) manifold.indices[manifold.count++] = index;
    return index < contacts.size() && manifold.count < max_points;
  };

  const std::uint32_t deepest = find_deepest(contacts);
  if (!add(deepest)) return manifold;
  const Vec3f a = contacts[deepest].point;

  const std::uint32_t farthest =
      find_largest(contacts, [&](const Contact& c) { return squared_length(c.point - a); });
  if (!add(farthest)) return manifold;
  const Vec3f b = contacts[farthest].point;

  const std::uint32_t widest = find_largest(
      contacts, [&](const Contact& c) { return squared_length(cross(b - a, c.point - a)); });
  if (!add(widest)) return manifold;
  const Vec3f c = contacts[widest].point;

  // A fourth point enlarges the area by the triangle that it makes with the side it lies beyond.
  const Vec3f up = cross(b - a, c - a);
  const auto added_area = [&](const Contact& contact) {
    const Vec3f p = contact.point;
    return std::max(
        {dot(cross(p - a, b - a), up), dot(cross(p - b, c - b), up), dot(cross(p - c, a - c), up)});
  };
  add(find_largest(contacts, added_area));
  return manifold;
}

void select_deepest_per_segment(std::span<const Contact> contacts, const PointSphereTree& tree,
                                int level, std::vector<std::uint32_t>& deepest) {
  assert(level >= 1 && level <= PointSphereTree::kMaxLevel);
  deepest.clear();
  // Contacts ascend by id and segments are ranges of ids, so each segment's contacts are together.
  std::uint32_t current = 0;
  for (std::uint32_t i = 0; i < contacts.size(); ++i) {
    const std::uint32_t segment = tree.segment(contacts[i].id, level);
    if (deepest.empty() || segment != current) {
      deepest.push_back(i);
      current = segment;
    } else if (contacts[i].depth > contacts[deepest.back()].depth) {
      deepest.back() = i;
    }
  }
}

}  // namespace voxshell
