#pragma once

// Tests of a tree's spheres and points in a field by queries, eight at a time.

#include "simd/query_kernels.h"

namespace voxshell::simd::VOXSHELL_ISA {

/// Eight siblings of a tree.
struct Block {
  const float* data;
  Triple<F8> centers;
  F8 radii;        ///< grown
  float growth;    ///< by which the radii are
  unsigned lanes;  ///< those that are clusters
};

/// Eight spheres in a field.
struct Balls {
  F8 bound;  ///< no point within has a smaller distance, meters
  I8 tags;
  unsigned lanes;  ///< those that may hold a point below the margin
  unsigned full;   ///< some of those that hold no other points
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

/// How far points may lie from their sphere's center against a unit normal: what the slab's
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
  requires(!kIsGrid<V>)
VOXSHELL_INLINE Balls test_balls(const PosedView<V>& posed, const Block& block, uint32_t /*tag*/,
                                 float margin) {
  const F8 bound =
      evaluate_lower_bound(posed.field, to_field(posed, block.centers), block.radii) - posed.slack;
  return {bound, I8{}, lanes_below(bound, margin) & block.lanes, 0};
}

VOXSHELL_INLINE Balls test_balls(const PosedView<PlaneView>& posed, const Block& block,
                                 uint32_t /*tag*/, float margin) {
  const float (&n)[3] = posed.field.normal;
  const F8 bound = evaluate_distance(posed.field, block.centers) -
                   bound_extent(block, {n[0], n[1], n[2]}) - posed.slack;
  return {bound, I8{}, lanes_below(bound, margin) & block.lanes, 0};
}

VOXSHELL_INLINE const float* plane_of(const GridView& grid, uint32_t tag) {
  return grid.planes + 4 * (tag - 1);
}

VOXSHELL_INLINE F8 distance_to_plane(const GridView& grid, uint32_t tag, const Triple<F8>& p) {
  const float* plane = plane_of(grid, tag);
  return plane[0] * p.x + plane[1] * p.y + plane[2] * p.z - plane[3];
}

template <class G>
  requires kIsGrid<G>
VOXSHELL_INLINE F8 bound_extent(const PosedView<G>& posed, const Block& block, uint32_t tag) {
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

/// The test of spheres: which may hold a point below the margin, or also bounds to rank them by.
enum class Test { kAgainstMargin, kWithBounds };

template <Test kTest = Test::kWithBounds, class G>
  requires kIsGrid<G>
VOXSHELL_INLINE Balls test_balls(const PosedView<G>& posed, const Block& block, uint32_t tag,
                                 float margin) {
  const G& grid = posed.field;
  const Triple<F8> p = to_field(posed, block.centers);
  if (tag != 0) {
    const F8 distance = distance_to_plane(grid, tag, p);
    const F8 reach = bound_extent(posed, block, tag) + posed.slack;
    const F8 bound = distance - reach;
    return {bound, I8{} + static_cast<int32_t>(tag), lanes_below(bound, margin) & block.lanes,
            bits(distance + reach < margin) & block.lanes};
  }
  const auto place = locate(grid, p);
  // Bounds hold from samples, too, and exact cells would take longer.
  const auto value = evaluate_samples<Wanted::kDistance>(grid, p, place);
  const auto bounds =
      bound_ball(grid, place, value, block.radii, find_coarsest(grid, margin + posed.slack));
  F8 bound =
      (kTest == Test::kAgainstMargin ? bounds.up_to_size : combine(grid, bounds)) - posed.slack;
  const unsigned lanes = lanes_below(bound, margin) & block.lanes;
  const I8 tags = find_tags(grid, place, value, block.radii, posed.slack, margin);
  if (const unsigned tagged = bits(tags != 0) & lanes; tagged != 0) {
    const auto first = static_cast<uint32_t>(tags[__builtin_ctz(tagged)]);
    const F8 by_plane = value.distance - bound_extent(posed, block, first) - posed.slack;
    bound = select(tags == static_cast<int32_t>(first), maximum(bound, by_plane), bound);
  }
  const I8 full =
      (bounds.from_above + posed.slack < margin) & is_in_grid(grid, p, block.radii + posed.slack);
  return {bound, tags, lanes & lanes_below(bound, margin), bits(full) & block.lanes};
}

/// Of points of a tagged sphere. Exact below the margin; where it is not below, neither is what is
/// told.
template <class V>
VOXSHELL_INLINE F8 tagged_distance(const PosedView<V>& posed, const Triple<F8>& p, uint32_t /*tag*/,
                                   float /*margin*/) {
  return posed_distance(posed, p);
}
template <class G>
  requires kIsGrid<G>
VOXSHELL_INLINE F8 tagged_distance(const PosedView<G>& posed, const Triple<F8>& p, uint32_t tag,
                                   float margin) {
  const Triple<F8> q = to_field(posed, p);
  return tag == 0 ? evaluate_distance(posed.field, q, margin)
                  : distance_to_plane(posed.field, tag, q);
}

/// Those of `lanes` whose spheres may hold a point that arrives.
template <class V>
VOXSHELL_INLINE unsigned find_arriving(const Arrivals<V>& arrivals, const Block& block,
                                       unsigned lanes) {
  if (arrivals.count == 0) return lanes;
  unsigned arriving = 0;
  for (uint32_t i = 0; i < arrivals.count && arriving != lanes; ++i) {
    arriving |= test_balls(arrivals.posed[i], block, 0, arrivals.margins[i]).lanes & lanes;
  }
  return arriving;
}

/// Those of `lanes` whose points arrive within `growth` of the margins.
template <class V>
VOXSHELL_INLINE unsigned find_arriving(const Arrivals<V>& arrivals, const Triple<F8>& p,
                                       float growth, unsigned lanes) {
  if (arrivals.count == 0) return lanes;
  unsigned arriving = 0;
  for (uint32_t i = 0; i < arrivals.count && arriving != lanes; ++i) {
    const float margin = arrivals.margins[i] + growth;
    arriving |= bits(tagged_distance(arrivals.posed[i], p, 0, margin) < margin) & lanes;
  }
  return arriving;
}

VOXSHELL_INLINE uint32_t first_bucket(const TreeView& tree, uint32_t slot) {
  return static_cast<uint32_t>((static_cast<uint64_t>(tree.bucket_count) * slot) >> tree.depth);
}

/// The binary depth of the spheres of a level of the walk.
VOXSHELL_INLINE int depth_of(const TreeView& tree, int level) {
  return tree.depth - 3 * (tree.level_count - 1 - level);
}

}  // namespace voxshell::simd::VOXSHELL_ISA
