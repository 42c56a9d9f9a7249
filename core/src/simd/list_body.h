#pragma once

// Kernels that go through lists of spheres or points, one after another.

#include <type_traits>

#include "simd/tree_formula.h"

namespace voxshell::simd::VOXSHELL_ISA {

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
  if constexpr (kIsGrid<V>) {
    if (out.bound == nullptr && is_decided_by_size(posed.field, margin + posed.slack)) {
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

template <class V>
void keep_arriving_spheres(const Arrivals<V>& arrivals, const TreeView& tree, int level,
                           float growth, NodeList& nodes) {
  uint32_t count = 0;
  uint32_t tested = kNone;  // block
  unsigned arriving = 0;
  for (uint32_t i = 0; i < nodes.count; ++i) {
    const uint32_t index = nodes.index[i];
    if (index / kLanes != tested) {
      tested = index / kLanes;
      const Block block = load_block(tree, level, tested, growth);
      arriving = find_arriving(arrivals, block, block.lanes);
    }
    if ((arriving >> (index % kLanes) & 1u) == 0) continue;
    nodes.index[count] = index;
    nodes.tag[count] = nodes.tag[i];
    if (nodes.bound != nullptr) nodes.bound[count] = nodes.bound[i];
    ++count;
  }
  nodes.count = count;
}

/// No point that is then below the margin has a smaller distance after it has moved by up to
/// `growth`.
template <class V>
VOXSHELL_INLINE F8 bound_points(const PosedView<V>& posed, const Triple<F8>& p, uint32_t /*tag*/,
                                float growth, float /*margin*/) {
  return evaluate_lower_bound(posed.field, to_field(posed, p), splat<F8>(growth)) - posed.slack;
}
VOXSHELL_INLINE F8 bound_points(const PosedView<PlaneView>& posed, const Triple<F8>& p,
                                uint32_t /*tag*/, float growth, float /*margin*/) {
  return evaluate_distance(posed.field, p) - growth - posed.slack;
}
template <class G>
  requires kIsGrid<G>
VOXSHELL_INLINE F8 bound_points(const PosedView<G>& posed, const Triple<F8>& p, uint32_t tag,
                                float growth, float margin) {
  const Triple<F8> q = to_field(posed, p);
  // Where rounding may carry a point across the side of a brick, values are not continuous.
  const F8 radius = splat<F8>(growth + posed.slack);
  const float coarsest = find_coarsest(posed.field, margin + posed.slack);
  const F8 bound = tag == 0 ? evaluate_tight_bound(posed.field, q, radius, coarsest)
                            : distance_to_plane(posed.field, tag, q) - growth;
  return bound - posed.slack;
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

/// Writes those lanes of a bucket behind `count` points, but for their distances.
VOXSHELL_INLINE void append(uint32_t bucket, uint32_t tag, const Triple<F8>& p, unsigned lanes,
                            PointList& out, uint32_t& count) {
  compress(out.id + count, kLaneIndex + static_cast<int32_t>(bucket * kLanes), lanes);
  const I8 tags = I8{} + static_cast<int32_t>(tag);
  memcpy(out.tag + count, &tags, sizeof tags);
  compress(out.x + count, p.x, lanes);
  compress(out.y + count, p.y, lanes);
  compress(out.z + count, p.z, lanes);
  count += static_cast<uint32_t>(__builtin_popcount(lanes));
}

VOXSHELL_INLINE I8 load_tags(const uint32_t* from) {
  I8 tags;
  memcpy(&tags, from, sizeof tags);
  return tags;
}

template <class V>
void sift(const PosedView<V>& posed, const TreeView& tree, const NodeList& slots, float margin,
          float growth, PointList& out) {
  uint32_t count = 0;
  for (uint32_t i = 0; i < slots.count; ++i) {
    fetch_buckets_ahead<V>(tree, slots, i);
    const uint32_t end = first_bucket(tree, slots.index[i] + 1);
    for (uint32_t bucket = first_bucket(tree, slots.index[i]); bucket < end; ++bucket) {
      const Triple<F8> p = load_triple(bucket_of(tree, bucket));
      const F8 bound = bound_points(posed, p, slots.tag[i], growth, margin);
      const unsigned lanes = lanes_below(bound, margin) & bits(p.x == p.x);
      compress(out.distance + count, bound, lanes);
      append(bucket, slots.tag[i], p, lanes, out, count);
    }
  }
  out.count = count;
  fill_up(out);
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
      compress(out.distance + count, distance, lanes);
      append(bucket, slots.tag[i], p, lanes, out, count);
    }
  }
  out.count = count;
}

/// The lanes of eight that a list still has from its point `i` on.
VOXSHELL_INLINE unsigned lanes_of_list(const PointList& points, uint32_t i) {
  const uint32_t left = points.count - i;
  return left < kLanes ? (1u << left) - 1 : 255u;
}

/// Writes those lanes of the eight points of a list from its point `i` on, whose places are `p`,
/// behind `count` points of another or of those before `i`.
VOXSHELL_INLINE void append_listed(const PointList& from, uint32_t i, const Triple<F8>& p,
                                   const F8& distance, unsigned lanes, PointList& to,
                                   uint32_t& count) {
  const I8 ids = load_tags(from.id + i);
  const I8 tags = load_tags(from.tag + i);
  compress(to.id + count, ids, lanes);
  compress(to.tag + count, tags, lanes);
  compress(to.distance + count, distance, lanes);
  compress(to.x + count, p.x, lanes);
  compress(to.y + count, p.y, lanes);
  compress(to.z + count, p.z, lanes);
  count += static_cast<uint32_t>(__builtin_popcount(lanes));
}

template <class V>
void evaluate_sifted(const PosedView<V>& posed, const PointList& sifted, float margin,
                     PointList& out) {
  uint32_t count = out.count;
  for (uint32_t i = 0; i < sifted.count; i += kLanes) {
    const Triple<F8> p{load<F8>(sifted.x + i), load<F8>(sifted.y + i), load<F8>(sifted.z + i)};
    const I8 tags = load_tags(sifted.tag + i);
    const F8 distance = tagged_distance(posed, p, is_uniform(tags) ? sifted.tag[i] : 0, margin);
    const unsigned lanes = bits(distance < margin) & lanes_of_list(sifted, i);
    append_listed(sifted, i, p, distance, lanes, out, count);
  }
  out.count = count;
}

template <class V>
void keep_arriving_points(const Arrivals<V>& arrivals, float growth, PointList& points) {
  fill_up(points);
  uint32_t count = 0;
  for (uint32_t i = 0; i < points.count; i += kLanes) {
    const Triple<F8> p{load<F8>(points.x + i), load<F8>(points.y + i), load<F8>(points.z + i)};
    const unsigned lanes = find_arriving(arrivals, p, growth, lanes_of_list(points, i));
    append_listed(points, i, p, load<F8>(points.distance + i), lanes, points, count);
  }
  points.count = count;
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
template <class G>
  requires kIsGrid<G>
struct Normals<G> {
  explicit Normals(const PosedView<G>&) {}
  Triple<F8> find(const PosedView<G>& posed, const Triple<F8>& p, const uint32_t* tags) {
    if (tags[0] == 0 || !is_uniform(load_tags(tags))) return posed_normal(posed, p);
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
      set_lane(normal, lane, Triple<float>{-own[0], -own[1], -own[2]});
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

}  // namespace voxshell::simd::VOXSHELL_ISA
