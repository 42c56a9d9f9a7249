#include "find_zero.h"

#include <cmath>
#include <limits>
#include <optional>

#include <gtest/gtest.h>

namespace voxshell::bullet::find_zero_test {
namespace {

constexpr double kFirstStep = 0.01;
constexpr double kLeast = 0.1;
constexpr double kWithin = 1e-6;

TEST(FindZero, OfACurve) {
  const auto zero = find_zero([](double x) { return std::optional(std::tanh(x - 0.3)); },
                              kFirstStep, kLeast, kWithin);
  ASSERT_TRUE(zero.has_value());
  EXPECT_NEAR(*zero, 0.3, 1e-5);
}

TEST(FindZero, IsNoneWhereAFunctionDoesNotGrow) {
  int asked = 0;
  const auto flat = [&](double) {
    ++asked;
    return std::optional(-0.01);
  };
  EXPECT_FALSE(find_zero(flat, kFirstStep, kLeast, kWithin).has_value());
  EXPECT_LE(asked, kMostFlatSteps + 2);
}

TEST(FindZero, ClosesInOnAJump) {
  for (const double jump : {0.003, 0.017, 0.04}) {
    double below = 0.0;
    double above = std::numeric_limits<double>::infinity();
    const auto jumping = [&](double x) {
      const double value = x < jump ? -0.01 : 1.0;
      (value < 0.0 ? below : above) = x;
      return std::optional(value);
    };
    EXPECT_FALSE(find_zero(jumping, kFirstStep, kLeast, kWithin).has_value());
    EXPECT_LE(below, jump);
    EXPECT_GE(above, jump);
    EXPECT_LT(above - below, 1e-5);
  }
}

}  // namespace
}  // namespace voxshell::bullet::find_zero_test
