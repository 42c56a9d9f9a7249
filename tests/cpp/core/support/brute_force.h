#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "voxshell/triangle_mesh.h"
#include "voxshell/vector.h"

namespace voxshell::test_support {

/// Slow answers that share no code with the library.

inline double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 ab = b - a;
  const double squared = squared_length(ab);
  const double t = squared > 0.0 ? std::clamp(dot(p - a, ab) / squared, 0.0, 1.0) : 0.0;
  return length(p - (a + t * ab));
}

/// By the foot of the perpendicular where it falls into the triangle, else by the three sides.
inline double distance_to_triangle(const Vec3& p, const std::array<Vec3, 3>& c) {
  double nearest = std::min({distance_to_segment(p, c[0], c[1]), distance_to_segment(p, c[1], c[2]),
                             distance_to_segment(p, c[2], c[0])});
  const Vec3 normal = cross(c[1] - c[0], c[2] - c[0]);
  const double doubled_area = length(normal);
  if (doubled_area == 0.0) return nearest;
  bool within = true;
  for (std::size_t i = 0; i < 3; ++i) {
    within = within && dot(cross(c[(i + 1) % 3] - c[i], p - c[i]), normal) >= 0.0;
  }
  return within ? std::min(nearest, std::abs(dot(p - c[0], normal)) / doubled_area) : nearest;
}

inline double distance_to_mesh(const Vec3& p, const TriangleMesh& mesh) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < mesh.triangles().size(); ++i) {
    nearest = std::min(nearest, distance_to_triangle(p, mesh.corners(i)));
  }
  return nearest;
}

/// How often a mesh winds around a point: 1 inside, 0 outside (Van Oosterom and Strackee 1983).
inline double winding_number(const Vec3& p, const TriangleMesh& mesh) {
  double solid_angle = 0.0;
  for (std::size_t i = 0; i < mesh.triangles().size(); ++i) {
    const auto corners = mesh.corners(i);
    const Vec3 a = corners[0] - p;
    const Vec3 b = corners[1] - p;
    const Vec3 c = corners[2] - p;
    const double la = length(a);
    const double lb = length(b);
    const double lc = length(c);
    solid_angle += 2.0 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc +
                                                             dot(b, c) * la + dot(c, a) * lb);
  }
  constexpr double kFullSphere = 12.566370614359172;
  return solid_angle / kFullSphere;
}

inline double signed_distance_to_mesh(const Vec3& p, const TriangleMesh& mesh) {
  const double distance = distance_to_mesh(p, mesh);
  return winding_number(p, mesh) > 0.5 ? -distance : distance;
}

}  // namespace voxshell::test_support
