#pragma once

#include "simd/wide.h"
#include "simd/winding.h"

namespace voxshell::simd::VOXSHELL_ISA {

/// Four doubles, and the outcome of comparing them: all bits of a lane or none.
using D4 = double __attribute__((vector_size(32)));
using L4 = int64_t __attribute__((vector_size(32)));

inline constexpr int kPacketPlaces = 4;
/// One for each level of a tree of 2^32 triangles, and to spare.
inline constexpr int kMostWaiting = 64;
/// A group counts as one from this many of its radii away.
inline constexpr double kFarAway = 3.0;

VOXSHELL_INLINE D4 splat_double(double value) { return value - D4{}; }
VOXSHELL_INLINE L4 as_long(D4 value) { return reinterpret_cast<L4>(value); }
VOXSHELL_INLINE D4 as_double(L4 bits) { return reinterpret_cast<D4>(bits); }
VOXSHELL_INLINE D4 select(L4 mask, D4 a, D4 b) {
#ifdef __AVX2__
  return reinterpret_cast<D4>(_mm256_blendv_pd(
      reinterpret_cast<__m256d>(b), reinterpret_cast<__m256d>(a), reinterpret_cast<__m256d>(mask)));
#else
  return as_double((as_long(a) & mask) | (as_long(b) & ~mask));
#endif
}
VOXSHELL_INLINE D4 absolute(D4 value) { return as_double(as_long(value) & INT64_MAX); }
VOXSHELL_INLINE D4 with_sign(D4 magnitude, D4 sign) {
  return as_double((as_long(magnitude) & INT64_MAX) | (as_long(sign) & INT64_MIN));
}
/// Which lanes have their sign bit set: -0 has.
VOXSHELL_INLINE L4 is_below(D4 value) { return with_sign(splat_double(1.0), value) < 0.0; }

VOXSHELL_INLINE D4 square_root(D4 value) {
#ifdef __AVX2__
  return reinterpret_cast<D4>(_mm256_sqrt_pd(reinterpret_cast<__m256d>(value)));
#else
  D4 root;
  for (int i = 0; i < kPacketPlaces; ++i) root[i] = __builtin_sqrt(value[i]);
  return root;
#endif
}

VOXSHELL_INLINE bool any(L4 mask) {
#ifdef __AVX2__
  return _mm256_movemask_pd(reinterpret_cast<__m256d>(mask)) != 0;
#else
  return (mask[0] | mask[1] | mask[2] | mask[3]) != 0;
#endif
}

/// Coordinates of four places.
struct FourPlaces {
  D4 x, y, z;
};

VOXSHELL_INLINE D4 dot(const FourPlaces& a, const FourPlaces& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
VOXSHELL_INLINE FourPlaces cross(const FourPlaces& a, const FourPlaces& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// From the places to one that is the same for all.
VOXSHELL_INLINE FourPlaces way_to(const double* to, const FourPlaces& from) {
  return {to[0] - from.x, to[1] - from.y, to[2] - from.z};
}

/// The operations of portable_atan2, in the same order.
VOXSHELL_INLINE D4 arc_tangent(D4 y, D4 x) {
  constexpr double kQuarterTurn = 1.5707963267948966;
  constexpr double kHalfTurn = 3.141592653589793;
  // Of i / 8. The rest is an angle whose tangent is at most 1 / 16.
  static constexpr double kAngles[9] = {0.0,
                                        0.12435499454676144,
                                        0.24497866312686414,
                                        0.35877067027057225,
                                        0.4636476090008061,
                                        0.5585993153435624,
                                        0.6435011087932844,
                                        0.7188299996216245,
                                        0.7853981633974483};
  const D4 width = absolute(x);
  const D4 height = absolute(y);
  const D4 low = select(height < width, height, width);
  const D4 high = select(width < height, height, width);
  const D4 in_eighths = 8.0 * (low / high) + 0.5;  // not a number where the vector is 0
  D4 eighths{};
  D4 angle{};
#ifdef __AVX2__
  const __m128i step =
      _mm_min_epu32(_mm256_cvttpd_epi32(reinterpret_cast<__m256d>(in_eighths)), _mm_set1_epi32(8));
  eighths = reinterpret_cast<D4>(_mm256_cvtepi32_pd(step));
  for (int i = 0; i < kPacketPlaces; ++i) angle[i] = kAngles[static_cast<int>(eighths[i])];
#else
  for (int i = 0; i < kPacketPlaces; ++i) {
    const int step = in_eighths[i] < 9.0 ? static_cast<int>(in_eighths[i]) : 8;
    eighths[i] = step;
    angle[i] = kAngles[step];
  }
#endif
  const D4 t = (low - eighths / 8.0 * high) / (high + eighths / 8.0 * low);
  D4 series{};
  for (int i = 7; i > 0; --i) series = t * t * (1.0 / (2 * i + 1) - series);
  angle = select(high > 0.0, angle + (t - t * series), D4{});
  angle = select(height > width, kQuarterTurn - angle, angle);
  angle = select(x < 0.0, kHalfTurn - angle, angle);
  return with_sign(angle, y);
}

/// Adds up angles of vectors in the plane, each from -pi to pi, by multiplying these as complex
/// numbers and counting how often the product passes the negative axis: one arc tangent for many.
struct AngleSum {
  D4 x = splat_double(1.0);
  D4 y = splat_double(0.0);
  D4 turns = splat_double(0.0);

  /// The angle of (u, v), where `counts`. The product of all lengths must stay in the range of
  /// doubles.
  VOXSHELL_INLINE void add(D4 u, D4 v, L4 counts) {
    const D4 product_x = x * u - y * v;
    const D4 product_y = x * v + y * u;
    const L4 was_below = is_below(y);
    const L4 passes = counts & (was_below == is_below(v)) & (was_below != is_below(product_y));
    turns = select(passes, turns + select(was_below, splat_double(-1.0), splat_double(1.0)), turns);
    x = select(counts, product_x, x);
    y = select(counts, product_y, y);
  }

  VOXSHELL_INLINE D4 total() const { return arc_tangent(y, x) + 2.0 * 3.141592653589793 * turns; }
};

/// Adds half the solid angle of a triangle (Van Oosterom and Strackee 1983). As seen from a corner
/// it has none.
VOXSHELL_INLINE void add_half_angle(const double* corners, const FourPlaces& p, AngleSum& sum) {
  const FourPlaces a = way_to(corners, p);
  const FourPlaces b = way_to(corners + 3, p);
  const FourPlaces c = way_to(corners + 6, p);
  const D4 la = square_root(dot(a, a));
  const D4 lb = square_root(dot(b, b));
  const D4 lc = square_root(dot(c, c));
  const D4 product = la * lb * lc;
  const D4 x = (product + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb) / product;
  const D4 y = dot(a, cross(b, c)) / product;
  sum.add(x, y, (product != 0.0) & ((x != 0.0) | (y != 0.0)));
}

/// Each place adds what it would add by itself, in the same order.
VOXSHELL_INLINE D4 compute_four(const WindingView& tree, const FourPlaces& p) {
  struct Waiting {
    uint32_t node;
    L4 of;  ///< the places that look at it
  };
  Waiting stack[kMostWaiting];
  int waiting = 0;
  D4 sum{};
  stack[waiting++] = {0, L4{} == L4{}};
  while (waiting > 0) {
    const Waiting next = stack[--waiting];
    const WindingNode& node = tree.nodes[next.node];
    const FourPlaces to_center = way_to(node.center, p);
    const D4 squared = dot(to_center, to_center);
    const L4 is_far = squared > kFarAway * kFarAway * node.radius * node.radius;
    const L4 is_one = next.of & is_far;
    if (any(is_one)) {
      const D4 seen =
          to_center.x * node.area[0] + to_center.y * node.area[1] + to_center.z * node.area[2];
      sum = select(is_one, sum + seen / (squared * square_root(squared)), sum);
    }
    const L4 are_many = next.of & ~is_far;
    if (!any(are_many)) continue;
    if (node.count > 0) {
      AngleSum halves;
      for (uint32_t i = node.first; i < node.first + node.count; ++i) {
        add_half_angle(tree.triangles + uint64_t{i} * kWindingTriangleDoubles, p, halves);
      }
      sum = select(are_many, sum + 2.0 * halves.total(), sum);
    } else {
      stack[waiting++] = {node.first, are_many};
      stack[waiting++] = {next.node + 1, are_many};
    }
  }
  return sum / (4.0 * 3.141592653589793);
}

inline void compute_winding_numbers(const WindingView& tree, const double* places, int64_t count,
                                    double* numbers) {
  for (int64_t first = 0; first < count; first += kPacketPlaces) {
    const int64_t present = count - first < kPacketPlaces ? count - first : kPacketPlaces;
    double by_axis[3][kPacketPlaces];
    for (int i = 0; i < kPacketPlaces; ++i) {
      // The last places are filled up with the last one.
      const double* place = places + 3 * (first + (i < present ? i : present - 1));
      for (int axis = 0; axis < 3; ++axis) by_axis[axis][i] = place[axis];
    }
    FourPlaces p;
    memcpy(&p.x, by_axis[0], sizeof p.x);
    memcpy(&p.y, by_axis[1], sizeof p.y);
    memcpy(&p.z, by_axis[2], sizeof p.z);
    const D4 four = compute_four(tree, p);
    for (int64_t i = 0; i < present; ++i) numbers[first + i] = four[i];
  }
}

}  // namespace voxshell::simd::VOXSHELL_ISA
