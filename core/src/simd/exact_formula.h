#pragma once

#include "simd/exact_view.h"
#include "simd/wide.h"

namespace voxshell::simd::VOXSHELL_ISA {

/// How far a point is from one triangle, or from eight, and where that triangle is nearest.
template <class F>
struct NearestOnTriangle {
  F squared_distance;
  Triple<F> offset;    ///< from the nearest place to the point
  Integer<F> feature;  ///< see kFeatureNormalFloats
};

template <class F>
VOXSHELL_INLINE Triple<F> subtract(const Triple<F>& a, const Triple<F>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

template <class F>
VOXSHELL_INLINE Triple<F> cross_product(const Triple<F>& a, const Triple<F>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// `p`, `ab`, `ac` from the corner a. A point is above the face where it is on the inner side of
/// all three edges; elsewhere the nearest edge has the nearest place.
template <class F>
VOXSHELL_INLINE NearestOnTriangle<F> find_on_triangle(const Triple<F>& p, const Triple<F>& ab,
                                                      const Triple<F>& ac,
                                                      const Triple<F>& normal) {
  const F zero = splat<F>(0.0f);
  const F one = splat<F>(1.0f);
  const Triple<F> bc = subtract(ac, ab);
  const Triple<F> bp = subtract(p, ab);
  const auto is_inside = [&](const Triple<F>& edge, const Triple<F>& from) {
    return dot(cross_product(normal, edge), from) >= zero;
  };
  const Triple<F> ca{zero - ac.x, zero - ac.y, zero - ac.z};
  const auto is_above = is_inside(ab, p) & is_inside(bc, bp) & is_inside(ca, p);
  const F height = dot(normal, p);

  NearestOnTriangle<F> nearest;
  const auto along = [&](const Triple<F>& edge, const Triple<F>& from, F& t) {
    t = minimum(maximum(dot(edge, from) / dot(edge, edge), zero), one);
    return Triple<F>{from.x - t * edge.x, from.y - t * edge.y, from.z - t * edge.z};
  };
  const auto code = [&](F t, int edge, int start, int end) {
    const Integer<F> none{};
    return select(t <= zero, none + start, select(t >= one, none + end, none + edge));
  };
  const auto take = [&](const Triple<F>& offset, Integer<F> feature, bool is_first) {
    const F squared = dot(offset, offset);
    if (is_first) {
      nearest = {squared, offset, feature};
      return;
    }
    const auto is_nearer = squared < nearest.squared_distance;
    nearest.squared_distance = select(is_nearer, squared, nearest.squared_distance);
    nearest.offset = select<F>(is_nearer, offset, nearest.offset);
    nearest.feature = select(is_nearer, feature, nearest.feature);
  };
  F t;
  const Triple<F> from_ab = along(ab, p, t);
  take(from_ab, code(t, 1, 4, 5), true);
  const Triple<F> from_bc = along(bc, bp, t);
  take(from_bc, code(t, 2, 5, 6), false);
  const Triple<F> from_ac = along(ac, p, t);
  take(from_ac, code(t, 3, 4, 6), false);

  nearest.squared_distance = select(is_above, height * height, nearest.squared_distance);
  const Triple<F> from_face{height * normal.x, height * normal.y, height * normal.z};
  nearest.offset = select<F>(is_above, from_face, nearest.offset);
  nearest.feature = select(is_above, Integer<F>{}, nearest.feature);
  return nearest;
}

/// Signed distance and gradient.
struct ExactValue {
  float distance;
  Triple<float> gradient;  ///< unit length
};

/// The signed distance to the nearest of the triangles of a list.
inline ExactValue evaluate_list(const float* blocks, const float* feature_normals, uint32_t list,
                                float x, float y, float z) {
  const uint32_t first = list >> kBlockCountBits;
  const uint32_t count = (list & (kMostBlocksInList - 1)) + 1;
  const auto load_row = [](const float* block, int row) {
    return Triple<F8>{load<F8>(block + 8 * row), load<F8>(block + 8 * row + 8),
                      load<F8>(block + 8 * row + 16)};
  };
  F8 least = splat<F8>(__builtin_inff());
  I8 least_block{};
  const Triple<F8> place{splat<F8>(x), splat<F8>(y), splat<F8>(z)};
  for (uint32_t i = 0; i < count; ++i) {
    const float* block = blocks + static_cast<uint64_t>(first + i) * kTriangleBlockFloats;
    const Triple<F8> p = subtract(place, load_row(block, 0));
    const F8 squared =
        find_on_triangle(p, load_row(block, 3), load_row(block, 6), load_row(block, 9))
            .squared_distance;
    const I8 is_nearer = squared < least;
    least = select(is_nearer, squared, least);
    least_block = select(is_nearer, I8{} + static_cast<int32_t>(i), least_block);
  }
  int lane = 0;
  for (int other = 1; other < kLanes; ++other) {
    if (least[other] < least[lane]) lane = other;
  }
  const float* block = blocks +
                       static_cast<uint64_t>(first + static_cast<uint32_t>(least_block[lane])) *
                           kTriangleBlockFloats +
                       lane;
  const auto pick = [&](int row) {
    return Triple<float>{block[8 * row], block[8 * row + 8], block[8 * row + 16]};
  };
  const Triple<float> normal = pick(9);
  const auto nearest =
      find_on_triangle<float>(subtract(Triple<float>{x, y, z}, pick(0)), pick(3), pick(6), normal);
  const Triple<float>& offset = nearest.offset;
  if (nearest.feature == 0) return {dot(normal, offset), normal};
  uint32_t triangle;
  memcpy(&triangle, block + kTriangleIndices, sizeof triangle);
  const float* out = feature_normals + static_cast<uint64_t>(triangle) * kFeatureNormalFloats +
                     3 * nearest.feature;
  const Triple<float> outward{out[0], out[1], out[2]};
  const float length = square_root(nearest.squared_distance);
  const float sign = dot(outward, offset) < 0.0f ? -1.0f : 1.0f;
  // So near, rounding would say which way the offset points.
  constexpr float kNear = 1e-6f;
  const float size = absolute(x) + absolute(y) + absolute(z);
  if (length <= kNear * size) return {sign * length, normalized(outward)};
  const float scale = sign / length;
  return {sign * length, {scale * offset.x, scale * offset.y, scale * offset.z}};
}

}  // namespace voxshell::simd::VOXSHELL_ISA
