#include "base/portable_math.h"

#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "support/random.h"

namespace voxshell::portable_math_test {
namespace {

using namespace test_support;

constexpr double kUnits = 4.0 * std::numeric_limits<double>::epsilon();

TEST(PortableMath, AnglesAreThoseOfTheLibrary) {
  Random random(31);
  for (int i = 0; i < 100'000; ++i) {
    const double scale = std::ldexp(1.0, static_cast<int>(random.below(80)) - 40);
    const double y = random.uniform(-1.0, 1.0) * (i % 2 == 0 ? scale : 1.0);
    const double x = random.uniform(-1.0, 1.0) * (i % 2 == 0 ? 1.0 : scale);
    const double expected = std::atan2(y, x);
    ASSERT_NEAR(portable_atan2(y, x), expected, kUnits * std::abs(expected)) << y << ' ' << x;
  }
  constexpr double kPi = std::numbers::pi;
  EXPECT_EQ(portable_atan2(0.0, 0.0), 0.0);
  EXPECT_EQ(portable_atan2(0.0, 2.0), 0.0);
  EXPECT_EQ(portable_atan2(0.0, -2.0), kPi);
  EXPECT_EQ(portable_atan2(3.0, 0.0), kPi / 2.0);
  EXPECT_EQ(portable_atan2(-3.0, 0.0), -kPi / 2.0);
  EXPECT_EQ(portable_atan2(5.0, 5.0), kPi / 4.0);
  EXPECT_EQ(portable_atan2(-5.0, -5.0), -3.0 * kPi / 4.0);
}

TEST(PortableMath, LogarithmsAndExponentialsAreThoseOfTheLibrary) {
  Random random(32);
  for (int i = 0; i < 100'000; ++i) {
    const double x = random.uniform(-1.0, 1.0) * (i % 2 == 0 ? 1.0 : 700.0);
    const double e = std::exp(x);
    ASSERT_NEAR(portable_exp(x), e, kUnits * e) << x;
    ASSERT_NEAR(portable_log(e), std::log(e), kUnits * std::abs(std::log(e))) << e;
  }
  EXPECT_EQ(portable_exp(0.0), 1.0);
  EXPECT_EQ(portable_log(1.0), 0.0);
}

TEST(PortableMath, SinesAndCosinesAreThoseOfTheLibrary) {
  Random random(33);
  for (int i = 0; i < 100'000; ++i) {
    const double x = random.uniform(-1.0, 1.0) * (i % 3 == 0 ? 1.0 : i % 3 == 1 ? 10.0 : 1e5);
    ASSERT_NEAR(portable_sin(x), std::sin(x), 1e-15) << x;
    ASSERT_NEAR(portable_cos(x), std::cos(x), 1e-15) << x;
  }
  for (const double x : {1e-300, 1e-10, 1e-4}) EXPECT_NEAR(portable_sin(x), x, 2e-9 * x);
  EXPECT_EQ(portable_sin(0.0), 0.0);
  EXPECT_EQ(portable_cos(0.0), 1.0);
  EXPECT_EQ(portable_sin(std::numbers::pi / 2.0), 1.0);
}

}  // namespace
}  // namespace voxshell::portable_math_test
