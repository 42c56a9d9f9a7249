#pragma once

// Eight numbers in one vector of AVX2. wide.h includes this file.

#include <immintrin.h>

namespace voxshell::simd::VOXSHELL_ISA {

using F8 = float __attribute__((vector_size(32)));
using I8 = int32_t __attribute__((vector_size(32)));

VOXSHELL_INLINE F8 select(I8 mask, F8 a, F8 b) { return mask ? a : b; }
VOXSHELL_INLINE I8 select(I8 mask, I8 a, I8 b) { return mask ? a : b; }

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

VOXSHELL_INLINE void set_lane(F8& values, int lane, float value) { values[lane] = value; }
VOXSHELL_INLINE void set_lane(I8& values, int lane, int32_t value) { values[lane] = value; }

VOXSHELL_INLINE I8 as_int(F8 value) { return reinterpret_cast<I8>(value); }
VOXSHELL_INLINE F8 as_float(I8 bits) { return reinterpret_cast<F8>(bits); }
VOXSHELL_INLINE I8 to_int(F8 value) { return __builtin_convertvector(value, I8); }
VOXSHELL_INLINE F8 to_float(I8 value) { return __builtin_convertvector(value, F8); }

VOXSHELL_INLINE I8 shift_down(I8 value, int by) {
  using U8 = uint32_t __attribute__((vector_size(32)));
  return reinterpret_cast<I8>(reinterpret_cast<U8>(value) >> static_cast<uint32_t>(by));
}
VOXSHELL_INLINE I8 shift_down(I8 value, I8 by) {
  using U8 = uint32_t __attribute__((vector_size(32)));
  return reinterpret_cast<I8>(reinterpret_cast<U8>(value) >> reinterpret_cast<U8>(by));
}

VOXSHELL_INLINE F8 square_root(F8 value) {
  return reinterpret_cast<F8>(_mm256_sqrt_ps(reinterpret_cast<__m256>(value)));
}

VOXSHELL_INLINE unsigned bits(I8 mask) {
  return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(mask)));
}

/// The result of `load` for each index. Eight loads take less time than a gather instruction:
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
VOXSHELL_INLINE F8 gather(const float* base, I8 index) {
  return reinterpret_cast<F8>(_mm256_i32gather_ps(base, reinterpret_cast<__m256i>(index), 4));
}

VOXSHELL_INLINE I8 look_up(const int32_t (&table)[8], I8 index) {
  __m256i entries;
  memcpy(&entries, table, sizeof entries);
  return reinterpret_cast<I8>(
      _mm256_permutevar8x32_epi32(entries, reinterpret_cast<__m256i>(index)));
}
VOXSHELL_INLINE F8 look_up(const float (&table)[8], I8 index) {
  return reinterpret_cast<F8>(
      _mm256_permutevar8x32_ps(_mm256_loadu_ps(table), reinterpret_cast<__m256i>(index)));
}

VOXSHELL_INLINE I8 dot_pairs(I8 a, I8 b) {
  return reinterpret_cast<I8>(
      _mm256_madd_epi16(reinterpret_cast<__m256i>(a), reinterpret_cast<__m256i>(b)));
}

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
VOXSHELL_INLINE __m256i find_order(unsigned lanes) {
  return _mm256_cvtepu8_epi32(
      _mm_cvtsi64_si128(static_cast<int64_t>(kCompressOrders.lanes_of[lanes])));
}

/// Writes those lanes of `values` whose bit is set, packed; space for all eight must be there.
VOXSHELL_INLINE void compress(float* to, F8 values, unsigned lanes) {
  _mm256_storeu_ps(to,
                   _mm256_permutevar8x32_ps(reinterpret_cast<__m256>(values), find_order(lanes)));
}
VOXSHELL_INLINE void compress(uint32_t* to, I8 values, unsigned lanes) {
  _mm256_storeu_si256(
      reinterpret_cast<__m256i*>(to),
      _mm256_permutevar8x32_epi32(reinterpret_cast<__m256i>(values), find_order(lanes)));
}

VOXSHELL_INLINE float find_least(F8 values) {
  const __m256 all = reinterpret_cast<__m256>(values);
  const __m128 four = _mm_min_ps(_mm256_castps256_ps128(all), _mm256_extractf128_ps(all, 1));
  const __m128 two = _mm_min_ps(four, _mm_movehl_ps(four, four));
  return _mm_cvtss_f32(_mm_min_ss(two, _mm_movehdup_ps(two)));
}
VOXSHELL_INLINE float add_up(F8 values) {
  const __m256 all = reinterpret_cast<__m256>(values);
  const __m128 four = _mm_add_ps(_mm256_castps256_ps128(all), _mm256_extractf128_ps(all, 1));
  const __m128 two = _mm_add_ps(four, _mm_movehl_ps(four, four));
  return _mm_cvtss_f32(_mm_add_ss(two, _mm_movehdup_ps(two)));
}

VOXSHELL_INLINE void transpose(F8 (&rows)[kLanes]) {
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
}

}  // namespace voxshell::simd::VOXSHELL_ISA
