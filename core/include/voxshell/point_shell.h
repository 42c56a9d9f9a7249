#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "voxshell/edge_segments.h"
#include "voxshell/point_sphere_tree.h"
#include "voxshell/progress.h"
#include "voxshell/result.h"
#include "voxshell/triangle_mesh.h"
#include "voxshell/vector.h"

namespace voxshell {

struct VisibleSurface;

struct PointShellSettings {
  static constexpr std::size_t kMostPoints = std::size_t{1} << 28;

  /// Depth that the shell may miss, meters. The density of points then follows from the curvature,
  /// corners are points, and sharp edges are segments. For a uniform shell, leave it 0 and give:
  double tolerance = 0.0;
  /// Approximate maximum of points of a shell by tolerance; 0: no maximum. If it needs more, points
  /// are farther apart, and Accuracy::coverage states what is missed.
  std::size_t most_points = 0;
  /// Thickness of the body's thinnest walls, meters. Points of a shell by tolerance are at most
  /// half of it apart. 0: measure it.
  double wall_thickness = 0.0;
  /// Edge of the sampling voxels, meters: one point per surface voxel. Or leave it 0 and give:
  double spacing = 0.0;
  /// Wanted number of points; reached within 1 %. For very regular meshes, the voxels may be those
  /// of a rotated grid.
  std::size_t target_points = 0;
  std::size_t point_limit = std::size_t{1} << 26;  ///< a larger shell is refused; <= kMostPoints
  unsigned threads = 0;                            ///< 0: one per core; all give the same
};

/// Points on a mesh's surface with outward unit normals and the area that each stands for, in the
/// order of their point-sphere tree. Meters, the mesh's frame; no two points are at the same place.
///
/// There is one point per surface voxel: the place of the surface within the voxel that is closest
/// to its center (thesis, section 5.3). If some of that surface faces away from the point by more
/// than 90 degrees, as in thin plates and at sharp edges, it has a point of its own. There are at
/// most three more, because no more than four directions face away from one another.
///
/// Therefore every place of the surface is within sqrt(3) spacings, the diagonal of a voxel, of a
/// point that does not face away from it. This holds to the precision of float32, and except for
/// needles, triangles narrower than a billionth of their length, which have no direction.
class PointShell {
 public:
  /// The errors of build() that can be found before the work: kInvalidArgument, kTooLarge.
  static Result<std::monostate> check(const TriangleMesh& mesh, const PointShellSettings& settings);

  /// Errors: kInvalidArgument, kTooLarge, kCanceled.
  static Result<PointShell> build(const TriangleMesh& mesh, const PointShellSettings& settings,
                                  const Progress& progress = {});
  /// Samples only what is visible of the mesh; null: all of it.
  static Result<PointShell> build(const TriangleMesh& mesh, const VisibleSurface* visible,
                                  const PointShellSettings& settings, const Progress& progress);

  /// Adds points, which stand for no area. The new points are distinct; those at the place of an
  /// existing point are left out.
  PointShell with_points(std::span<const Vec3f> points, std::span<const Vec3f> normals,
                         unsigned threads) const;

  /// The results of the functions below.
  struct Parts {
    PointSphereTree tree;  ///< which holds the points
    std::vector<Vec3f> normals;
    std::vector<float> areas;
    double spacing = 0.0;
    std::optional<EdgeSegments> edges = {};
  };

  /// Checks the data: equal counts, finite values, unit length, no negative area.
  static Result<PointShell> from_parts(Parts parts);

  std::size_t size() const { return tree_.point_count(); }
  BucketPoints points() const { return tree_.points(); }
  std::span<const Vec3f> normals() const { return normals_; }
  std::span<const float> areas() const { return areas_; }  ///< m2; they sum to the mesh's area
  /// Edge of the sampling voxels, meters; for a shell by tolerance, that of the largest.
  double spacing() const { return spacing_; }
  const PointSphereTree& tree() const { return tree_; }

  /// The sharp edges of a shell by tolerance, or null if it has none.
  const EdgeSegments* edges() const { return edges_ ? &*edges_ : nullptr; }

  // Elements of a shell are its points, by their ids, and then its edge segments, in the order of
  // their own tree. Contacts name them by these numbers.

  std::size_t element_count() const { return size() + (edges_ ? edges_->size() : 0); }
  bool is_point(std::uint32_t id) const { return id < size(); }
  /// The outward unit normal of an element; zero if the surface has no direction there.
  const Vec3f& normal_of(std::uint32_t id) const {
    return is_point(id) ? normals_[id] : edges()->normals()[id - size()];
  }
  /// The surface that an element stands for, m2; edge segments have none.
  float area_of(std::uint32_t id) const { return is_point(id) ? areas_[id] : 0.0f; }
  /// The cluster of an element on a level. Clusters of edges are numbered after those of points.
  std::uint32_t segment_of(std::uint32_t id, int level) const;
  /// The half-open range of the elements of a segment.
  PointRange segment_elements(int level, std::uint32_t segment) const;

 private:
  PointShell() = default;

  PointSphereTree tree_;
  std::vector<Vec3f> normals_;
  std::vector<float> areas_;
  double spacing_ = 0.0;
  std::optional<EdgeSegments> edges_;
};

}  // namespace voxshell
