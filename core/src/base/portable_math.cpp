#include "base/portable_math.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace voxshell {
namespace {

/// Of the sine of an angle of up to a quarter of pi, or its cosine: the series of powers, which go
/// up by two, divided by the first.
double sum_series(double x, int first) {
  constexpr int kTerms = 9;
  double series = 1.0;
  for (int i = kTerms; i > 0; --i) {
    const int power = first + 2 * i;
    series = 1.0 - x * x * (1.0 / (power * (power - 1))) * series;
  }
  return series;
}

/// The sine of an angle and of as many right angles more.
double sine_after_quarters(double x, int quarters) {
  // Half of pi in two parts; the multiples of the first that can occur are exact.
  constexpr double kHigh = 0x1.921fb5444p+0;
  constexpr double kLow = 0x1.68c234c4c6629p-39;
  const double turns = std::floor(x / (std::numbers::pi / 2.0) + 0.5);
  const double rest = (x - turns * kHigh) - turns * kLow;
  const int quarter = static_cast<int>(std::fmod(turns, 4.0)) + quarters + 4;
  const double value = quarter % 2 == 0 ? rest * sum_series(rest, 1) : sum_series(rest, 0);
  return quarter % 4 < 2 ? value : -value;
}

}  // namespace

double portable_atan2(double y, double x) {
  // Of i / 8. The rest is an angle whose tangent is at most 1 / 16.
  constexpr std::array<double, 9> kAngles{0.0,
                                          0.12435499454676144,
                                          0.24497866312686414,
                                          0.35877067027057225,
                                          0.4636476090008061,
                                          0.5585993153435624,
                                          0.6435011087932844,
                                          0.7188299996216245,
                                          std::numbers::pi / 4.0};
  const double low = std::min(std::abs(x), std::abs(y));
  const double high = std::max(std::abs(x), std::abs(y));
  double angle = 0.0;
  if (high > 0.0) {
    const double eighths = std::floor(8.0 * (low / high) + 0.5);
    const double t = (low - eighths / 8.0 * high) / (high + eighths / 8.0 * low);
    constexpr int kTerms = 7;
    double series = 0.0;
    for (int i = kTerms; i > 0; --i) series = t * t * (1.0 / (2 * i + 1) - series);
    angle = kAngles[static_cast<std::size_t>(eighths)] + (t - t * series);
  }
  if (std::abs(y) > std::abs(x)) angle = std::numbers::pi / 2.0 - angle;
  if (x < 0.0) angle = std::numbers::pi - angle;
  return std::copysign(angle, y);
}

double portable_log(double x) {
  // x = m 2^e with m within a factor of sqrt(2) of 1; log(m) = 2 atanh((m - 1) / (m + 1)).
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  if (m < std::numbers::sqrt2 / 2.0) {
    m *= 2.0;
    --exponent;
  }
  const double t = (m - 1.0) / (m + 1.0);
  constexpr int kTerms = 11;
  double series = 0.0;
  for (int i = kTerms; i > 0; --i) series = t * t * (series + 1.0 / (2 * i + 1));
  return exponent * std::numbers::ln2 + 2.0 * (t + t * series);
}

double portable_exp(double x) {
  // ln 2 in two parts; the multiples of the first that can occur are exact.
  constexpr double kHigh = 0x1.62e42fefa4p-1;
  constexpr double kLow = -0x1.8432a1b0e2634p-43;
  const double power = std::floor(x / std::numbers::ln2 + 0.5);
  const double rest = (x - power * kHigh) - power * kLow;
  constexpr int kTerms = 15;
  double series = 1.0;
  for (int i = kTerms; i > 0; --i) series = 1.0 + rest / i * series;
  return std::ldexp(series, static_cast<int>(power));
}

double portable_sin(double x) { return sine_after_quarters(x, 0); }

double portable_cos(double x) { return sine_after_quarters(x, 1); }

}  // namespace voxshell
