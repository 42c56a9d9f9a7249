#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "voxshell/bounds.h"
#include "voxshell/progress.h"
#include "voxshell/result.h"
#include "voxshell/triangle_mesh.h"
#include "voxshell/vector.h"

namespace voxshell {

struct GridFieldSettings {
  double voxel_size = 0.0;  ///< edge of a cell, metres
  double padding = 0.0;     ///< metres of grid beyond the mesh's bounds; at least one voxel is kept
  unsigned threads = 0;     ///< 0: one a core; the result is the same for any number
  std::size_t memory_limit = std::size_t{4} << 30;  ///< bytes; a larger grid is refused
};

/// The signed distance field of a closed mesh: exact distances at the nodes of a regular grid
/// (float32), trilinear between them. Negative inside, by the winding number, so that folds smaller
/// than a voxel do no harm; metres, the mesh's frame.
///
/// Outside the grid the value is the one at the nearest point of the grid plus the distance to it:
/// continuous, and never less than the true distance minus interpolation_error().
class GridField {
 public:
  /// Errors: kInvalidArgument, kInvalidMesh (not closed, inside out, overlapping itself),
  /// kTooLarge, kCancelled.
  static Result<GridField> build(const TriangleMesh& mesh, const GridFieldSettings& settings,
                                 const Progress& progress = {});

  float distance(const Vec3f& p) const;

  /// The exact gradient of distance(); its length is near 1 except close to the medial axis.
  Vec3f gradient(const Vec3f& p) const;

  /// No point within `radius` of `centre` has a smaller distance.
  float lower_bound(const Vec3f& centre, float radius) const;

  double reach() const;

  double voxel_size() const { return voxel_size_; }
  const Vec3& origin() const { return origin_; }               ///< position of the first node
  const std::array<int, 3>& shape() const { return shape_; }   ///< nodes along x, y, z
  std::span<const float> samples() const { return samples_; }  ///< x fastest, then y, then z
  std::size_t nbytes() const { return samples_.size() * sizeof(float); }
  const Bounds& surface_bounds() const { return surface_bounds_; }

  /// |distance() - true distance| is at most this, metres: the true distance is 1-Lipschitz, and
  /// the corners of a cell are at most sqrt(3)/2 voxel from a point of it in the trilinear mean.
  double interpolation_error() const;

  /// No two points of the grid differ in distance() by more than this times their separation.
  double lipschitz_constant() const { return lipschitz_constant_; }

 private:
  struct Cell;

  GridField() = default;
  Cell locate(const Vec3f& p) const;
  double compute_lipschitz_constant() const;

  double voxel_size_ = 0.0;
  Vec3 origin_{};
  std::array<int, 3> shape_{};
  std::vector<float> samples_;
  Bounds surface_bounds_;
  double lipschitz_constant_ = 1.0;
};

}  // namespace voxshell
