#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/triangle_finder.h"
#include "voxshell/point_shell.h"
#include "voxshell/triangle_mesh.h"
#include "voxshell/vector.h"

namespace voxshell {

/// The patches of a SmoothSurface, one for each triangle of its mesh. Meters, the mesh's frame.
struct SmoothPatches {
  std::vector<std::array<std::uint32_t, 3>> neighbors;       ///< across from each corner, if smooth
  std::vector<std::array<std::uint32_t, 3>> corner_normals;  ///< indices of `normals`
  std::vector<Vec3f> normals;                                ///< unit length
  std::vector<float> lifts;  ///< largest distances of patches from their triangles
  float most_lift = 0.0f;
  // Of each element of the shell; empty if no patch is curved.
  std::vector<std::uint32_t> triangle_of_element;  ///< the curved one that it lies on, if any
  std::vector<std::uint32_t> flat_of_element;      ///< the flat one that it lies on, if any

  bool is_flat(std::uint32_t triangle) const { return lifts[triangle] == 0.0f; }
  std::array<Vec3, 3> normals_of(std::uint32_t triangle) const {
    const auto& of = corner_normals[triangle];
    return {static_cast<Vec3>(normals[of[0]]), static_cast<Vec3>(normals[of[1]]),
            static_cast<Vec3>(normals[of[2]])};
  }
};

/// Builds the patches of a mesh, and finds those of its shell's elements. The finder is the mesh's.
SmoothPatches build_smooth_patches(const TriangleMesh& mesh, const PointShell& shell,
                                   const TriangleFinder& finder);

constexpr std::size_t kCorners = 3;
constexpr std::size_t next_corner(std::size_t corner) {
  return corner + 1 == kCorners ? 0 : corner + 1;
}
constexpr std::size_t previous_corner(std::size_t corner) {
  return next_corner(next_corner(corner));
}

/// Half of what Phong tessellation projects: see SmoothSurface.
constexpr double kShapeFactor = 0.5;

inline Vec3 weighted_sum(const std::array<double, 3>& weights, const std::array<Vec3, 3>& of) {
  return weights[0] * of[0] + weights[1] * of[1] + weights[2] * of[2];
}

/// Of a patch by the corners of its triangle and their normals.
inline Vec3 position_on(const std::array<Vec3, 3>& corners, const std::array<Vec3, 3>& normals,
                        const std::array<double, 3>& weights) {
  const Vec3 flat = weighted_sum(weights, corners);
  Vec3 lift;
  for (std::size_t i = 0; i < kCorners; ++i) {
    lift += weights[i] * dot(corners[i] - flat, normals[i]) * normals[i];
  }
  return flat + kShapeFactor * lift;
}

inline Vec3 face_normal(const std::array<Vec3, 3>& corners) {
  return normalized(cross(corners[1] - corners[0], corners[2] - corners[0]));
}

}  // namespace voxshell
