#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "voxshell/triangle_mesh.h"

namespace voxshell {

/// Parts of a mesh that are flat: connected triangles whose corners lie on one plane, that of the
/// largest of them.
class FlatRegions {
 public:
  /// Corners may be off the plane by `tolerance`, meters.
  FlatRegions(const TriangleMesh& mesh, double tolerance);

  struct Plane {
    Vec3 normal;  ///< unit length, outwards
    double offset;
  };

  std::uint32_t region_of(std::uint32_t triangle) const { return regions_[triangle]; }
  const Plane& plane(std::uint32_t region) const { return planes_[region]; }

  /// True where the triangles are of one region, and every line through the cube along its normal
  /// meets the region or none does.
  bool spans_cube(std::span<const std::uint32_t> triangles, const Vec3& center,
                  double half_edge) const;

 private:
  const TriangleMesh& mesh_;
  std::vector<std::uint32_t> regions_;
  std::vector<Plane> planes_;
  std::vector<std::uint8_t> rims_;  ///< bit i: beyond side i of the triangle is another region
};

}  // namespace voxshell
