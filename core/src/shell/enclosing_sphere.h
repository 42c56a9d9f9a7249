#pragma once

#include <cstdint>
#include <span>

#include "voxshell/point_sphere_tree.h"

namespace voxshell {

/// The smallest sphere around the points, one at least, that `ids` selects (Welzl 1991, with the
/// move to front and the farthest point first, Gaertner 1999). Allocates for more than 16 points.
/// The center is exact to rounding; the radius is rounded up, so every point is inside.
Sphere compute_enclosing_sphere(std::span<const Vec3f> points, std::span<const std::uint32_t> ids);

}  // namespace voxshell
