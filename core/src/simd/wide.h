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

/// Calls would pass eight floats through memory.
#define VOXSHELL_INLINE [[gnu::always_inline]] inline

namespace voxshell::simd::VOXSHELL_ISA {

inline constexpr int kLanes = 8;

/// Of not-a-number and b: b.
template <class F>
VOXSHELL_INLINE F minimum(F a, F b);
template <class F>
VOXSHELL_INLINE F maximum(F a, F b);

}  // namespace voxshell::simd::VOXSHELL_ISA

#ifdef __AVX2__
#include "simd/eight_of_avx2.h"
#else
#include "simd/eight_of_fours.h"
#endif

namespace voxshell::simd::VOXSHELL_ISA {

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

/// Coordinates, meters.
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

template <class F>
VOXSHELL_INLINE F minimum(F a, F b) {
  return select(a < b, a, b);
}
template <class F>
VOXSHELL_INLINE F maximum(F a, F b) {
  return select(a > b, a, b);
}

VOXSHELL_INLINE int32_t as_int(float value) {
  int32_t bits;
  memcpy(&bits, &value, sizeof bits);
  return bits;
}
VOXSHELL_INLINE float as_float(int32_t bits) {
  float value;
  memcpy(&value, &bits, sizeof value);
  return value;
}

template <class F>
VOXSHELL_INLINE F absolute(F value) {
  return as_float(as_int(value) & 0x7fffffff);
}

/// `magnitude` with the sign of `sign`; `magnitude` must not be negative.
template <class F>
VOXSHELL_INLINE F with_sign(F magnitude, F sign) {
  return as_float(as_int(magnitude) | (as_int(sign) & INT32_MIN));
}

/// Rounds toward zero; the value must fit.
VOXSHELL_INLINE int32_t to_int(float value) { return static_cast<int32_t>(value); }
VOXSHELL_INLINE float to_float(int32_t value) { return static_cast<float>(value); }

/// Zeros come in from above.
VOXSHELL_INLINE int32_t shift_down(int32_t value, int by) {
  return static_cast<int32_t>(static_cast<uint32_t>(value) >> by);
}

/// 2^exponent, for exponents from -126 to 127.
template <class I>
VOXSHELL_INLINE auto power_of_two(I exponent) {
  return as_float((exponent + 127) << 23);
}

VOXSHELL_INLINE float square_root(float value) { return __builtin_sqrtf(value); }

/// One bit a lane.
VOXSHELL_INLINE unsigned bits(bool mask) { return mask ? 1u : 0u; }
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

VOXSHELL_INLINE int32_t gather(const uint32_t* base, int32_t index) {
  return static_cast<int32_t>(base[index]);
}
VOXSHELL_INLINE I8 gather(const uint32_t* base, I8 index) {
  return load_eight(index, [&](uint32_t i) { return static_cast<int32_t>(base[i]); });
}
VOXSHELL_INLINE float gather(const float* base, int32_t index) { return base[index]; }

/// The entry of a table of eight that the lowest three bits of `index` say.
VOXSHELL_INLINE int32_t look_up(const int32_t (&table)[8], int32_t index) {
  return table[index & 7];
}
VOXSHELL_INLINE float look_up(const float (&table)[8], int32_t index) { return table[index & 7]; }

/// Two numbers up to 32767 in one.
template <class I>
VOXSHELL_INLINE I make_pair(I low, I high) {
  return low | (high << 16);
}
/// The sum of the products of two such pairs.
VOXSHELL_INLINE int32_t dot_pairs(int32_t a, int32_t b) {
  return (a & 0x7fff) * (b & 0x7fff) + (a >> 16) * (b >> 16);
}

/// The samples at `index` (low half) and `index + 1` (high half).
VOXSHELL_INLINE int32_t load_pair(const int16_t* from) {
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
  int32_t pair;
  memcpy(&pair, from, sizeof pair);
  return pair;
#else
  return static_cast<int32_t>(static_cast<uint16_t>(from[0])) | (from[1] * 65536);
#endif
}
VOXSHELL_INLINE int32_t gather_pair(const int16_t* base, int32_t index) {
  return load_pair(base + index);
}
VOXSHELL_INLINE I8 gather_pair(const int16_t* base, I8 index) {
  return load_eight(index, [&](uint32_t i) { return load_pair(base + i); });
}

inline constexpr I8 kLaneIndex = {0, 1, 2, 3, 4, 5, 6, 7};

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

VOXSHELL_INLINE void set_lane(Triple<F8>& places, int lane, const Triple<float>& place) {
  set_lane(places.x, lane, place.x);
  set_lane(places.y, lane, place.y);
  set_lane(places.z, lane, place.z);
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
