#include "simd/wide.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

// What each lane of the eight numbers of this processor's baseline gives, beside single numbers.

namespace voxshell::wide_test {
namespace {

using namespace simd::VOXSHELL_ISA;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr F8 kA{1.5f, -0.0f, 0.0f, -3.25f, kInfinity, kNan, 7.0f, -1e-38f};
constexpr F8 kB{1.5f, 0.0f, -2.0f, 4.0f, -kInfinity, 1.0f, kNan, 1e20f};
constexpr I8 kI{0, -1, 5, INT32_MIN, INT32_MAX, 1 << 20, -77, 12};
constexpr I8 kJ{3, -1, -5, 9, 0, 1 << 20, 76, 5};

/// All that are not a number are one: compilers and processors give them different signs.
std::uint32_t bits_of(float value) {
  return std::bit_cast<std::uint32_t>(std::isnan(value) ? kNan : value);
}
std::uint32_t bits_of(std::int32_t value) { return static_cast<std::uint32_t>(value); }
std::uint32_t bits_of(bool value) { return value ? UINT32_MAX : 0; }

/// @param single  Called with a lane.
template <class Eight, class Single>
void expect_lanes(const char* what, const Eight& eight, const Single& single) {
  for (int lane = 0; lane < kLanes; ++lane) {
    EXPECT_EQ(bits_of(eight[lane]), bits_of(single(lane))) << what << ", lane " << lane;
  }
}

TEST(Wide, ArithmeticIsThatOfSingleNumbers) {
  expect_lanes("sum", kA + kB, [](int i) { return kA[i] + kB[i]; });
  expect_lanes("difference", kA - kB, [](int i) { return kA[i] - kB[i]; });
  expect_lanes("product", kA * kB, [](int i) { return kA[i] * kB[i]; });
  expect_lanes("quotient", kA / kB, [](int i) { return kA[i] / kB[i]; });
  expect_lanes("negation", -kB, [](int i) { return -kB[i]; });
  expect_lanes("scalar after", kB - 1.0f, [](int i) { return kB[i] - 1.0f; });
  expect_lanes("scalar before", 1.0f - kB, [](int i) { return 1.0f - kB[i]; });
  expect_lanes("splat", splat<F8>(-0.0f), [](int) { return -0.0f; });
  F8 added = kA;
  added += kB;
  added -= kA;
  expect_lanes("assigned", added, [](int i) { return kA[i] + kB[i] - kA[i]; });
}

TEST(Wide, BitsAndShiftsAreThoseOfSingleNumbers) {
  expect_lanes("and", kI & kJ, [](int i) { return kI[i] & kJ[i]; });
  expect_lanes("or", kI | 6, [](int i) { return kI[i] | 6; });
  expect_lanes("shift up", (kJ & 0xff) << 3, [](int i) { return (kJ[i] & 0xff) << 3; });
  expect_lanes("shift with the sign", kI >> 3, [](int i) { return kI[i] >> 3; });
  expect_lanes("shift down", shift_down(kI, 3), [](int i) { return shift_down(kI[i], 3); });
  const I8 by{0, 1, 2, 3, 4, 5, 30, 31};
  expect_lanes("shift each", shift_down(kI, by), [&](int i) { return shift_down(kI[i], by[i]); });
  I8 assigned = kI;
  assigned |= kJ;
  assigned &= 0xffff;
  expect_lanes("assigned", assigned, [](int i) { return (kI[i] | kJ[i]) & 0xffff; });
}

TEST(Wide, ComparisonsChooseAsThoseOfSingleNumbers) {
  expect_lanes("less", kA < kB, [](int i) { return kA[i] < kB[i]; });
  expect_lanes("at most", kA <= kB, [](int i) { return kA[i] <= kB[i]; });
  expect_lanes("greater", kA > kB, [](int i) { return kA[i] > kB[i]; });
  expect_lanes("at least", kA >= kB, [](int i) { return kA[i] >= kB[i]; });
  expect_lanes("equal", kI == kJ, [](int i) { return kI[i] == kJ[i]; });
  expect_lanes("different", kI != kJ, [](int i) { return kI[i] != kJ[i]; });
  expect_lanes("select", select(kA < kB, kA, kB),
               [](int i) { return select(kA[i] < kB[i], kA[i], kB[i]); });
  expect_lanes("select integers", select(kI < kJ, kI, kJ),
               [](int i) { return select(kI[i] < kJ[i], kI[i], kJ[i]); });
  expect_lanes("minimum", minimum(kA, kB), [](int i) { return minimum(kA[i], kB[i]); });
  expect_lanes("maximum", maximum(kA, kB), [](int i) { return maximum(kA[i], kB[i]); });
  expect_lanes("least integer", minimum(kI, kJ), [](int i) { return minimum(kI[i], kJ[i]); });
  EXPECT_EQ(bits(kI < 0), 0b01001010u);
  EXPECT_EQ(bits(kI), 0b01001010u) << "signs of what is no mask";
  EXPECT_TRUE(all(kI == kI));
  EXPECT_FALSE(any(kI != kI));
  EXPECT_TRUE(is_uniform(I8{} + 7));
  EXPECT_FALSE(is_uniform(kI));
}

TEST(Wide, FunctionsAreThoseOfSingleNumbers) {
  const F8 values{0.0f, 2.9f, -2.9f, 1e9f, 1e-20f, 49.0f, -1.0f, 3e5f};
  expect_lanes("to int", to_int(values), [&](int i) { return to_int(values[i]); });
  expect_lanes("to float", to_float(kI), [](int i) { return to_float(kI[i]); });
  expect_lanes("absolute", absolute(kA), [](int i) { return absolute(kA[i]); });
  const F8 lengths = absolute(values);
  expect_lanes("root", square_root(lengths), [&](int i) { return square_root(lengths[i]); });
  expect_lanes("sign", with_sign(lengths, kB), [&](int i) { return with_sign(lengths[i], kB[i]); });
  const I8 pairs = make_pair(I8{0, 1, 2, 3, 4, 5, 6, 32767}, I8{9, 8, 7, 6, 5, 4, 3, 32767});
  const I8 others = make_pair(I8{5, 5, 3, 3, 1, 1, 0, 2}, I8{1, 0, 1, 0, 200, 0, 1, 2});
  expect_lanes("pairs", dot_pairs(pairs, others),
               [&](int i) { return dot_pairs(pairs[i], others[i]); });
}

TEST(Wide, LooksUpWhatSingleNumbersDo) {
  const I8 index{3, 0, 7, 7, 1, 2, 12, 9};
  constexpr float kFloats[16] = {0, 1, 4, 9, 16, 25, 36, 49, 64, 81, 100, 121, 144, 169, 196, 225};
  constexpr std::int32_t kNumbers[8] = {5, -6, 7, -8, 9, -10, 11, -12};
  constexpr float kEight[8] = {0.5f, -1.5f, 2.5f, -3.5f, 4.5f, -5.5f, 6.5f, -7.5f};
  constexpr std::int16_t kShorts[16] = {1, -2,  3,  -4,  5,  -6,  7,  -8,
                                        9, -10, 11, -12, 13, -14, 15, -16};
  std::array<std::uint32_t, 16> words{};
  for (std::uint32_t i = 0; i < 16; ++i) words[i] = 0xfffffff0u + i;
  expect_lanes("floats", gather(kFloats, index), [&](int i) { return gather(kFloats, index[i]); });
  expect_lanes("words", gather(words.data(), index),
               [&](int i) { return gather(words.data(), index[i]); });
  expect_lanes("pairs", gather_pair(kShorts, index),
               [&](int i) { return gather_pair(kShorts, index[i]); });
  expect_lanes("table", look_up(kNumbers, index),
               [&](int i) { return look_up(kNumbers, index[i]); });
  expect_lanes("table of floats", look_up(kEight, index),
               [&](int i) { return look_up(kEight, index[i]); });
}

TEST(Wide, LanesAreMovedAndJoined) {
  for (unsigned lanes = 0; lanes < 256; ++lanes) {
    float packed[8];
    std::uint32_t words[8];
    compress(packed, kB, lanes);
    compress(words, kI, lanes);
    int count = 0;
    for (int lane = 0; lane < kLanes; ++lane) {
      if ((lanes >> lane & 1) == 0) continue;
      EXPECT_EQ(bits_of(packed[count]), bits_of(kB[lane])) << lanes;
      EXPECT_EQ(words[count], bits_of(kI[lane])) << lanes;
      ++count;
    }
  }
  const F8 values{1e8f, 1.0f, -1e8f, 0.3f, 7.0f, 0.1f, -7.0f, 1e-3f};
  EXPECT_EQ(find_least(values), -1e8f);
  // The order of the sums is the same with every instruction set.
  EXPECT_EQ(add_up(values), ((1e8f + 7.0f) + (-1e8f + -7.0f)) + ((1.0f + 0.1f) + (0.3f + 1e-3f)));
  F8 rows[kLanes];
  for (int i = 0; i < kLanes; ++i) rows[i] = to_float(kLaneIndex + 10 * i);
  transpose(rows);
  for (int i = 0; i < kLanes; ++i) {
    expect_lanes("column", rows[i], [i](int j) { return static_cast<float>(10 * j + i); });
  }
  F8 changed = values;
  for (int lane = 0; lane < kLanes; ++lane) set_lane(changed, lane, kB[lane]);
  expect_lanes("set", changed, [](int i) { return kB[i]; });
}

}  // namespace
}  // namespace voxshell::wide_test
