#pragma once

#include <cstdint>
#include <span>

#include "query/posed.h"
#include "query/scratch.h"
#include "query/walk.h"
#include "simd/edge_view.h"

namespace voxshell {

/// Lists the pieces of edges that may have a place below the margin after a motion of no more than
/// `growth`, and that arrive. A piece is a ball of `reach` about its middle.
template <class V>
simd::PointList list_pieces(const simd::PosedView<V>& posed, const simd::EdgeView& edges,
                            float margin, float growth, QueryScratch::State& state,
                            const simd::Arrivals<V>& arrivals = {}) {
  const float reach = edges.reach + growth;
  const simd::NodeList slots =
      walk_down(posed, edges.tree, margin, reach, SphereBounds::kUnwanted, state,
                [&](simd::Seeds& left) {
                  keep_arriving(arrivals, edges.tree, reach, left);
                  return true;
                })
          .nodes;
  const auto& kernels = simd::query_kernels<V>(simd::active_isa());
  simd::PointList pieces = state.empty_survivors();
  kernels.sift(posed, edges.tree, slots, margin, reach, pieces);
  if (arrivals.count > 0) kernels.keep_arriving_points(arrivals, reach, pieces);
  return pieces;
}

/// Lists the places of edges that are contacts below the margin, by the ids of their pieces. They
/// lie in the part of the scratch that is for edges.
template <class V>
simd::PointList find_on_edges(const simd::PosedView<V>& posed, const simd::EdgeView& edges,
                              float margin, QueryScratch::State& state) {
  state.reserve(edges.tree);
  const simd::PointList pieces = list_pieces(posed, edges, margin, 0.0f, state);
  simd::PointList found = state.empty_points();
  simd::query_kernels<V>(simd::active_isa()).refine_edges(posed, edges, pieces, margin, found);
  return found;
}

/// Appends places on edges to contacts as elements of their shell, and counts these.
template <class V>
void complete_on_edges(const simd::PosedView<V>& posed, const simd::EdgeView& edges,
                       const simd::PointList& found, std::size_t point_count,
                       QueryScratch::State& state) {
  Contact* contacts = state.contact_data() + state.lists().contact_count;
  simd::query_kernels<V>(simd::active_isa()).complete(posed, edges.tree, found, contacts);
  for (Contact& contact : std::span(contacts, found.count)) {
    contact.id += static_cast<std::uint32_t>(point_count);
  }
  state.lists().contact_count += found.count;
}

}  // namespace voxshell
