#pragma once

namespace voxshell::bullet {

/// ContactSettings::margin where the user gives none, metres: a thousandth of the diameter of the
/// smaller body, of which this is the radius.
inline double default_rest_margin(double radius) {
  constexpr double kOfDiameter = 1e-3;
  return kOfDiameter * 2.0 * radius;
}

}  // namespace voxshell::bullet
