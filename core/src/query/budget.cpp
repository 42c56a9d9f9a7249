#include <algorithm>
#include <limits>
#include <numeric>

#include "query/deepest.h"
#include "query/posed.h"
#include "query/scratch.h"
#include "query/walk.h"
#include "voxshell/contacts.h"

namespace voxshell {
namespace {

std::uint32_t count_buckets(const simd::TreeView& tree, std::uint32_t slot) {
  const auto first = [&](std::uint64_t s) { return (tree.bucket_count * s) >> tree.depth; };
  return static_cast<std::uint32_t>(first(std::uint64_t{slot} + 1) - first(slot));
}

/// Sorts the nodes' places by what may lie deepest.
std::uint32_t* rank(const simd::NodeList& nodes, std::uint32_t* places) {
  std::iota(places, places + nodes.count, 0u);
  std::sort(places, places + nodes.count, [&](std::uint32_t a, std::uint32_t b) {
    return nodes.bound[a] != nodes.bound[b] ? nodes.bound[a] < nodes.bound[b] : a < b;
  });
  return places;
}

}  // namespace

BudgetedContacts find_contacts_within_budget(const Field& field, const PointShell& shell,
                                             const Pose& field_from_shell,
                                             const ContactOptions& options, std::size_t budget,
                                             QueryScratch& scratch) {
  QueryScratch::State& state = scratch.state();
  const simd::TreeView tree = view_tree(shell);
  state.reserve(tree);
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  BudgetedContacts result{{}, true, -kInfinity};
  with_posed(field, shell, field_from_shell, [&]<class V>(const simd::PosedView<V>& posed) {
    const auto& kernels = simd::query_kernels<V>(simd::active_isa());
    std::size_t spent = 0;
    const std::size_t for_spheres = (budget + 1) / 2;
    simd::Seeds frontier = walk_down(posed, tree, options.margin, 0.0f, SphereBounds::kWanted,
                                     state, [&](const simd::Seeds& left) {
                                       if (spent + left.nodes.count > for_spheres) {
                                         return false;
                                       }
                                       spent += left.nodes.count;
                                       return true;
                                     });

    // Slots are looked into whole, larger clusters by the slot in their middle.
    const bool is_whole = frontier.level == tree.level_count;
    const int finer = frontier.level == 0 ? tree.depth : 3 * (tree.level_count - frontier.level);
    const simd::NodeList& nodes = frontier.nodes;
    // The other of the two buffers is free again.
    QueryScratch::State::NodeBuffer& other =
        state.nodes[nodes.index == state.nodes[0].empty_list().index ? 1 : 0];
    std::uint32_t* places = rank(nodes, other.empty_list().index);
    std::uint32_t taken = 0;
    for (; taken < nodes.count; ++taken) {
      std::uint32_t& slot = nodes.index[places[taken]];
      const std::uint32_t middle = (slot << finer) + ((1u << finer) >> 1);
      const std::size_t cost = count_buckets(tree, middle);
      if (spent + cost > budget) break;
      spent += cost;
      slot = middle;
    }
    const std::uint32_t first_missed = is_whole ? taken : 0;
    if (first_missed < nodes.count) {
      result.is_exact = false;
      result.depth_bound = -nodes.bound[places[first_missed]];
    }
    std::sort(places, places + taken);
    for (std::uint32_t i = 0; i < taken; ++i) {
      nodes.index[i] = nodes.index[places[i]];
      nodes.tag[i] = nodes.tag[places[i]];
    }
    frontier.nodes.count = taken;
    simd::PointList points = state.empty_points();
    kernels.evaluate(posed, tree, frontier.nodes, options.margin, points);
    kernels.complete(posed, tree, points, state.contact_data());
    state.contact_count = keep_deepest(state.contact_data(), points.count, options.max_points);
  });
  result.contacts = scratch.contacts();
  return result;
}

}  // namespace voxshell
