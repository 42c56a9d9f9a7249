#pragma once

#include "voxshell/point_shell.h"

namespace voxshell::bullet {

/// ContactSettings::margin where the user gives none, metres: a thousandth of the shell's diameter.
inline double default_rest_margin(const PointShell& shell) {
  constexpr double kOfDiameter = 1e-3;
  return kOfDiameter * 2.0 * static_cast<double>(shell.tree().spheres(1)[0].radius);
}

}  // namespace voxshell::bullet
