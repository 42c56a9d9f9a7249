#pragma once

#include <algorithm>

namespace voxshell::bullet {

/// ContactSettings::margin where the user gives none, metres: a thousandth of the diameter of the
/// smaller body, of which this is the radius, but no more than a 20th of what the thinner one is
/// thick: a plate of which both sides are within the margin would rest on either.
inline double default_rest_margin(double radius, double thickness) {
  constexpr double kOfDiameter = 1e-3;
  constexpr double kOfThickness = 0.05;
  return std::min(kOfDiameter * 2.0 * radius, kOfThickness * thickness);
}

}  // namespace voxshell::bullet
