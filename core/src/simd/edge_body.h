#pragma once

// Kernels about straight pieces of edges.

#include "simd/edge_formula.h"
#include "simd/search_body.h"

namespace voxshell::simd::VOXSHELL_ISA {

VOXSHELL_INLINE Triple<float> half_of(const EdgeView& edges, uint32_t id) {
  const float* half = edges.halves + 3 * static_cast<uint64_t>(id);
  return {half[0], half[1], half[2]};
}

/// Whether a place of the piece may be below the margin, by balls about places along it that
/// overlap: a second look before the search for the least place. The tag is that of a ball that
/// holds the piece.
template <class V>
VOXSHELL_INLINE bool may_touch(const PosedView<V>& posed, const EdgeView& edges,
                               const Triple<float>& middle, const Triple<float>& half, uint32_t tag,
                               float margin) {
  constexpr F8 kCenters = {-0.875f, -0.625f, -0.375f, -0.125f, 0.125f, 0.375f, 0.625f, 0.875f};
  constexpr float kFraction = 0.1251f;
  const F8 bound = bound_points(posed, place_on_edge(middle, half, kCenters), tag,
                                kFraction * edges.reach, margin);
  return lanes_below(bound, margin) != 0;
}

/// Distances of eight places in a tagged ball. Those by its plane are exact below the margin.
template <class V>
VOXSHELL_INLINE F8 measure_places(const PosedView<V>& posed, const Triple<F8>& p, uint32_t tag,
                                  float margin) {
  if (tag != 0) {
    const F8 distance = tagged_distance(posed, p, tag, margin);
    if (all(distance < margin)) return distance;
  }
  return posed_distance(posed, p);
}

/// The same, if a place within `reach` of them may be below the limit, which is no larger than the
/// margin.
struct MeasuredPlaces {
  F8 distance;
  bool may_be_below;
};
template <class V>
VOXSHELL_INLINE MeasuredPlaces measure_near_places(const PosedView<V>& posed, const Triple<F8>& p,
                                                   uint32_t tag, float reach, float limit,
                                                   float margin) {
  if (lanes_below(bound_points(posed, p, tag, reach, limit), limit) == 0) return {F8{}, false};
  return {measure_places(posed, p, tag, margin), true};
}
/// In a grid, the values of the corners bound the distances and give them, so one read serves both.
template <class G>
  requires kIsGrid<G>
VOXSHELL_INLINE MeasuredPlaces measure_near_places(const PosedView<G>& posed, const Triple<F8>& p,
                                                   uint32_t tag, float reach, float limit,
                                                   float margin) {
  if (tag != 0) {
    if (lanes_below(bound_points(posed, p, tag, reach, limit), limit) == 0) return {F8{}, false};
    return {measure_places(posed, p, tag, margin), true};
  }
  const auto found =
      evaluate_with_bound(posed.field, to_field(posed, p), splat<F8>(reach + posed.slack),
                          find_coarsest(posed.field, limit + posed.slack));
  return {found.distance, lanes_below(found.bound - posed.slack, limit) != 0};
}

/// Eight searches at a time: each round waits for the one before, but not for those of others.
class EdgeSearches {
 public:
  int count() const { return count_; }
  bool is_full() const { return count_ == kLanes; }
  /// Begins a search, unless no place of the piece is below the limit, which is no larger than the
  /// margin. The places of its first round are in the middle of balls that hold the piece. The tag
  /// is that of a ball that holds the piece, too.
  template <class V>
  VOXSHELL_INLINE bool begin(const PosedView<V>& posed, const EdgeView& edges,
                             const Triple<float>& middle, const Triple<float>& half, uint32_t tag,
                             float limit, float margin) {
    constexpr float kFraction = 0.1429f;
    const MeasuredPlaces first =
        measure_near_places(posed, place_on_edge(middle, half, kEdgeSamples), tag,
                            kFraction * edges.reach, limit, margin);
    if (!first.may_be_below) return false;
    EdgeSearch search{middle, half};
    search.take(kEdgeSamples, first.distance, edges.tie);
    tags_[count_] = tag;
    searches_[count_++] = search;
    return true;
  }

  /// Ends them all. The best places of those that were added, and their distances; other lanes
  /// repeat the first.
  template <class V>
  VOXSHELL_INLINE Triple<F8> finish(const PosedView<V>& posed, float tie, float margin,
                                    F8& distance) {
    bool have_one_tag = true;
    for (int i = 1; i < count_; ++i) have_one_tag = have_one_tag && tags_[i] == tags_[0];
    for (int round = 1; round < EdgeSearch::kRounds; ++round) {
      for (int i = 0; i < count_; ++i) {
        searches_[i].go_on(
            tie, [&](const Triple<F8>& p) { return measure_places(posed, p, tags_[i], margin); });
      }
    }
    Triple<F8> p{};
    for (int i = 0; i < kLanes; ++i) {
      const EdgeSearch& search = searches_[i < count_ ? i : 0];
      const Triple<float> place = place_on_edge(search.middle, search.half, search.place);
      set_lane(p, i, place);
    }
    count_ = 0;
    distance = measure_places(posed, p, have_one_tag ? tags_[0] : 0, margin);
    return p;
  }

 private:
  EdgeSearch searches_[kLanes];
  uint32_t tags_[kLanes];
  int count_ = 0;
};

template <class V>
void refine_edges(const PosedView<V>& posed, const EdgeView& edges, const PointList& pieces,
                  float margin, PointList& out) {
  uint32_t count = out.count;
  EdgeSearches searches;
  I8 ids{};
  const auto finish = [&] {
    const int found = searches.count();
    if (found == 0) return;
    F8 distance;
    const Triple<F8> p = searches.finish(posed, edges.tie, margin, distance);
    const unsigned lanes = bits(distance < margin) & ((1u << found) - 1);
    compress(out.id + count, ids, lanes);
    const I8 tags{};
    memcpy(out.tag + count, &tags, sizeof tags);
    compress(out.distance + count, distance, lanes);
    compress(out.x + count, p.x, lanes);
    compress(out.y + count, p.y, lanes);
    compress(out.z + count, p.z, lanes);
    count += static_cast<uint32_t>(__builtin_popcount(lanes));
  };
  for (uint32_t i = 0; i < pieces.count; ++i) {
    const Triple<float> middle{pieces.x[i], pieces.y[i], pieces.z[i]};
    const Triple<float> half = half_of(edges, pieces.id[i]);
    set_lane(ids, searches.count(), static_cast<int32_t>(pieces.id[i]));
    searches.begin(posed, edges, middle, half, pieces.tag[i], margin, margin);
    if (searches.is_full()) finish();
  }
  finish();
  out.count = count;
}

/// The most promising piece of each group is searched first: most of the others cannot be deeper.
template <class V>
void find_deepest_edges(const PosedView<V>& posed, const EdgeView& edges, const PointList& pieces,
                        const uint32_t* group_ends, uint32_t group_count, float margin,
                        FoundPoint* best) {
  EdgeSearches searches;
  uint32_t groups[kLanes];
  uint32_t ids[kLanes];
  const auto limit = [&](uint32_t group) {
    return best[group].id == kNone ? margin : best[group].distance;
  };
  const auto finish = [&] {
    const int found = searches.count();
    if (found == 0) return;
    F8 distance;
    const Triple<F8> p = searches.finish(posed, edges.tie, margin, distance);
    for (int i = 0; i < found; ++i) {
      FoundPoint& known = best[groups[i]];
      const float d = distance[i];
      const bool is_deeper = known.id == kNone
                                 ? d < margin
                                 : d < known.distance || (d == known.distance && ids[i] < known.id);
      if (is_deeper) known = make_found(ids[i], d, p, i);
    }
  };
  const auto search = [&](uint32_t group, uint32_t i) {
    const Triple<float> middle{pieces.x[i], pieces.y[i], pieces.z[i]};
    const Triple<float> half = half_of(edges, pieces.id[i]);
    const float reach = limit(group) + posed.slack;
    groups[searches.count()] = group;
    ids[searches.count()] = pieces.id[i];
    searches.begin(posed, edges, middle, half, pieces.tag[i], reach < margin ? reach : margin,
                   margin);
    if (searches.is_full()) finish();
  };
  const auto first_of = [&](uint32_t group) { return group == 0 ? 0 : group_ends[group - 1]; };
  const auto most_promising = [&](uint32_t group) {
    uint32_t least = first_of(group);
    for (uint32_t i = least + 1; i < group_ends[group]; ++i) {
      if (pieces.distance[i] < pieces.distance[least]) least = i;
    }
    return least;
  };
  for (uint32_t group = 0; group < group_count; ++group) {
    best[group].id = kNone;
    search(group, most_promising(group));
  }
  finish();
  for (uint32_t group = 0; group < group_count; ++group) {
    const uint32_t searched = most_promising(group);
    for (uint32_t i = first_of(group); i < group_ends[group]; ++i) {
      if (i != searched && pieces.distance[i] <= limit(group)) search(group, i);
    }
  }
  finish();
}

/// Walks the tree of edges, the most promising spheres first, and calls `visit(id, place,
/// distance)` with the best place of each piece that may lie below `limit()`, or at it, until it
/// returns false. The limit may fall from `margin` on.
template <class V, class Limit, class Visit>
VOXSHELL_INLINE void visit_edges(const PosedView<V>& posed, const EdgeView& edges, float margin,
                                 const Limit& limit, const Visit& visit) {
  const TreeView& tree = edges.tree;
  // A shorter reach than the margin lets planes serve, and large cells be left out.
  const auto find_reach = [&] {
    const float reach = limit() + posed.slack;
    return reach < margin ? reach : margin;
  };
  BestFirst walk({-kFarthest, 0, 0, 0});
  while (!walk.is_done()) {
    const Waiting node = walk.take();
    if (node.rank > limit()) continue;
    if (node.level < tree.level_count) {
      const Block block = load_block(tree, node.level, node.index, edges.reach);
      const Balls balls = test_balls(posed, block, node.tag, find_reach());
      walk.begin_siblings();
      for (unsigned lanes = balls.lanes; lanes != 0; lanes &= lanes - 1) {
        const int lane = __builtin_ctz(lanes);
        walk.push({balls.bound[lane], node.index * kLanes + static_cast<uint32_t>(lane),
                   static_cast<uint32_t>(balls.tags[lane]), node.level + 1});
      }
      continue;
    }
    const uint32_t end = first_bucket(tree, node.index + 1);
    for (uint32_t bucket = first_bucket(tree, node.index); bucket < end; ++bucket) {
      const Triple<F8> middles = load_triple(bucket_of(tree, bucket));
      const F8 bound = bound_points(posed, middles, node.tag, edges.reach, find_reach());
      for (unsigned lanes = lanes_below(bound, margin) & bits(middles.x == middles.x); lanes != 0;
           lanes &= lanes - 1) {
        const int lane = __builtin_ctz(lanes);
        if (bound[lane] > limit()) continue;
        const uint32_t id = bucket * kLanes + static_cast<uint32_t>(lane);
        const Triple<float> middle{middles.x[lane], middles.y[lane], middles.z[lane]};
        const Triple<float> half = half_of(edges, id);
        if (!may_touch(posed, edges, middle, half, node.tag, find_reach())) continue;
        const float t = find_place_on_edge(posed, middle, half, edges.tie);
        const Triple<float> place = place_on_edge(middle, half, t);
        const Triple<F8> p{splat<F8>(place.x), splat<F8>(place.y), splat<F8>(place.z)};
        if (!visit(id, p, posed_distance(posed, p)[0])) return;
      }
    }
  }
}

template <class V>
bool find_any_edge(const PosedView<V>& posed, const EdgeView& edges, float margin) {
  bool is_found = false;
  visit_edges(
      posed, edges, margin, [&] { return margin; },
      [&](uint32_t, const Triple<F8>&, float distance) {
        is_found = distance < margin;
        return !is_found;
      });
  return is_found;
}

template <class V>
FoundPoint find_deepest_edge(const PosedView<V>& posed, const EdgeView& edges, float margin) {
  FoundPoint best{kNone, 0.0f, {}};
  visit_edges(
      posed, edges, margin, [&] { return best.id == kNone ? margin : best.distance; },
      [&](uint32_t id, const Triple<F8>& p, float distance) {
        const bool is_deeper = best.id == kNone ? distance < margin
                                                : distance < best.distance ||
                                                      (distance == best.distance && id < best.id);
        if (is_deeper) best = make_found(id, distance, p, 0);
        return true;
      });
  return best;
}

}  // namespace voxshell::simd::VOXSHELL_ISA
