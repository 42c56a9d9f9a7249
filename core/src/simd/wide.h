#pragma once

// The vocabulary that formulas and kernels are written in, once, for one float (F = float, for
// single values) and for eight (F = F8). It includes only C headers: a source compiled for one
// instruction set must not emit inline functions that the linker could give to every machine, hence
// also the namespace that VOXSHELL_ISA names.

#include <math.h>
#include <stdint.h>
#include <string.h>

#ifndef VOXSHELL_ISA
#define VOXSHELL_ISA portable
#endif
#ifdef __AVX2__
#include <immintrin.h>
#endif

/// Calls would pass eight floats through memory.
#define VOXSHELL_INLINE [[gnu::always_inline]] inline

namespace voxshell::simd::VOXSHELL_ISA {

inline constexpr int kLanes = 8;

/// For each set of lanes, their numbers in ascending order, one a byte.
struct CompressOrders {
  uint64_t lanes_of[256];
};
inline constexpr CompressOrders kCompressOrders = [] {
  CompressOrders orders{};
  for (unsigned lanes = 0; lanes < 256; ++lanes) {
    int shift = 0;
    for (uint64_t lane = 0; lane < 8; ++lane) {
      if ((lanes >> lane & 1) == 0) continue;
      orders.lanes_of[lanes] |= lane << shift;
      shift += 8;
    }
  }
  return orders;
}();

using F8 = float __attribute__((vector_size(32)));
using I8 = int32_t __attribute__((vector_size(32)));

/// The types that go with F: I holds integers, Mask the outcome of a comparison.
template <class F>
struct Lanes;
template <>
struct Lanes<float> {
  using I = int32_t;
  using Mask = bool;
};
template <>
struct Lanes<F8> {
  using I = I8;
  using Mask = I8;
};
template <class F>
using Integer = typename Lanes<F>::I;
template <class F>
using MaskOf = typename Lanes<F>::Mask;

/// Coordinates, metres.
template <class F>
struct Triple {
  F x, y, z;
};

/// Subtracts: -0 + 0 would be 0.
template <class F>
VOXSHELL_INLINE F splat(float value) {
  return value - F{};
}
template <>
VOXSHELL_INLINE float splat<float>(float value) {
  return value;
}

VOXSHELL_INLINE float select(bool mask, float a, float b) { return mask ? a : b; }
VOXSHELL_INLINE int32_t select(bool mask, int32_t a, int32_t b) { return mask ? a : b; }
VOXSHELL_INLINE F8 select(I8 mask, F8 a, F8 b) { return mask ? a : b; }
VOXSHELL_INLINE I8 select(I8 mask, I8 a, I8 b) { return mask ? a : b; }

/// Of not-a-number and b: b.
template <class F>
VOXSHELL_INLINE F minimum(F a, F b) {
  return select(a < b, a, b);
}
template <class F>
VOXSHELL_INLINE F maximum(F a, F b) {
  return select(a > b, a, b);
}

#ifdef __AVX2__
template <>
VOXSHELL_INLINE F8 minimum<F8>(F8 a, F8 b) {
  return reinterpret_cast<F8>(
      _mm256_min_ps(reinterpret_cast<__m256>(a), reinterpret_cast<__m256>(b)));
}
template <>
VOXSHELL_INLINE F8 maximum<F8>(F8 a, F8 b) {
  return reinterpret_cast<F8>(
      _mm256_max_ps(reinterpret_cast<__m256>(a), reinterpret_cast<__m256>(b)));
}
template <>
VOXSHELL_INLINE I8 minimum<I8>(I8 a, I8 b) {
  return reinterpret_cast<I8>(
      _mm256_min_epi32(reinterpret_cast<__m256i>(a), reinterpret_cast<__m256i>(b)));
}
#endif

VOXSHELL_INLINE int32_t as_int(float value) {
  int32_t bits;
  memcpy(&bits, &value, sizeof bits);
  return bits;
}
VOXSHELL_INLINE I8 as_int(F8 value) { return reinterpret_cast<I8>(value); }
VOXSHELL_INLINE float as_float(int32_t bits) {
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}
VOXSHELL_INLINE F8 as_float(I8 bits) { return reinterpret_cast<F8>(bits); }

template <class F>
VOXSHELL_INLINE F absolute(F value) {
  return as_float(as_int(value) & 0x7fffffff);
}

/// `magnitude` with the sign of `sign`; `magnitude` must not be negative.
template <class F>
VOXSHELL_INLINE F with_sign(F magnitude, F sign) {
  return as_float(as_int(magnitude) | (as_int(sign) & INT32_MIN));
}

/// Rounds towards zero; the value must fit.
VOXSHELL_INLINE int32_t to_int(float value) { return static_cast<int32_t>(value); }
VOXSHELL_INLINE I8 to_int(F8 value) { return __builtin_convertvector(value, I8); }
VOXSHELL_INLINE float to_float(int32_t value) { return static_cast<float>(value); }
VOXSHELL_INLINE F8 to_float(I8 value) { return __builtin_convertvector(value, F8); }

/// Zeros come in from above.
VOXSHELL_INLINE int32_t shift_down(int32_t value, int by) {
  return static_cast<int32_t>(static_cast<uint32_t>(value) >> by);
}
VOXSHELL_INLINE I8 shift_down(I8 value, int by) {
  using U8 = uint32_t __attribute__((vector_size(32)));
  return reinterpret_cast<I8>(reinterpret_cast<U8>(value) >> static_cast<uint32_t>(by));
}
VOXSHELL_INLINE I8 shift_down(I8 value, I8 by) {
  using U8 = uint32_t __attribute__((vector_size(32)));
  return reinterpret_cast<I8>(reinterpret_cast<U8>(value) >> reinterpret_cast<U8>(by));
}

/// 2^exponent, for exponents from -126 to 127.
template <class I>
VOXSHELL_INLINE auto power_of_two(I exponent) {
  return as_float((exponent + 127) << 23);
}

VOXSHELL_INLINE float square_root(float value) { return __builtin_sqrtf(value); }
VOXSHELL_INLINE F8 square_root(F8 value) {
#ifdef __AVX2__
  return reinterpret_cast<F8>(_mm256_sqrt_ps(reinterpret_cast<__m256>(value)));
#else
  F8 root;
  for (int i = 0; i < kLanes; ++i) root[i] = __builtin_sqrtf(value[i]);
  return root;
#endif
}

/// One bit a lane.
VOXSHELL_INLINE unsigned bits(bool mask) { return mask ? 1u : 0u; }
VOXSHELL_INLINE unsigned bits(I8 mask) {
#ifdef __AVX2__
  return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(mask)));
#else
  unsigned result = 0;
  for (int i = 0; i < kLanes; ++i) result |= (static_cast<uint32_t>(mask[i]) >> 31) << i;
  return result;
#endif
}
/// Without a branch.
VOXSHELL_INLINE bool both(bool a, bool b) { return (bits(a) & bits(b)) != 0; }
VOXSHELL_INLINE I8 both(I8 a, I8 b) { return a & b; }
template <class Mask>
VOXSHELL_INLINE bool any(Mask mask) {
  return bits(mask) != 0;
}
VOXSHELL_INLINE int32_t first_lane(int32_t value) { return value; }
VOXSHELL_INLINE int32_t first_lane(I8 value) { return value[0]; }
VOXSHELL_INLINE bool is_uniform(int32_t) { return true; }
VOXSHELL_INLINE bool is_uniform(I8 value) { return bits(value == value[0]) == 255u; }
VOXSHELL_INLINE bool all(bool mask) { return mask; }
VOXSHELL_INLINE bool all(I8 mask) { return bits(mask) == 255u; }

#ifdef __AVX2__
/// What `load` gives for each index. Eight loads take less time than a gather instruction:
/// docs/decisions/0011-kernels-in-vector-extensions.md.
template <class Load>
VOXSHELL_INLINE I8 load_eight(I8 index, const Load& load) {
  using U4 = uint64_t __attribute__((vector_size(32)));
  const U4 pairs = reinterpret_cast<U4>(index);
  const auto load_four = [&](uint64_t a, uint64_t b) {
    __m128i four = _mm_cvtsi32_si128(load(static_cast<uint32_t>(a)));
    four = _mm_insert_epi32(four, load(static_cast<uint32_t>(a >> 32)), 1);
    four = _mm_insert_epi32(four, load(static_cast<uint32_t>(b)), 2);
    return _mm_insert_epi32(four, load(static_cast<uint32_t>(b >> 32)), 3);
  };
  return reinterpret_cast<I8>(
      _mm256_set_m128i(load_four(pairs[2], pairs[3]), load_four(pairs[0], pairs[1])));
}
#endif

VOXSHELL_INLINE int32_t gather(const uint32_t* base, int32_t index) {
  return static_cast<int32_t>(base[index]);
}
VOXSHELL_INLINE I8 gather(const uint32_t* base, I8 index) {
#ifdef __AVX2__
  return load_eight(index, [&](uint32_t i) { return static_cast<int32_t>(base[i]); });
#else
  I8 result;
  for (int i = 0; i < kLanes; ++i) result[i] = static_cast<int32_t>(base[index[i]]);
  return result;
#endif
}

VOXSHELL_INLINE float gather(const float* base, int32_t index) { return base[index]; }
VOXSHELL_INLINE F8 gather(const float* base, I8 index) {
#ifdef __AVX2__
  return reinterpret_cast<F8>(_mm256_i32gather_ps(base, reinterpret_cast<__m256i>(index), 4));
#else
  F8 result;
  for (int i = 0; i < kLanes; ++i) result[i] = base[index[i]];
  return result;
#endif
}

/// The entry of a table of eight that the lowest three bits of `index` say.
VOXSHELL_INLINE int32_t look_up(const int32_t (&table)[8], int32_t index) {
  return table[index & 7];
}
VOXSHELL_INLINE I8 look_up(const int32_t (&table)[8], I8 index) {
#ifdef __AVX2__
  __m256i entries;
  memcpy(&entries, table, sizeof entries);
  return reinterpret_cast<I8>(
      _mm256_permutevar8x32_epi32(entries, reinterpret_cast<__m256i>(index)));
#else
  I8 result;
  for (int i = 0; i < kLanes; ++i) result[i] = table[index[i] & 7];
  return result;
#endif
}
VOXSHELL_INLINE float look_up(const float (&table)[8], int32_t index) { return table[index & 7]; }
VOXSHELL_INLINE F8 look_up(const float (&table)[8], I8 index) {
#ifdef __AVX2__
  return reinterpret_cast<F8>(
      _mm256_permutevar8x32_ps(_mm256_loadu_ps(table), reinterpret_cast<__m256i>(index)));
#else
  F8 result;
  for (int i = 0; i < kLanes; ++i) result[i] = table[index[i] & 7];
  return result;
#endif
}

/// Two numbers up to 32767 in one.
template <class I>
VOXSHELL_INLINE I make_pair(I low, I high) {
  return low | (high << 16);
}
/// The sum of the products of two such pairs.
VOXSHELL_INLINE int32_t dot_pairs(int32_t a, int32_t b) {
  return (a & 0x7fff) * (b & 0x7fff) + (a >> 16) * (b >> 16);
}
VOXSHELL_INLINE I8 dot_pairs(I8 a, I8 b) {
#ifdef __AVX2__
  return reinterpret_cast<I8>(
      _mm256_madd_epi16(reinterpret_cast<__m256i>(a), reinterpret_cast<__m256i>(b)));
#else
  return (a & 0x7fff) * (b & 0x7fff) + (a >> 16) * (b >> 16);
#endif
}

/// The samples at `index` (low half) and `index + 1` (high half).
VOXSHELL_INLINE int32_t gather_pair(const int16_t* base, int32_t index) {
  return static_cast<int32_t>(static_cast<uint16_t>(base[index])) | (base[index + 1] * 65536);
}
VOXSHELL_INLINE I8 gather_pair(const int16_t* base, I8 index) {
#ifdef __AVX2__
  return load_eight(index, [&](uint32_t i) {
    int32_t pair;
    memcpy(&pair, base + i, sizeof pair);
    return pair;
  });
#else
  I8 result;
  for (int i = 0; i < kLanes; ++i) result[i] = gather_pair(base, index[i]);
  return result;
#endif
}

/// Writes those lanes of `values` whose bit is set, packed; space for all eight must be there.
VOXSHELL_INLINE void compress(float* to, F8 values, unsigned lanes) {
#ifdef __AVX2__
  const __m256i order = _mm256_cvtepu8_epi32(
      _mm_cvtsi64_si128(static_cast<int64_t>(kCompressOrders.lanes_of[lanes])));
  _mm256_storeu_ps(to, _mm256_permutevar8x32_ps(reinterpret_cast<__m256>(values), order));
#else
  for (; lanes != 0; lanes &= lanes - 1) *to++ = values[__builtin_ctz(lanes)];
#endif
}
VOXSHELL_INLINE void compress(uint32_t* to, I8 values, unsigned lanes) {
#ifdef __AVX2__
  const __m256i order = _mm256_cvtepu8_epi32(
      _mm_cvtsi64_si128(static_cast<int64_t>(kCompressOrders.lanes_of[lanes])));
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(to),
                      _mm256_permutevar8x32_epi32(reinterpret_cast<__m256i>(values), order));
#else
  for (; lanes != 0; lanes &= lanes - 1) {
    *to++ = static_cast<uint32_t>(values[__builtin_ctz(lanes)]);
  }
#endif
}

/// All lanes in one, in the same order with every instruction set: halves, quarters, pairs.
template <class Join>
VOXSHELL_INLINE float fold(F8 values, const Join& join) {
  const auto pair = [&](int i) {
    return join(join(values[i], values[i + 4]), join(values[i + 2], values[i + 6]));
  };
  return join(pair(0), pair(1));
}
VOXSHELL_INLINE float find_least(F8 values) {
#ifdef __AVX2__
  const __m256 all = reinterpret_cast<__m256>(values);
  const __m128 four = _mm_min_ps(_mm256_castps256_ps128(all), _mm256_extractf128_ps(all, 1));
  const __m128 two = _mm_min_ps(four, _mm_movehl_ps(four, four));
  return _mm_cvtss_f32(_mm_min_ss(two, _mm_movehdup_ps(two)));
#else
  return fold(values, [](float a, float b) { return minimum(a, b); });
#endif
}
VOXSHELL_INLINE float add_up(F8 values) {
#ifdef __AVX2__
  const __m256 all = reinterpret_cast<__m256>(values);
  const __m128 four = _mm_add_ps(_mm256_castps256_ps128(all), _mm256_extractf128_ps(all, 1));
  const __m128 two = _mm_add_ps(four, _mm_movehl_ps(four, four));
  return _mm_cvtss_f32(_mm_add_ss(two, _mm_movehdup_ps(two)));
#else
  return fold(values, [](float a, float b) { return a + b; });
#endif
}

inline constexpr I8 kLaneIndex = {0, 1, 2, 3, 4, 5, 6, 7};

/// Rows become columns.
VOXSHELL_INLINE void transpose(F8 (&rows)[kLanes]) {
#ifdef __AVX2__
  __m256 r[8], t[8];
  for (int i = 0; i < 8; ++i) r[i] = reinterpret_cast<__m256>(rows[i]);
  for (int i = 0; i < 8; i += 2) {
    t[i] = _mm256_unpacklo_ps(r[i], r[i + 1]);
    t[i + 1] = _mm256_unpackhi_ps(r[i], r[i + 1]);
  }
  for (int i = 0; i < 8; i += 4) {
    r[i] = _mm256_shuffle_ps(t[i], t[i + 2], _MM_SHUFFLE(1, 0, 1, 0));
    r[i + 1] = _mm256_shuffle_ps(t[i], t[i + 2], _MM_SHUFFLE(3, 2, 3, 2));
    r[i + 2] = _mm256_shuffle_ps(t[i + 1], t[i + 3], _MM_SHUFFLE(1, 0, 1, 0));
    r[i + 3] = _mm256_shuffle_ps(t[i + 1], t[i + 3], _MM_SHUFFLE(3, 2, 3, 2));
  }
  for (int i = 0; i < 4; ++i) {
    rows[i] = reinterpret_cast<F8>(_mm256_permute2f128_ps(r[i], r[i + 4], 0x20));
    rows[i + 4] = reinterpret_cast<F8>(_mm256_permute2f128_ps(r[i], r[i + 4], 0x31));
  }
#else
  for (int i = 0; i < kLanes; ++i) {
    for (int j = i + 1; j < kLanes; ++j) {
      const float above = rows[i][j];
      rows[i][j] = rows[j][i];
      rows[j][i] = above;
    }
  }
#endif
}

template <class F>
VOXSHELL_INLINE F load(const float* from) {
  F value;
  memcpy(&value, from, sizeof value);
  return value;
}
template <class F>
VOXSHELL_INLINE void store(float* to, F value) {
  memcpy(to, &value, sizeof value);
}

template <class F>
VOXSHELL_INLINE F dot(const Triple<F>& a, const Triple<F>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class F>
VOXSHELL_INLINE F length(const Triple<F>& a) {
  return square_root(dot(a, a));
}
template <class F>
VOXSHELL_INLINE Triple<F> select(MaskOf<F> mask, const Triple<F>& a, const Triple<F>& b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

/// Unit vector along `a`; zero where `a` is.
template <class F>
VOXSHELL_INLINE Triple<F> normalized(const Triple<F>& a) {
  const F l = length(a);
  const auto is_long = l > 0.0f;
  const F divisor = select(is_long, l, splat<F>(1.0f));
  const F zero = splat<F>(0.0f);
  return {select(is_long, a.x / divisor, zero), select(is_long, a.y / divisor, zero),
          select(is_long, a.z / divisor, zero)};
}

}  // namespace voxshell::simd::VOXSHELL_ISA
