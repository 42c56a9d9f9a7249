#include "voxshell/manifold.h"

#include <algorithm>
#include <array>
#include <cassert>

#include "query/posed.h"
#include "query/scratch.h"
#include "query/walk.h"

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

namespace {

/// What is left of the tree when there are enough spheres to choose from. One search begins at the
/// root; several share what lies near the surface.
template <class V>
simd::Seeds find_seeds(const simd::PosedView<V>& posed, const simd::TreeView& tree, float margin,
                       bool are_shared, QueryScratch::State& state) {
  return walk_down(posed, tree, margin, 0.0f, SphereBounds::kWanted, state,
                   [&](const simd::Seeds& left) {
                     return are_shared && left.nodes.count <= simd::kMostSeeds / 8;
                   });
}

void append(simd::PointList& points, const simd::FoundPoint& found) {
  points.id[points.count] = found.id;
  points.distance[points.count] = found.distance;
  points.x[points.count] = found.point[0];
  points.y[points.count] = found.point[1];
  points.z[points.count] = found.point[2];
  ++points.count;
}

}  // namespace

std::span<const Contact> find_manifold(const Field& field, const PointShell& shell,
                                       const Pose& field_from_shell, float margin,
                                       QueryScratch& scratch, std::size_t max_points) {
  assert(max_points >= 1 && max_points <= kManifoldSize);
  QueryScratch::State& state = scratch.state();
  state.reserve(shell);
  const simd::TreeView tree = view_tree(shell);
  with_posed(field, shell, field_from_shell, [&]<class V>(const simd::PosedView<V>& posed) {
    const auto& kernels = simd::query_kernels<V>(simd::active_isa());
    simd::PointList points = state.empty_points();
    simd::FoundPoint found{simd::kNone, 0.0f, {}};
    simd::ManifoldSearch search{};
    const simd::Seeds seeds = find_seeds(posed, tree, margin, max_points > 1, state);
    kernels.find_deepest(posed, tree, seeds, 0, margin, &found);
    while (found.id != simd::kNone) {
      append(points, found);
      if (points.count == max_points) break;
      std::copy_n(found.point, 3, search.chosen[search.count++]);
      found = kernels.find_widest(posed, tree, seeds, search, margin);
    }
    kernels.complete(posed, tree, points, state.contact_data());
    state.contact_count = points.count;
  });
  return scratch.contacts();
}

std::span<const Contact> find_deepest_per_segment(const Field& field, const PointShell& shell,
                                                  const Pose& field_from_shell, int level,
                                                  float margin, QueryScratch& scratch) {
  assert(level >= 1 && level <= PointSphereTree::kMaxLevel);
  QueryScratch::State& state = scratch.state();
  state.reserve(shell);
  const simd::TreeView tree = view_tree(shell);
  const int depth = 2 * (level - 1);
  if (depth > tree.depth) {
    // Segments finer than what the walk ends at hold a bucket each.
    const auto all = find_contacts(field, shell, field_from_shell, {.margin = margin}, scratch);
    select_deepest_per_segment(all, shell.tree(), level, state.chosen);
    Contact* contacts = state.contact_data();
    for (std::size_t i = 0; i < state.chosen.size(); ++i) contacts[i] = contacts[state.chosen[i]];
    state.contact_count = state.chosen.size();
    state.survivors.are_contacts_kept = false;
    return scratch.contacts();
  }
  const std::size_t segments = std::size_t{1} << depth;
  simd::FoundPoint* best = state.reserve_found(segments);
  std::fill_n(best, segments, simd::FoundPoint{simd::kNone, 0.0f, {}});
  with_posed(field, shell, field_from_shell, [&]<class V>(const simd::PosedView<V>& posed) {
    const auto& kernels = simd::query_kernels<V>(simd::active_isa());
    const simd::Seeds seeds = find_seeds(posed, tree, margin, true, state);
    kernels.find_deepest(posed, tree, seeds, depth, margin, best);
    simd::PointList points = state.empty_points();
    for (std::size_t i = 0; i < segments; ++i) {
      if (best[i].id != simd::kNone) append(points, best[i]);
    }
    kernels.complete(posed, tree, points, state.contact_data());
    state.contact_count = points.count;
  });
  return scratch.contacts();
}

}  // namespace voxshell
