#include <algorithm>
#include <limits>
#include <numeric>

#include "query/deepest.h"
#include "query/edge_search.h"
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

/// A part of the budget.
struct Account {
  std::size_t spent = 0;
  std::size_t budget;

  bool can_pay(std::size_t cost) const { return spent + cost <= budget; }
};

/// Walks down one tree for half of what is left of the budget, spheres grown by `growth`, and looks
/// into slots, those that may be deepest first. `look_into` gets a place in the list of slots and
/// returns false where the budget ends.
template <class V, class LookInto>
simd::NodeList look_into_deepest(const simd::PosedView<V>& posed, const simd::TreeView& tree,
                                 float margin, float growth, Account& account,
                                 QueryScratch::State& state, BudgetedContacts& result,
                                 const LookInto& look_into) {
  const std::size_t for_spheres = account.spent + (account.budget - account.spent + 1) / 2;
  simd::Seeds frontier = walk_down(posed, tree, margin, growth, SphereBounds::kWanted, state,
                                   [&](const simd::Seeds& left) {
                                     if (account.spent + left.nodes.count > for_spheres)
                                       return false;
                                     account.spent += left.nodes.count;
                                     return true;
                                   });

  // Slots are looked into whole, larger clusters by the slot in their middle.
  const bool is_whole = frontier.level == tree.level_count;
  const int finer = frontier.level == 0 ? tree.depth : 3 * (tree.level_count - frontier.level);
  const simd::NodeList& nodes = frontier.nodes;
  // The other of the two buffers is free again.
  QueryLists::State::NodeBuffer& other =
      state.lists().nodes[nodes.index == state.lists().nodes[0].empty_list().index ? 1 : 0];
  std::uint32_t* places = rank(nodes, other.empty_list().index);
  std::uint32_t taken = 0;
  for (; taken < nodes.count; ++taken) {
    std::uint32_t& slot = nodes.index[places[taken]];
    const std::uint32_t wide = slot;
    slot = (slot << finer) + ((1u << finer) >> 1);
    if (!look_into(nodes, places[taken])) {
      slot = wide;
      break;
    }
  }
  const std::uint32_t first_missed = is_whole ? taken : 0;
  if (first_missed < nodes.count) {
    result.is_exact = false;
    result.depth_bound = std::max(result.depth_bound, -nodes.bound[places[first_missed]]);
  }
  std::sort(places, places + taken);
  for (std::uint32_t i = 0; i < taken; ++i) {
    nodes.index[i] = nodes.index[places[i]];
    nodes.tag[i] = nodes.tag[places[i]];
  }
  frontier.nodes.count = taken;
  return frontier.nodes;
}

}  // namespace

BudgetedContacts find_contacts_within_budget(const Field& field, const PointShell& shell,
                                             const Pose& field_from_shell,
                                             const ContactOptions& options, std::size_t budget,
                                             QueryScratch& scratch) {
  QueryScratch::State& state = scratch.state();
  const simd::TreeView tree = view_tree(shell);
  const EdgeSegments* edges = shell.edges();
  state.reserve(tree, shell.element_count() - shell.size());
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  BudgetedContacts result{{}, true, -kInfinity};
  with_posed(field, shell, field_from_shell, [&]<class V>(const simd::PosedView<V>& posed) {
    const auto& kernels = simd::query_kernels<V>(simd::active_isa());
    // Points that leave some of their half to spare leave it to edges.
    Account account{.budget = edges == nullptr ? budget : (budget + 1) / 2};
    const simd::NodeList slots =
        look_into_deepest(posed, tree, options.margin, 0.0f, account, state, result,
                          [&](const simd::NodeList& nodes, std::uint32_t at) {
                            const std::size_t cost = count_buckets(tree, nodes.index[at]);
                            if (!account.can_pay(cost)) return false;
                            account.spent += cost;
                            return true;
                          });
    simd::PointList points = state.empty_points();
    kernels.evaluate(posed, tree, slots, options.margin, points);
    kernels.complete(posed, tree, points, state.contact_data());
    state.lists().contact_count = points.count;
    if (edges == nullptr) return;

    account.budget = budget;
    const simd::EdgeView view = edges->view();
    QueryScratch::State& of_edges = state.of_edges();
    of_edges.reserve(view.tree);
    const simd::NodeList edge_slots =
        look_into_deepest(posed, view.tree, options.margin, view.reach, account, of_edges, result,
                          [&](const simd::NodeList& nodes, std::uint32_t at) {
                            const std::size_t cost = count_buckets(view.tree, nodes.index[at]);
                            if (!account.can_pay(cost)) return false;
                            account.spent += cost;
                            // The search for the least place of each piece is what takes the time.
                            simd::PointList pieces = of_edges.empty_survivors();
                            const simd::NodeList one{nodes.index + at, nodes.tag + at, nullptr, 1};
                            kernels.sift(posed, view.tree, one, options.margin, view.reach, pieces);
                            constexpr std::size_t kNodesAPiece = 4;
                            if (!account.can_pay(kNodesAPiece * pieces.count)) return false;
                            account.spent += kNodesAPiece * pieces.count;
                            return true;
                          });
    simd::PointList pieces = of_edges.empty_survivors();
    kernels.sift(posed, view.tree, edge_slots, options.margin, view.reach, pieces);
    simd::PointList found = of_edges.empty_points();
    kernels.refine_edges(posed, view, pieces, options.margin, found);
    complete_on_edges(posed, view, found, shell.size(), state);
  });
  state.lists().contact_count =
      keep_deepest(state.contact_data(), state.lists().contact_count, options.max_points);
  result.contacts = scratch.contacts();
  return result;
}

}  // namespace voxshell
