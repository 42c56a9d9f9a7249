#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "bodies.h"
#include "voxshell/pose.h"

namespace voxshell::benchmarks {

/// Metres; negative: clearance.
struct DepthRange {
  double low;
  double high;
};

/// Poses, field_from_shell, at which the deepest point of a shell lies within `range`, told by the
/// flat loop. The same on every run. Ends the program where some depth cannot be reached.

/// The bunny upright above the plane z = 0, turned about the vertical, tilted by up to 0.2 degrees.
std::vector<Pose> make_resting_poses(Bodies& bodies, const Field& plane, const PointShell& shell,
                                     DepthRange range, std::size_t count);

/// From where one bunny is drawn out of the other.
enum class DrawnFrom {
  kCentres,  ///< of their bounds, one in the other
  kCore,     ///< a random point of the shell in the deepest place of the other: reaches any depth
};

/// The bunny in the bunny, in any orientation, drawn out in a random direction.
std::vector<Pose> make_pair_poses(Bodies& bodies, const Field& bunny, const PointShell& shell,
                                  DepthRange range, DrawnFrom drawn_from, std::size_t count);

/// Any orientation, origins anywhere up to `reach` apart.
std::vector<Pose> make_random_poses(double reach, std::size_t count);

}  // namespace voxshell::benchmarks
