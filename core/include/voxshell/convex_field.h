#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "voxshell/result.h"
#include "voxshell/triangle_mesh.h"
#include "voxshell/vector.h"

namespace voxshell {

namespace simd {
struct ConvexView;
}

/// A solid convex polyhedron: the largest of the signed distances to the planes of its faces. Exact
/// inside, and where the nearest point of the surface is on a face; less than the true distance
/// beyond edges and corners. Meters, the mesh's frame.
class ConvexField {
 public:
  static constexpr std::size_t kMostFaces = 4096;

  /// Triangles in one plane, to 1e-6 of the mesh's longest side, become one face. `tangents` are
  /// outward unit normals of planes that touch the mesh at an edge or a corner. They bring the
  /// distances beyond it nearer to the true ones, and count as faces. Errors: kInvalidMesh (not
  /// closed, inside out, not convex, or thinner than 1e-5 of its longest side), kTooLarge (more
  /// than kMostFaces faces).
  static Result<ConvexField> create(const TriangleMesh& mesh, std::span<const Vec3> tangents = {});

  float distance(const Vec3f& p) const;

  /// The normal of the face whose plane determines distance(); the larger face's if they tie. Unit
  /// length.
  Vec3f gradient(const Vec3f& p) const;

  /// No point within `radius` of `center` has a smaller distance.
  float lower_bound(const Vec3f& center, float radius) const;

  /// The largest coordinate that matters to rounding, meters.
  double reach() const { return reach_; }

  std::size_t face_count() const { return planes_.size() / 4; }

  simd::ConvexView view() const;

 private:
  ConvexField() = default;

  std::vector<float> planes_;  ///< outward unit normal and offset of each
  double reach_ = 0.0;
  std::uint64_t serial_ = 0;
};

}  // namespace voxshell
