#pragma once

#include <algorithm>

#include "contact_constants.h"

namespace voxshell::bullet {

/// ContactSettings::margin where the user gives none, from the smaller body's radius and the
/// thinner body's thickness. Meters.
inline double default_rest_margin(double radius, double thickness) {
  return std::min(kRestMarginOfDiameter * 2.0 * radius, kRestMarginOfThickness * thickness);
}

}  // namespace voxshell::bullet
