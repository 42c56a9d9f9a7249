#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include <gtest/gtest.h>

// Only of our own Bullet in double precision are the functions replaced.
#ifdef VOXSHELL_PORTABLE_FUNCTIONS

// Bullet's and the adapter's calls end in the same place as these.
namespace voxshell::bullet::portable_functions_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class PortableFunctions : public testing::Test {
 protected:
  double draw(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }

 private:
  std::mt19937_64 generator_{1};
};

/// The compiler knows nothing of what it returns, and so computes nothing itself.
double hidden(double value) {
  volatile double copy = value;
  return copy;
}

double distance(double found, long double truth) {
  return static_cast<double>(std::abs(static_cast<long double>(found) - truth));
}

TEST_F(PortableFunctions, AreAsExactAsTheCLibrarysWithinAFewRoundings) {
  for (int i = 0; i < 100000; ++i) {
    const double turn = hidden(draw(-1000.0, 1000.0));
    const auto truth = static_cast<long double>(turn);
    EXPECT_LE(distance(std::sin(turn), std::sin(truth)), 1e-15) << turn;
    EXPECT_LE(distance(std::cos(turn), std::cos(truth)), 1e-15) << turn;
    const double x = hidden(draw(-1.0, 1.0));
    const double y = hidden(draw(-1.0, 1.0));
    const auto exact_x = static_cast<long double>(x);
    const auto exact_y = static_cast<long double>(y);
    EXPECT_LE(distance(std::atan2(y, x), std::atan2(exact_y, exact_x)), 2e-15) << y << ' ' << x;
    EXPECT_LE(distance(std::acos(x), std::acos(exact_x)), 2e-15) << x;
    EXPECT_LE(distance(std::asin(x), std::asin(exact_x)), 2e-15) << x;
    EXPECT_LE(distance(std::hypot(x, y), std::hypot(exact_x, exact_y)), 4e-16) << y << ' ' << x;
    const double base = hidden(draw(1e-6, 1.0));
    const auto exact_base = static_cast<long double>(base);
    EXPECT_LE(distance(std::pow(base, std::abs(y)), std::pow(exact_base, std::abs(exact_y))), 4e-15)
        << base << ' ' << y;
  }
}

TEST_F(PortableFunctions, AreThoseOfTheCLibraryAtTheirEnds) {
  EXPECT_EQ(std::sin(hidden(0.0)), 0.0);
  EXPECT_EQ(std::cos(hidden(0.0)), 1.0);
  EXPECT_TRUE(std::isnan(std::sin(hidden(kInfinity))));
  EXPECT_TRUE(std::isnan(std::cos(hidden(kNaN))));
  EXPECT_LE(std::abs(std::sin(hidden(1e300))), 1.0);
  EXPECT_EQ(std::acos(hidden(1.0)), 0.0);
  EXPECT_NEAR(std::acos(hidden(-1.0)), 3.14159265358979324, 1e-15);
  EXPECT_NEAR(std::asin(hidden(-1.0)), -1.57079632679489662, 1e-15);
  EXPECT_TRUE(std::isnan(std::acos(hidden(1.5))));
  EXPECT_TRUE(std::isnan(std::asin(hidden(kNaN))));
  EXPECT_NEAR(std::atan2(hidden(kInfinity), hidden(-kInfinity)), 2.35619449019234493, 1e-15);
  EXPECT_NEAR(std::atan2(hidden(-1.0), hidden(-kInfinity)), -3.14159265358979324, 1e-15);
  EXPECT_TRUE(std::isnan(std::atan2(hidden(kNaN), hidden(1.0))));
  EXPECT_EQ(std::hypot(hidden(0.0), hidden(0.0)), 0.0);
  EXPECT_EQ(std::hypot(hidden(-kInfinity), hidden(1.0)), kInfinity);
  EXPECT_TRUE(std::isnan(std::hypot(hidden(kNaN), hidden(1.0))));
  EXPECT_NEAR(std::hypot(hidden(3e200), hidden(4e200)) / 5e200, 1.0, 1e-15);
  EXPECT_EQ(std::pow(hidden(0.0), hidden(0.01)), 0.0);
  EXPECT_EQ(std::pow(hidden(1.0), hidden(0.01)), 1.0);
  EXPECT_EQ(std::pow(hidden(0.5), hidden(0.0)), 1.0);
  EXPECT_EQ(std::pow(hidden(1e-300), hidden(1e10)), 0.0);
}

/// FNV-1a over the bits of many results; the same on every processor.
TEST_F(PortableFunctions, HaveTheSameBitsOnEveryProcessor) {
  std::uint64_t hash = 0xcbf29ce484222325u;
  const auto add = [&](double value) {
    hash = (hash ^ std::bit_cast<std::uint64_t>(value)) * 0x100000001b3u;
  };
  // Not of the standard library's distributions, which may differ.
  std::mt19937_64 generator(7);
  const auto next = [&] { return static_cast<double>(generator() >> 11u) * 0x1p-53; };
  for (int i = 0; i < 100000; ++i) {
    const double x = hidden(2.0 * next() - 1.0);
    const double y = hidden(2.0 * next() - 1.0);
    const double turn = hidden(100.0 * x);
    for (const double value : {std::sin(turn), std::cos(turn), std::atan2(y, x), std::acos(x),
                               std::asin(y), std::hypot(x, y), std::pow(std::abs(x), std::abs(y))})
      add(value);
  }
  EXPECT_EQ(hash, 0x9ac2debcbc565257u) << "keep 0x" << std::hex << hash;
}

}  // namespace
}  // namespace voxshell::bullet::portable_functions_test

#endif
