#pragma once

#include <limits>
#include <utility>

#include "query/scratch.h"

namespace voxshell {

enum class SphereBounds { kUnwanted, kWanted };

/// The root; or where no bounds are wanted its two clusters, if it has no more: hardly ever is one
/// of them left out.
inline simd::Seeds start_walk(const simd::TreeView& tree, simd::NodeList nodes,
                              SphereBounds bounds) {
  const bool is_pair =
      bounds == SphereBounds::kUnwanted && tree.depth % 3 == 1 && tree.level_count > 1;
  for (; nodes.count < (is_pair ? 2u : 1u); ++nodes.count) {
    nodes.index[nodes.count] = nodes.count;
    nodes.tag[nodes.count] = 0;
    nodes.bound[nodes.count] = -std::numeric_limits<float>::infinity();
  }
  return {nodes, is_pair ? 1 : 0};
}

/// Drops those of the spheres that a walk has left in which no point arrives.
template <class V>
void keep_arriving(const simd::Arrivals<V>& arrivals, const simd::TreeView& tree, float growth,
                   simd::Seeds& left) {
  if (arrivals.count == 0 || left.level == 0) return;
  simd::query_kernels<V>(simd::active_isa())
      .keep_arriving_spheres(arrivals, tree, left.level - 1, growth, left.nodes);
}

/// Walks the tree breadth first, a level at a time, as long as `go_on(what is left)` says so and
/// something is left, of which `go_on` may drop some; where nothing is, all levels are done. Uses
/// the state's node buffers, and so forgets the survivors in them. Without bounds, what is left has
/// none, and the walk is faster.
template <class V, class GoOn>
simd::Seeds walk_down(const simd::PosedView<V>& posed, const simd::TreeView& tree, float margin,
                      float growth, SphereBounds bounds, QueryScratch::State& state,
                      const GoOn& go_on) {
  state.survivors.forget();
  simd::Seeds left = start_walk(tree, state.lists().nodes[0].empty_list(), bounds);
  simd::NodeList next = state.lists().nodes[1].empty_list();
  if (bounds == SphereBounds::kUnwanted) left.nodes.bound = next.bound = nullptr;
  const auto& kernels = simd::query_kernels<V>(simd::active_isa());
  while (left.level < tree.level_count && left.nodes.count > 0 && go_on(left)) {
    next.count = 0;
    kernels.expand(posed, tree, left.level, left.nodes, next, margin, growth);
    std::swap(left.nodes, next);
    ++left.level;
  }
  if (left.nodes.count == 0) left.level = tree.level_count;
  return left;
}

}  // namespace voxshell
