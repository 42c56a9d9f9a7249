#pragma once

// The kernels of simd/query_kernels.h, for whatever instruction set the including source is
// compiled for.

#include <type_traits>

#include "simd/query_kernels.h"

namespace voxshell::simd::VOXSHELL_ISA {

/// Eight siblings of a tree.
struct Block {
  const float* data;
  Triple<F8> centres;
  F8 radii;        ///< grown
  float growth;    ///< by which the radii are
  unsigned lanes;  ///< those that are clusters
};

/// Eight spheres in a field.
struct Balls {
  F8 bound;  ///< no point within has a smaller distance, metres
  I8 tags;
  unsigned lanes;  ///< those that may hold a point below the margin
};

VOXSHELL_INLINE unsigned lanes_below(F8 bound, float margin) {
  return ~bits(bound >= margin) & 255u;
}

VOXSHELL_INLINE Triple<F8> load_triple(const float* from) {
  return {load<F8>(from), load<F8>(from + 8), load<F8>(from + 16)};
}

VOXSHELL_INLINE const float* block_of(const TreeView& tree, int level, uint32_t index) {
  return tree.blocks + static_cast<uint64_t>(tree.first_block[level] + index) * kClusterBlockFloats;
}

VOXSHELL_INLINE const float* bucket_of(const TreeView& tree, uint32_t bucket) {
  return tree.buckets + static_cast<uint64_t>(bucket) * kBucketFloats;
}

VOXSHELL_INLINE Block load_block(const TreeView& tree, int level, uint32_t index, float growth) {
  const float* data = block_of(tree, level, index);
  const F8 radii = load<F8>(data + 24);
  return {data, load_triple(data), radii + growth, growth, bits(radii >= 0.0f)};
}

/// How far points may lie from their sphere's centre against a unit normal: what the slab's
/// thickness and, as far as it is tilted, its width allow.
VOXSHELL_INLINE F8 bound_extent(const Block& block, const Triple<float>& normal) {
  const float* slab = block.data + kSlabFloats;
  const Triple<F8> across = load_triple(slab);
  const F8 along = across.x * splat<F8>(normal.x) + across.y * splat<F8>(normal.y) +
                   across.z * splat<F8>(normal.z);
  constexpr float kRounding = 1e-6f;
  const F8 tilt =
      square_root(maximum(1.0f - along * along, splat<F8>(0.0f)) + splat<F8>(kRounding));
  const F8 extent = absolute(along) * load<F8>(slab + 24) + tilt * block.radii + block.growth;
  return minimum(extent, block.radii);
}

template <class V>
VOXSHELL_INLINE Balls test_balls(const PosedView<V>& posed, const Block& block, uint32_t /*tag*/,
                                 float margin) {
  const F8 bound =
      evaluate_lower_bound(posed.field, to_field(posed, block.centres), block.radii) - posed.slack;
  return {bound, I8{}, lanes_below(bound, margin) & block.lanes};
}

VOXSHELL_INLINE Balls test_balls(const PosedView<PlaneView>& posed, const Block& block,
                                 uint32_t /*tag*/, float margin) {
  const float (&n)[3] = posed.field.normal;
  const F8 bound = evaluate_distance(posed.field, block.centres) -
                   bound_extent(block, {n[0], n[1], n[2]}) - posed.slack;
  return {bound, I8{}, lanes_below(bound, margin) & block.lanes};
}

VOXSHELL_INLINE const float* plane_of(const GridView& grid, uint32_t tag) {
  return grid.planes + 4 * (tag - 1);
}

VOXSHELL_INLINE F8 distance_to_plane(const GridView& grid, uint32_t tag, const Triple<F8>& p) {
  const float* plane = plane_of(grid, tag);
  return plane[0] * p.x + plane[1] * p.y + plane[2] * p.z - plane[3];
}

VOXSHELL_INLINE F8 bound_extent(const PosedView<GridView>& posed, const Block& block,
                                uint32_t tag) {
  const float* plane = plane_of(posed.field, tag);
  return bound_extent(block, to_shell(posed, Triple<float>{plane[0], plane[1], plane[2]}));
}

/// Balls that lie, as float32 places their points, where nothing but one plane is within a margin.
VOXSHELL_INLINE I8 find_tags(const GridView& grid, const GridPlace<F8>& place,
                             const GridValue<F8>& value, F8 radii, float slack, float margin) {
  if (find_planes(value.entry) == 0 || margin + slack > grid.plane_margin) return I8{};
  const I8 is_plane = (value.entry & kPlaneBit) != 0;
  const F8 same = to_float((value.entry >> kFieldShift) & kFieldMask);
  const F8 room =
      (same * static_cast<float>(kBrickCells) + find_room(place)) * grid.voxel_size - slack;
  const I8 fits = is_plane & (radii <= room) & (is_beyond(place.outside) == 0);
  return fits & (as_payload(value.entry) + 1);
}

/// What is asked of spheres: which may hold a point below the margin, or bounds to rank them by,
/// too.
enum class Test { kAgainstMargin, kWithBounds };

template <Test kTest = Test::kWithBounds>
VOXSHELL_INLINE Balls test_balls(const PosedView<GridView>& posed, const Block& block, uint32_t tag,
                                 float margin) {
  const GridView& grid = posed.field;
  const Triple<F8> p = to_field(posed, block.centres);
  if (tag != 0) {
    const F8 bound =
        distance_to_plane(grid, tag, p) - bound_extent(posed, block, tag) - posed.slack;
    return {bound, I8{} + static_cast<int32_t>(tag), lanes_below(bound, margin) & block.lanes};
  }
  const auto place = locate(grid, p);
  const auto value = evaluate_in_grid<Wanted::kDistance>(grid, p, place);
  const auto bounds = bound_ball(grid, place, value, block.radii);
  F8 bound = (kTest == Test::kAgainstMargin ? bounds.if_fine : combine(grid, bounds)) - posed.slack;
  const unsigned lanes = lanes_below(bound, margin) & block.lanes;
  const I8 tags = find_tags(grid, place, value, block.radii, posed.slack, margin);
  if (const unsigned tagged = bits(tags != 0) & lanes; tagged != 0) {
    const auto first = static_cast<uint32_t>(tags[__builtin_ctz(tagged)]);
    const F8 by_plane = value.distance - bound_extent(posed, block, first) - posed.slack;
    bound = select(tags == static_cast<int32_t>(first), maximum(bound, by_plane), bound);
  }
  return {bound, tags, lanes & lanes_below(bound, margin)};
}

/// Of points of a tagged sphere. Exact below the margin; where it is not below, neither is what is
/// told.
template <class V>
VOXSHELL_INLINE F8 tagged_distance(const PosedView<V>& posed, const Triple<F8>& p, uint32_t /*tag*/,
                                   float /*margin*/) {
  return posed_distance(posed, p);
}
VOXSHELL_INLINE F8 tagged_distance(const PosedView<GridView>& posed, const Triple<F8>& p,
                                   uint32_t tag, float margin) {
  const Triple<F8> q = to_field(posed, p);
  return tag == 0 ? evaluate_distance(posed.field, q, margin)
                  : distance_to_plane(posed.field, tag, q);
}

VOXSHELL_INLINE uint32_t first_bucket(const TreeView& tree, uint32_t slot) {
  return static_cast<uint32_t>((static_cast<uint64_t>(tree.bucket_count) * slot) >> tree.depth);
}

/// The binary depth of the spheres of a level of the walk.
VOXSHELL_INLINE int depth_of(const TreeView& tree, int level) {
  return tree.depth - 3 * (tree.level_count - 1 - level);
}

/// Asks for two lines of what a loop over a list comes to soon: samples keep processors from
/// looking that far ahead. Planes have none.
template <class V, class Find>
VOXSHELL_INLINE void fetch_ahead(const NodeList& nodes, uint32_t i, const Find& find) {
  if constexpr (!std::is_same_v<V, PlaneView>) {
    constexpr uint32_t kAhead = 2;
    constexpr int kLineFloats = 16;
    const float* from = find(nodes.index[i + kAhead < nodes.count ? i + kAhead : nodes.count - 1]);
    __builtin_prefetch(from);
    __builtin_prefetch(from + kLineFloats);
  }
}

template <class V>
VOXSHELL_INLINE void fetch_buckets_ahead(const TreeView& tree, const NodeList& slots, uint32_t i) {
  fetch_ahead<V>(slots, i,
                 [&](uint32_t slot) { return bucket_of(tree, first_bucket(tree, slot)); });
}

template <class V, class TestBalls>
VOXSHELL_INLINE void expand_by(const TreeView& tree, int level, const NodeList& nodes,
                               NodeList& out, float growth, const TestBalls& test) {
  uint32_t count = out.count;
  for (uint32_t i = 0; i < nodes.count; ++i) {
    fetch_ahead<V>(nodes, i, [&](uint32_t index) { return block_of(tree, level, index); });
    const Block block = load_block(tree, level, nodes.index[i], growth);
    const Balls balls = test(block, nodes.tag[i]);
    const unsigned lanes = balls.lanes;
    const I8 children = kLaneIndex + static_cast<int32_t>(nodes.index[i] * kLanes);
    compress(out.index + count, children, lanes);
    compress(out.tag + count, balls.tags, lanes);
    if (out.bound != nullptr) compress(out.bound + count, balls.bound, lanes);
    count += static_cast<uint32_t>(__builtin_popcount(lanes));
  }
  out.count = count;
}

template <class V>
void expand(const PosedView<V>& posed, const TreeView& tree, int level, const NodeList& nodes,
            NodeList& out, float margin, float growth) {
  if constexpr (std::is_same_v<V, GridView>) {
    if (out.bound == nullptr && is_fine_enough(posed.field, margin + posed.slack)) {
      expand_by<V>(tree, level, nodes, out, growth, [&](const Block& block, uint32_t tag) {
        return test_balls<Test::kAgainstMargin>(posed, block, tag, margin);
      });
      return;
    }
  }
  expand_by<V>(tree, level, nodes, out, growth, [&](const Block& block, uint32_t tag) {
    return test_balls(posed, block, tag, margin);
  });
}

/// No point has a smaller distance after it has moved by up to `growth`.
template <class V>
VOXSHELL_INLINE F8 bound_points(const PosedView<V>& posed, const Triple<F8>& p, uint32_t /*tag*/,
                                float growth) {
  return evaluate_lower_bound(posed.field, to_field(posed, p), splat<F8>(growth)) - posed.slack;
}
VOXSHELL_INLINE F8 bound_points(const PosedView<PlaneView>& posed, const Triple<F8>& p,
                                uint32_t /*tag*/, float growth) {
  return evaluate_distance(posed.field, p) - growth - posed.slack;
}
VOXSHELL_INLINE F8 bound_points(const PosedView<GridView>& posed, const Triple<F8>& p, uint32_t tag,
                                float growth) {
  const Triple<F8> q = to_field(posed, p);
  // Where rounding may carry a point across the side of a brick, values are not continuous.
  const F8 radius = splat<F8>(growth + posed.slack);
  const F8 bound = tag == 0 ? evaluate_lower_bound(posed.field, q, radius)
                            : distance_to_plane(posed.field, tag, q) - growth;
  return bound - posed.slack;
}

template <class V>
void sift(const PosedView<V>& posed, const TreeView& tree, NodeList& slots, float margin,
          float growth) {
  uint32_t count = 0;
  for (uint32_t i = 0; i < slots.count; ++i) {
    fetch_buckets_ahead<V>(tree, slots, i);
    const uint32_t slot = slots.index[i];
    const uint32_t tag = slots.tag[i];
    unsigned lanes = 0;
    const uint32_t end = first_bucket(tree, slot + 1);
    for (uint32_t bucket = first_bucket(tree, slot); bucket < end; ++bucket) {
      const Triple<F8> p = load_triple(bucket_of(tree, bucket));
      lanes |= lanes_below(bound_points(posed, p, tag, growth), margin);
    }
    slots.index[count] = slot;
    slots.tag[count] = tag;
    count += lanes != 0 ? 1u : 0u;
  }
  slots.count = count;
}

template <class V>
void evaluate(const PosedView<V>& posed, const TreeView& tree, const NodeList& slots, float margin,
              PointList& out) {
  uint32_t count = out.count;
  for (uint32_t i = 0; i < slots.count; ++i) {
    fetch_buckets_ahead<V>(tree, slots, i);
    const uint32_t end = first_bucket(tree, slots.index[i] + 1);
    for (uint32_t bucket = first_bucket(tree, slots.index[i]); bucket < end; ++bucket) {
      const Triple<F8> p = load_triple(bucket_of(tree, bucket));
      const F8 distance = tagged_distance(posed, p, slots.tag[i], margin);
      const unsigned lanes = bits(distance < margin);
      // To write nothing takes less than a wrong guess at whether there is something, unless
      // samples were not needed; before the first is found, guesses are right.
      const bool is_guessed = std::is_same_v<V, PlaneView> || slots.tag[i] != 0 || count == 0;
      if (is_guessed && lanes == 0) continue;
      compress(out.id + count, kLaneIndex + static_cast<int32_t>(bucket * kLanes), lanes);
      const I8 tags = I8{} + static_cast<int32_t>(slots.tag[i]);
      memcpy(out.tag + count, &tags, sizeof tags);
      compress(out.distance + count, distance, lanes);
      compress(out.x + count, p.x, lanes);
      compress(out.y + count, p.y, lanes);
      compress(out.z + count, p.z, lanes);
      count += static_cast<uint32_t>(__builtin_popcount(lanes));
    }
  }
  out.count = count;
}

/// The last eight are filled up with copies.
VOXSHELL_INLINE void fill_up(const PointList& points) {
  for (uint32_t i = points.count; i % kLanes != 0; ++i) {
    const uint32_t last = points.count - 1;
    points.id[i] = points.id[last];
    points.tag[i] = points.tag[last];
    points.distance[i] = points.distance[last];
    points.x[i] = points.x[last];
    points.y[i] = points.y[last];
    points.z[i] = points.z[last];
  }
}

template <class V>
void differentiate(const PosedView<V>& posed, const PointList& points, float step, float* x,
                   float* y, float* z) {
  fill_up(points);
  const F8 scale = splat<F8>(0.5f / step);
  for (uint32_t i = 0; i < points.count; i += kLanes) {
    const Triple<F8> p{load<F8>(points.x + i), load<F8>(points.y + i), load<F8>(points.z + i)};
    const auto difference = [&](float dx, float dy, float dz) {
      const F8 ahead = posed_distance(posed, Triple<F8>{p.x + dx, p.y + dy, p.z + dz});
      const F8 behind = posed_distance(posed, Triple<F8>{p.x - dx, p.y - dy, p.z - dz});
      return (ahead - behind) * scale;
    };
    store(x + i, difference(step, 0.0f, 0.0f));
    store(y + i, difference(0.0f, step, 0.0f));
    store(z + i, difference(0.0f, 0.0f, step));
  }
}

/// Normals of points below the margin, eight at a time. Where eight see one plane, by the field or
/// by their tags, there is one normal for as long as it is the same plane.
template <class V>
struct Normals {
  explicit Normals(const PosedView<V>&) {}
  Triple<F8> find(const PosedView<V>& posed, const Triple<F8>& p, const uint32_t*) {
    return posed_normal(posed, p);
  }
};
template <>
struct Normals<PlaneView> {
  explicit Normals(const PosedView<PlaneView>& posed) : normal(posed_normal(posed, Triple<F8>{})) {}
  Triple<F8> find(const PosedView<PlaneView>&, const Triple<F8>&, const uint32_t*) const {
    return normal;
  }
  Triple<F8> normal;
};
template <>
struct Normals<GridView> {
  explicit Normals(const PosedView<GridView>&) {}
  Triple<F8> find(const PosedView<GridView>& posed, const Triple<F8>& p, const uint32_t* tags) {
    I8 eight;
    memcpy(&eight, tags, sizeof eight);
    if (tags[0] == 0 || !is_uniform(eight)) return posed_normal(posed, p);
    if (tags[0] != tag) {
      tag = tags[0];
      const float* plane = plane_of(posed.field, tag);
      normal = normalized(to_shell(
          posed, Triple<F8>{splat<F8>(plane[0]), splat<F8>(plane[1]), splat<F8>(plane[2])}));
    }
    return normal;
  }
  uint32_t tag = 0;
  Triple<F8> normal{};
};

template <class V>
void complete(const PosedView<V>& posed, const TreeView& tree, const PointList& points,
              void* contacts) {
  fill_up(points);
  char* to = static_cast<char*>(contacts);
  Normals<V> normals(posed);
  for (uint32_t i = 0; i < points.count; i += kLanes) {
    const Triple<F8> p{load<F8>(points.x + i), load<F8>(points.y + i), load<F8>(points.z + i)};
    Triple<F8> normal = normals.find(posed, p, points.tag + i);
    const I8 is_zero = (normal.x == 0.0f) & (normal.y == 0.0f) & (normal.z == 0.0f);
    // Where the field has no gradient (a ridge inside it), the shell's own normal says which way
    // is out.
    for (unsigned lanes = bits(is_zero); lanes != 0; lanes &= lanes - 1) {
      const int lane = __builtin_ctz(lanes);
      const float* own =
          tree.normals + 3 * static_cast<uint64_t>(points.id[i + static_cast<uint32_t>(lane)]);
      normal.x[lane] = -own[0];
      normal.y[lane] = -own[1];
      normal.z[lane] = -own[2];
    }
    F8 rows[kLanes] = {load<F8>(reinterpret_cast<const float*>(points.id + i)),
                       -load<F8>(points.distance + i),
                       p.x,
                       p.y,
                       p.z,
                       normal.x,
                       normal.y,
                       normal.z};
    transpose(rows);
    const uint32_t end = points.count - i < kLanes ? points.count - i : kLanes;
    for (uint32_t lane = 0; lane < end; ++lane, to += sizeof(F8)) {
      memcpy(to, &rows[lane], sizeof(F8));
    }
  }
}

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
                  int segment_depth, float margin, FoundPoint* best) {
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
      for (unsigned lanes = bits(distance <= most); lanes != 0; lanes &= lanes - 1) {
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
      for (unsigned lanes = balls.lanes; lanes != 0; lanes &= lanes - 1) {
        const int lane = __builtin_ctz(lanes);
        const uint32_t child = node.index * kLanes + static_cast<uint32_t>(lane);
        if (balls.bound[lane] > limit(node.level, child)) continue;
        walk.push(
            {balls.bound[lane], child, static_cast<uint32_t>(balls.tags[lane]), node.level + 1});
      }
    }
  });
}

template <class V>
bool find_any(const PosedView<V>& posed, const TreeView& tree, float margin) {
  BestFirst walk({-kFarthest, 0, 0, 0});
  while (!walk.is_done()) {
    const Waiting node = walk.take();
    if (node.level < tree.level_count) {
      const Block block = load_block(tree, node.level, node.index, 0.0f);
      const Balls balls = test_balls(posed, block, node.tag, margin);
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
  F8 evaluate_upper_bound(const Triple<F8>& centres, F8 radii) const {
    constexpr float kRounding = 1.0001f;
    if (search_.count == 3) {
      const F8 away = length(minus(centres, search_.chosen[0]));
      return evaluate(centres) + steepness_ * (radii * kRounding + away * (kRounding - 1.0f));
    }
    const F8 grown =
        square_root(evaluate(centres)) + radii * (search_.count == 1 ? 1.0f : side_length_);
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
    Triple<F8> centres{};
    F8 radii{};
    for (uint32_t lane = 0; lane < kLanes && i + lane < seeds.nodes.count; ++lane) {
      const uint32_t index = seeds.nodes.index[i + lane];
      const Block block = load_block(tree, seeds.level - 1, index / kLanes, 0.0f);
      const float* sphere = block.data + index % kLanes;
      centres.x[lane] = sphere[0];
      centres.y[lane] = sphere[8];
      centres.z[lane] = sphere[16];
      radii[lane] = sphere[24];
    }
    store(ranks + i, -score.evaluate_upper_bound(centres, radii));
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
      const F8 most = score.evaluate_upper_bound(block.centres, block.radii);
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
  return best;
}

template <class V>
inline constexpr QueryKernels<V> kQueryKernels = {&expand<V>,   &sift<V>,          &evaluate<V>,
                                                  &complete<V>, &differentiate<V>, &find_deepest<V>,
                                                  &find_any<V>, &find_widest<V>,   &choose_widest};

}  // namespace voxshell::simd::VOXSHELL_ISA
