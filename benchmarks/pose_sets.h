#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bodies.h"
#include "voxshell/pose.h"

namespace voxshell::benchmarks {

/// Meters; negative: clearance.
struct DepthRange {
  double low;
  double high;
};

/// Poses, field_from_shell, found by bisection with the flat loop: those of pairs by the depth of
/// the deepest point. The same on every run; fewer than asked for, or none,
/// where a depth cannot be reached in this field.

/// The fine shell upright on the plane z = 0, turned about the vertical, tilted by up to 0.2
/// degrees, as deep as gives about 355 contacts of 34,835: some 1 to 1.5 mm.
std::vector<Pose> make_resting_poses(Bodies& bodies, std::size_t count);

/// From where one bunny is drawn out of the other.
enum class DrawnFrom {
  kCenters,  ///< of their bounds, one in the other
  kCore,     ///< a random point of the shell in the deepest place of the other: reaches any depth
};

/// The bunny in the bunny, in any orientation, drawn out in a random direction.
std::vector<Pose> make_pair_poses(Bodies& bodies, const Field& bunny, const PointShell& shell,
                                  DepthRange range, DrawnFrom drawn_from, std::size_t count);

/// Any orientation, origins anywhere up to `reach` apart.
std::vector<Pose> make_random_poses(double reach, std::size_t count);

}  // namespace voxshell::benchmarks
