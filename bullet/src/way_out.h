#pragma once

#include <optional>

#include "posed_pair.h"

namespace voxshell::bullet {

/// How a body leaves another that it overlaps.
struct WayOut {
  Vec3 direction;   ///< unit length, the shell's frame
  double distance;  ///< meters
};

/// The shortest displacement of the shell's body, of those along either body's axes and diagonals
/// and along the line between their middles, after which no place of either surface is deeper in
/// the other body than `tolerance`, meters. Distances grow by a quarter, and the last step is
/// halved until it is within the tolerance. None where the bodies do not overlap. Takes
/// milliseconds: for bodies whose contacts tell no way. Decision 38.
std::optional<WayOut> find_way_out(const PosedPair& pair, double tolerance);

}  // namespace voxshell::bullet
