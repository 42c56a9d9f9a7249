#pragma once

// Eight numbers in two vectors of four, which SSE2 and NEON have. GCC takes wider vectors than the
// processor's apart, number by number: docs/decisions/0011-kernels-in-vector-extensions.md. wide.h
// includes this file.

#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace voxshell::simd::VOXSHELL_ISA {

template <class Number>
struct Eight;

/// Of two vectors of four; comparisons of floats give integers.
template <class Four>
VOXSHELL_INLINE auto join(Four low, Four high) {
  return Eight<decltype(Four{}[0] + 0)>(low, high);
}

/// Has the operators that the compiler's vectors have, with scalars on one side, too.
template <class Number>
struct Eight {
  using Four __attribute__((vector_size(16))) = Number;

  Eight() = default;
  VOXSHELL_INLINE constexpr Eight(Number a, Number b, Number c, Number d, Number e, Number f,
                                  Number g, Number h)
      : low{a, b, c, d}, high{e, f, g, h} {}
  VOXSHELL_INLINE constexpr Eight(Four first, Four last) : low(first), high(last) {}
  // NOLINTNEXTLINE(google-explicit-constructor): scalars beside the compiler's vectors are so, too
  VOXSHELL_INLINE constexpr Eight(Number all) : low{all, all, all, all}, high{all, all, all, all} {}

  /// @param index  Of any integer type.
  template <class Index>
  VOXSHELL_INLINE Number operator[](Index index) const {
    const auto lane = static_cast<size_t>(index);
    if (__builtin_constant_p(lane)) return lane < 4 ? low[lane] : high[lane - 4];
    Number number;
    memcpy(&number, reinterpret_cast<const char*>(this) + lane * sizeof number, sizeof number);
    return number;
  }

#define VOXSHELL_OPERATOR(OP)                                               \
  VOXSHELL_INLINE friend auto operator OP(const Eight& a, const Eight& b) { \
    return join(a.low OP b.low, a.high OP b.high);                          \
  }
  VOXSHELL_OPERATOR(+)
  VOXSHELL_OPERATOR(-)
  VOXSHELL_OPERATOR(*)
  VOXSHELL_OPERATOR(/)
  VOXSHELL_OPERATOR(&)
  VOXSHELL_OPERATOR(|)
  VOXSHELL_OPERATOR(<)
  VOXSHELL_OPERATOR(<=)
  VOXSHELL_OPERATOR(>)
  VOXSHELL_OPERATOR(>=)
  VOXSHELL_OPERATOR(==)
  VOXSHELL_OPERATOR(!=)
#undef VOXSHELL_OPERATOR
  VOXSHELL_INLINE friend Eight operator<<(const Eight& a, int by) {
    return Eight(a.low << by, a.high << by);
  }
  VOXSHELL_INLINE friend Eight operator>>(const Eight& a, int by) {
    return Eight(a.low >> by, a.high >> by);
  }
  VOXSHELL_INLINE Eight operator-() const { return Eight(-low, -high); }
  VOXSHELL_INLINE Eight& operator+=(const Eight& other) { return *this = *this + other; }
  VOXSHELL_INLINE Eight& operator-=(const Eight& other) { return *this = *this - other; }
  VOXSHELL_INLINE Eight& operator&=(const Eight& other) { return *this = *this & other; }
  VOXSHELL_INLINE Eight& operator|=(const Eight& other) { return *this = *this | other; }

  Four low, high;
};

using F8 = Eight<float>;
using I8 = Eight<int32_t>;
using F4 = F8::Four;
using I4 = I8::Four;
using U4 = Eight<uint32_t>::Four;

/// The result of `at` for each lane.
template <class Numbers, class At>
VOXSHELL_INLINE Numbers of_each_lane(const At& at) {
  return Numbers(at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7));
}

VOXSHELL_INLINE F8 select(I8 mask, F8 a, F8 b) {
  return F8(mask.low ? a.low : b.low, mask.high ? a.high : b.high);
}
VOXSHELL_INLINE I8 select(I8 mask, I8 a, I8 b) {
  return I8(mask.low ? a.low : b.low, mask.high ? a.high : b.high);
}

template <class Number, class Index>
VOXSHELL_INLINE void set_lane(Eight<Number>& numbers, Index lane, Number number) {
  memcpy(reinterpret_cast<char*>(&numbers) + static_cast<size_t>(lane) * sizeof number, &number,
         sizeof number);
}

VOXSHELL_INLINE I8 as_int(F8 value) {
  return I8(reinterpret_cast<I4>(value.low), reinterpret_cast<I4>(value.high));
}
VOXSHELL_INLINE F8 as_float(I8 bits) {
  return F8(reinterpret_cast<F4>(bits.low), reinterpret_cast<F4>(bits.high));
}
VOXSHELL_INLINE I8 to_int(F8 value) {
  return I8(__builtin_convertvector(value.low, I4), __builtin_convertvector(value.high, I4));
}
VOXSHELL_INLINE F8 to_float(I8 value) {
  return F8(__builtin_convertvector(value.low, F4), __builtin_convertvector(value.high, F4));
}

VOXSHELL_INLINE I8 shift_down(I8 value, int by) {
  const auto shift = [by](I4 four) {
    return reinterpret_cast<I4>(reinterpret_cast<U4>(four) >> static_cast<uint32_t>(by));
  };
  return I8(shift(value.low), shift(value.high));
}
VOXSHELL_INLINE I8 shift_down(I8 value, I8 by) {
  const auto shift = [](I4 four, I4 by_four) {
    return reinterpret_cast<I4>(reinterpret_cast<U4>(four) >> reinterpret_cast<U4>(by_four));
  };
  return I8(shift(value.low, by.low), shift(value.high, by.high));
}

VOXSHELL_INLINE F8 square_root(F8 value) {
#ifdef __SSE2__
  const auto root = [](F4 four) {
    return reinterpret_cast<F4>(_mm_sqrt_ps(reinterpret_cast<__m128>(four)));
  };
  return F8(root(value.low), root(value.high));
#else
  return of_each_lane<F8>([&](int i) { return __builtin_sqrtf(value[i]); });
#endif
}

VOXSHELL_INLINE unsigned bits(I8 mask) {
#ifdef __SSE2__
  const auto bits_of = [](I4 four) {
    return static_cast<unsigned>(_mm_movemask_ps(reinterpret_cast<__m128>(four)));
  };
  return bits_of(mask.low) | bits_of(mask.high) << 4;
#else
  // Like the instruction: of what is no mask, the sign.
  const I4 all = (mask.low >> 31 & I4{1, 2, 4, 8}) | (mask.high >> 31 & I4{16, 32, 64, 128});
  return static_cast<unsigned>(all[0] | all[1] | all[2] | all[3]);
#endif
}

template <class Load>
VOXSHELL_INLINE I8 load_eight(I8 index, const Load& load) {
  return of_each_lane<I8>([&](int i) { return load(static_cast<uint32_t>(index[i])); });
}
VOXSHELL_INLINE F8 gather(const float* base, I8 index) {
  return of_each_lane<F8>([&](int i) { return base[index[i]]; });
}

template <class Number>
VOXSHELL_INLINE Eight<Number> look_up(const Number (&table)[8], I8 index) {
  return of_each_lane<Eight<Number>>([&](int i) { return table[index[i] & 7]; });
}

VOXSHELL_INLINE I8 dot_pairs(I8 a, I8 b) {
#ifdef __SSE2__
  const auto dot = [](I4 x, I4 y) {
    return reinterpret_cast<I4>(
        _mm_madd_epi16(reinterpret_cast<__m128i>(x), reinterpret_cast<__m128i>(y)));
  };
  return I8(dot(a.low, b.low), dot(a.high, b.high));
#else
  return (a & 0x7fff) * (b & 0x7fff) + (a >> 16) * (b >> 16);
#endif
}

/// Writes those lanes of `values` whose bit is set, packed; space for all eight must be there.
VOXSHELL_INLINE void compress(float* to, const F8& values, unsigned lanes) {
  for (; lanes != 0; lanes &= lanes - 1) *to++ = values[__builtin_ctz(lanes)];
}
VOXSHELL_INLINE void compress(uint32_t* to, const I8& values, unsigned lanes) {
  for (; lanes != 0; lanes &= lanes - 1) {
    *to++ = static_cast<uint32_t>(values[__builtin_ctz(lanes)]);
  }
}

VOXSHELL_INLINE float find_least(F8 values) {
  const F4 four = values.low < values.high ? values.low : values.high;
  const float even = four[0] < four[2] ? four[0] : four[2];
  const float odd = four[1] < four[3] ? four[1] : four[3];
  return even < odd ? even : odd;
}
VOXSHELL_INLINE float add_up(F8 values) {
  const F4 four = values.low + values.high;
  return (four[0] + four[2]) + (four[1] + four[3]);
}

VOXSHELL_INLINE void transpose_fours(const F4& a, const F4& b, const F4& c, const F4& d,
                                     F4 (&columns)[4]) {
  const F4 ab_low{a[0], b[0], a[1], b[1]};
  const F4 ab_high{a[2], b[2], a[3], b[3]};
  const F4 cd_low{c[0], d[0], c[1], d[1]};
  const F4 cd_high{c[2], d[2], c[3], d[3]};
  columns[0] = F4{ab_low[0], ab_low[1], cd_low[0], cd_low[1]};
  columns[1] = F4{ab_low[2], ab_low[3], cd_low[2], cd_low[3]};
  columns[2] = F4{ab_high[0], ab_high[1], cd_high[0], cd_high[1]};
  columns[3] = F4{ab_high[2], ab_high[3], cd_high[2], cd_high[3]};
}
VOXSHELL_INLINE void transpose(F8 (&rows)[kLanes]) {
  F4 columns[4][4];
  transpose_fours(rows[0].low, rows[1].low, rows[2].low, rows[3].low, columns[0]);
  transpose_fours(rows[4].low, rows[5].low, rows[6].low, rows[7].low, columns[1]);
  transpose_fours(rows[0].high, rows[1].high, rows[2].high, rows[3].high, columns[2]);
  transpose_fours(rows[4].high, rows[5].high, rows[6].high, rows[7].high, columns[3]);
  for (int i = 0; i < 4; ++i) {
    rows[i] = F8(columns[0][i], columns[1][i]);
    rows[i + 4] = F8(columns[2][i], columns[3][i]);
  }
}

}  // namespace voxshell::simd::VOXSHELL_ISA
