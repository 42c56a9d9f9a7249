// The functions of the C library whose last bits differ between processors and versions, for all
// that links our own Bullet: the linker's --wrap (cmake/pinned_bullet.cmake) has calls of sin end
// in __wrap_sin, Bullet's own included. Thus motions have the same bits everywhere. C++ programs
// with a Bullet of their own call the C library.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/portable_math.h"

namespace voxshell::bullet {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// As many radians as portable_sin and portable_cos take.
double reduced(double radians) {
  constexpr double kMost = 1e5;
  return std::abs(radians) <= kMost ? radians : std::remainder(radians, 2.0 * std::numbers::pi);
}

double sine(double radians) {
  return std::isfinite(radians) ? portable_sin(reduced(radians)) : kNaN;
}

double cosine(double radians) {
  return std::isfinite(radians) ? portable_cos(reduced(radians)) : kNaN;
}

double angle_of(double y, double x) {
  if (std::isnan(x) || std::isnan(y)) return kNaN;
  const auto bounded = [](double value) {
    return std::isinf(value) ? std::copysign(1.0, value) : 0.0;
  };
  if (std::isinf(x) || std::isinf(y)) {
    y = std::copysign(bounded(y), y);
    x = std::copysign(bounded(x), x);
  }
  return portable_atan2(y, x);
}

/// Across from a side of length `x` in a triangle with hypotenuse 1; NaN beyond it.
double other_side(double x) { return std::sqrt((1.0 - x) * (1.0 + x)); }

double power(double base, double exponent) {
  if (exponent == 0.0 || base == 1.0) return 1.0;
  if (base == 0.0 && exponent > 0.0) return 0.0;
  const bool is_ordinary = std::isfinite(exponent) && base >= std::numeric_limits<double>::min() &&
                           base <= std::numeric_limits<double>::max();
  // Bullet damps velocities by a base of up to 1, and needs nothing else.
  if (!is_ordinary) return kNaN;
  constexpr double kMost = 708.0;  // of exponents of e whose powers are normal numbers
  const double of_e = exponent * portable_log(base);
  if (std::abs(of_e) <= kMost) return portable_exp(of_e);
  return of_e > 0.0 ? std::numeric_limits<double>::infinity() : 0.0;
}

double hypotenuse(double x, double y) {
  const double low = std::min(std::abs(x), std::abs(y));
  const double high = std::max(std::abs(x), std::abs(y));
  if (!(high > 0.0) || std::isinf(high)) return std::isnan(low) ? kNaN : high;
  const double ratio = low / high;
  return high * std::sqrt(1.0 + ratio * ratio);
}

}  // namespace
}  // namespace voxshell::bullet

// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming): names that the linker
// sets.
extern "C" {
double __wrap_sin(double x) { return voxshell::bullet::sine(x); }
double __wrap_cos(double x) { return voxshell::bullet::cosine(x); }
void __wrap_sincos(double x, double* sine, double* cosine) {
  *sine = voxshell::bullet::sine(x);
  *cosine = voxshell::bullet::cosine(x);
}
double __wrap_atan2(double y, double x) { return voxshell::bullet::angle_of(y, x); }
double __wrap_acos(double x) {
  return voxshell::bullet::angle_of(voxshell::bullet::other_side(x), x);
}
double __wrap_asin(double x) {
  return voxshell::bullet::angle_of(x, voxshell::bullet::other_side(x));
}
double __wrap_pow(double base, double exponent) { return voxshell::bullet::power(base, exponent); }
double __wrap_hypot(double x, double y) { return voxshell::bullet::hypotenuse(x, y); }
}
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)
