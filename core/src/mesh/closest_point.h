#pragma once

#include <array>

#include "voxshell/vector.h"

namespace voxshell {

/// Closest point of one triangle to `p` (Ericson, Real-Time Collision Detection, section 5.1.5).
/// Triangles without area answer with an edge or a vertex.
Vec3 closest_point_on_triangle(const Vec3& p, const std::array<Vec3, 3>& corners);

}  // namespace voxshell
