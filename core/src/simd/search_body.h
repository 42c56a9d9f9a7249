#pragma once

// Kernels that look for single points, the most promising spheres first.

#include "simd/list_body.h"

namespace voxshell::simd::VOXSHELL_ISA {

inline constexpr float kFarthest = 1e30f;

/// One sphere that waits to be looked into.
struct Waiting {
  float rank;  ///< the smaller, the sooner
  uint32_t index;
  uint32_t tag;
  int32_t level;  ///< of its children
};

/// A walk below one sphere that takes the most promising of siblings first.
class BestFirst {
 public:
  explicit BestFirst(const Waiting& top) { stack_[0] = top; }

  bool is_done() const { return count_ == 0; }
  Waiting take() { return stack_[--count_]; }

  /// Of siblings pushed one after another, take() returns the smallest rank first.
  void begin_siblings() { first_sibling_ = count_; }
  void push(const Waiting& sibling) {
    int at = count_++;
    for (; at > first_sibling_ && stack_[at - 1].rank < sibling.rank; --at) {
      stack_[at] = stack_[at - 1];
    }
    stack_[at] = sibling;
  }

 private:
  Waiting stack_[kMostWalkLevels * kLanes + 1];
  int count_ = 1;
  int first_sibling_ = 0;
};

/// Calls `search` with each seed, the one of the smallest rank first: what it finds lets others be
/// passed by.
template <class Search>
VOXSHELL_INLINE void for_each_seed(const Seeds& seeds, const float* ranks, const Search& search) {
  if (seeds.nodes.count == 0) return;
  uint32_t first = 0;
  for (uint32_t i = 1; i < seeds.nodes.count; ++i) {
    if (ranks[i] < ranks[first]) first = i;
  }
  const auto start = [&](uint32_t i) {
    search(Waiting{ranks[i], seeds.nodes.index[i], seeds.nodes.tag[i], seeds.level});
  };
  start(first);
  for (uint32_t i = 0; i < seeds.nodes.count; ++i) {
    if (i != first) start(i);
  }
}

VOXSHELL_INLINE FoundPoint make_found(uint32_t id, float distance, const Triple<F8>& p, int lane) {
  return {id, distance, {p.x[lane], p.y[lane], p.z[lane]}};
}

template <class V>
void find_deepest(const PosedView<V>& posed, const TreeView& tree, const Seeds& seeds,
                  int segment_depth, float margin, const Arrivals<V>& arrivals, FoundPoint* best) {
  // The best so far of the one segment that a sphere lies in; larger spheres may hold any.
  const auto limit = [&](int level, uint32_t index) {
    const int finer = depth_of(tree, level) - segment_depth;
    if (finer < 0) return margin;
    const FoundPoint& found = best[index >> finer];
    return found.id == kNone ? margin : found.distance;
  };
  const auto look_into_slot = [&](uint32_t slot, uint32_t tag) {
    FoundPoint& found = best[slot >> (tree.depth - segment_depth)];
    const uint32_t end = first_bucket(tree, slot + 1);
    for (uint32_t bucket = first_bucket(tree, slot); bucket < end; ++bucket) {
      const Triple<F8> p = load_triple(bucket_of(tree, bucket));
      const F8 distance = tagged_distance(posed, p, tag, margin);
      const float most = found.id == kNone ? margin : found.distance;
      unsigned lanes = bits(distance <= most);
      if (lanes != 0) lanes = find_arriving(arrivals, p, 0.0f, lanes);
      for (; lanes != 0; lanes &= lanes - 1) {
        const int lane = __builtin_ctz(lanes);
        const uint32_t id = bucket * kLanes + static_cast<uint32_t>(lane);
        const float d = distance[lane];
        const bool is_deeper = found.id == kNone
                                   ? d < margin
                                   : d < found.distance || (d == found.distance && id < found.id);
        if (is_deeper) found = make_found(id, d, p, lane);
      }
    }
  };
  for_each_seed(seeds, seeds.nodes.bound, [&](const Waiting& seed) {
    BestFirst walk(seed);
    while (!walk.is_done()) {
      const Waiting node = walk.take();
      if (node.level > 0 && node.rank > limit(node.level - 1, node.index)) continue;
      if (node.level == tree.level_count) {
        look_into_slot(node.index, node.tag);
        continue;
      }
      const Block block = load_block(tree, node.level, node.index, 0.0f);
      // A shorter reach than the margin lets planes serve.
      const float reach = node.level > 0 ? limit(node.level - 1, node.index) + posed.slack : margin;
      const Balls balls = test_balls(posed, block, node.tag, reach < margin ? reach : margin);
      walk.begin_siblings();
      unsigned lanes = balls.lanes;
      if (lanes != 0) lanes = find_arriving(arrivals, block, lanes);
      for (; lanes != 0; lanes &= lanes - 1) {
        const int lane = __builtin_ctz(lanes);
        const uint32_t child = node.index * kLanes + static_cast<uint32_t>(lane);
        if (balls.bound[lane] > limit(node.level, child)) continue;
        walk.push(
            {balls.bound[lane], child, static_cast<uint32_t>(balls.tags[lane]), node.level + 1});
      }
    }
  });
}

template <class V, class TestBalls>
VOXSHELL_INLINE bool find_any_by(const PosedView<V>& posed, const TreeView& tree, float margin,
                                 const TestBalls& test) {
  BestFirst walk({-kFarthest, 0, 0, 0});
  while (!walk.is_done()) {
    const Waiting node = walk.take();
    if (node.level < tree.level_count) {
      const Block block = load_block(tree, node.level, node.index, 0.0f);
      const Balls balls = test(block, node.tag);
      if (balls.full != 0) return true;
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
      const Triple<F8> p = load_triple(bucket_of(tree, bucket));
      if (any(tagged_distance(posed, p, node.tag, margin) < margin)) return true;
    }
  }
  return false;
}

template <class V>
bool find_any(const PosedView<V>& posed, const TreeView& tree, float margin) {
  if constexpr (kIsGrid<V>) {
    if (is_decided_by_size(posed.field, margin + posed.slack)) {
      return find_any_by(posed, tree, margin, [&](const Block& block, uint32_t tag) {
        return test_balls<Test::kAgainstMargin>(posed, block, tag, margin);
      });
    }
  }
  return find_any_by(posed, tree, margin, [&](const Block& block, uint32_t tag) {
    return test_balls(posed, block, tag, margin);
  });
}

template <class F>
VOXSHELL_INLINE Triple<F> minus(const Triple<F>& a, const float (&b)[3]) {
  return {a.x - b[0], a.y - b[1], a.z - b[2]};
}
template <class F>
VOXSHELL_INLINE Triple<F> cross(const Triple<F>& a, const Triple<F>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// How much a point adds to the extent of a manifold's chosen points: the squared distance from
/// one, four times the squared area of the triangle with two, or four times the area times that of
/// the chosen triangle beyond the side of it that gains most.
class ManifoldScore {
 public:
  explicit ManifoldScore(const ManifoldSearch& search) : search_(search) {
    if (search.count < 2) return;
    const auto& [a, b, c] = search.chosen;
    side_ = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    side_length_ = length(side_);
    if (search.count < 3) return;
    const Triple<float> other{c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    up_ = cross(side_, other);
    for (int i = 0; i < 3; ++i) {
      const auto& from = search.chosen[i];
      const auto& to = search.chosen[(i + 1) % 3];
      sides_[i] = {to[0] - from[0], to[1] - from[1], to[2] - from[2]};
      const float steepness = length(sides_[i]) * length(up_);
      steepness_ = maximum(steepness_, steepness);
    }
  }

  F8 evaluate(const Triple<F8>& p) const {
    if (search_.count == 1) {
      const Triple<F8> q = minus(p, search_.chosen[0]);
      return dot(q, q);
    }
    if (search_.count == 2) {
      const Triple<F8> area = cross(wide(side_), minus(p, search_.chosen[0]));
      return dot(area, area);
    }
    const Triple<F8> up = wide(up_);
    F8 most{};
    for (int i = 0; i < 3; ++i) {
      const F8 gain = dot(cross(minus(p, search_.chosen[i]), wide(sides_[i])), up);
      most = i == 0 ? gain : maximum(most, gain);
    }
    return most;
  }

  /// No point within the balls has a larger score.
  F8 evaluate_upper_bound(const Triple<F8>& centers, F8 radii) const {
    constexpr float kRounding = 1.0001f;
    if (search_.count == 3) {
      const F8 away = length(minus(centers, search_.chosen[0]));
      return evaluate(centers) + steepness_ * (radii * kRounding + away * (kRounding - 1.0f));
    }
    const F8 grown =
        square_root(evaluate(centers)) + radii * (search_.count == 1 ? 1.0f : side_length_);
    return grown * grown * kRounding;
  }

 private:
  static Triple<F8> wide(const Triple<float>& a) {
    return {splat<F8>(a.x), splat<F8>(a.y), splat<F8>(a.z)};
  }

  const ManifoldSearch& search_;
  Triple<float> side_{};
  float side_length_ = 0.0f;
  Triple<float> up_{};
  Triple<float> sides_[3]{};
  float steepness_ = 0.0f;
};

/// Minus the largest scores that seeds may hold, one each.
inline void rank_seeds(const TreeView& tree, const Seeds& seeds, const ManifoldScore& score,
                       float* ranks) {
  if (seeds.level == 0) {
    ranks[0] = -kFarthest;
    return;
  }
  for (uint32_t i = 0; i < seeds.nodes.count; i += kLanes) {
    Triple<F8> centers{};
    F8 radii{};
    for (uint32_t lane = 0; lane < kLanes && i + lane < seeds.nodes.count; ++lane) {
      const uint32_t index = seeds.nodes.index[i + lane];
      const Block block = load_block(tree, seeds.level - 1, index / kLanes, 0.0f);
      const float* sphere = block.data + index % kLanes;
      const int to = static_cast<int>(lane);
      set_lane(centers, to, Triple<float>{sphere[0], sphere[8], sphere[16]});
      set_lane(radii, to, sphere[24]);
    }
    store(ranks + i, -score.evaluate_upper_bound(centers, radii));
  }
}

template <class V>
FoundPoint find_widest(const PosedView<V>& posed, const TreeView& tree, const Seeds& seeds,
                       const ManifoldSearch& search, float margin) {
  const ManifoldScore score(search);
  FoundPoint best{kNone, 0.0f, {}};
  float best_score = 0.0f;
  const auto look_into_slot = [&](uint32_t slot, uint32_t tag) {
    const uint32_t end = first_bucket(tree, slot + 1);
    for (uint32_t bucket = first_bucket(tree, slot); bucket < end; ++bucket) {
      const Triple<F8> p = load_triple(bucket_of(tree, bucket));
      const F8 scores = score.evaluate(p);
      const unsigned wide_enough = bits(scores >= best_score);
      if (wide_enough == 0) continue;
      const F8 distance = tagged_distance(posed, p, tag, margin);
      for (unsigned lanes = wide_enough & bits(distance < margin); lanes != 0; lanes &= lanes - 1) {
        const int lane = __builtin_ctz(lanes);
        const uint32_t id = bucket * kLanes + static_cast<uint32_t>(lane);
        const bool is_better = scores[lane] > best_score ||
                               (scores[lane] == best_score && best.id != kNone && id < best.id);
        if (!is_better) continue;
        best = make_found(id, distance[lane], p, lane);
        best_score = scores[lane];
      }
    }
  };
  float ranks[kMostSeeds + kLanes];
  rank_seeds(tree, seeds, score, ranks);
  for_each_seed(seeds, ranks, [&](const Waiting& seed) {
    if (-seed.rank < best_score) return;
    BestFirst walk(seed);
    while (!walk.is_done()) {
      const Waiting node = walk.take();
      if (-node.rank < best_score) continue;
      if (node.level == tree.level_count) {
        look_into_slot(node.index, node.tag);
        continue;
      }
      const Block block = load_block(tree, node.level, node.index, 0.0f);
      const F8 most = score.evaluate_upper_bound(block.centers, block.radii);
      const unsigned wide_enough = bits(most >= best_score) & block.lanes;
      if (wide_enough == 0) continue;
      const Balls balls = test_balls(posed, block, node.tag, margin);
      walk.begin_siblings();
      for (unsigned lanes = balls.lanes & wide_enough; lanes != 0; lanes &= lanes - 1) {
        const int lane = __builtin_ctz(lanes);
        walk.push({-most[lane], node.index * kLanes + static_cast<uint32_t>(lane),
                   static_cast<uint32_t>(balls.tags[lane]), node.level + 1});
      }
    }
  });
  best.score = best_score;
  return best;
}

inline FoundPoint choose_widest(const PointList& points, const ManifoldSearch& search) {
  fill_up(points);
  const ManifoldScore score(search);
  FoundPoint best{kNone, 0.0f, {}};
  float best_score = 0.0f;
  for (uint32_t i = 0; i < points.count; i += kLanes) {
    const Triple<F8> p{load<F8>(points.x + i), load<F8>(points.y + i), load<F8>(points.z + i)};
    const F8 scores = score.evaluate(p);
    for (unsigned lanes = bits(scores > best_score); lanes != 0; lanes &= lanes - 1) {
      const int lane = __builtin_ctz(lanes);
      if (!(scores[lane] > best_score)) continue;
      const uint32_t at = i + static_cast<uint32_t>(lane);
      best = make_found(points.id[at], points.distance[at], p, lane);
      best_score = scores[lane];
    }
  }
  best.score = best_score;
  return best;
}

}  // namespace voxshell::simd::VOXSHELL_ISA
