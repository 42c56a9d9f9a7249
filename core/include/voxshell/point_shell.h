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

  /// Metres that the shell may miss. Points are then as dense as the curvature asks for, corners
  /// are points and sharp edges are segments. Or leave it 0 and give:
  double tolerance = 0.0;
  /// About how many points a shell by tolerance may have; 0: as many as it takes. Where that is
  /// fewer, points are farther apart, and Accuracy::coverage says what is missed.
  std::size_t most_points = 0;
  /// Of the body's thinnest walls, metres, half of which points of a shell by tolerance are at most
  /// apart; 0: it is measured.
  double wall_thickness = 0.0;
  /// Edge of the sampling voxels, metres: one point a surface voxel. Or leave it 0 and give:
  double spacing = 0.0;
  /// How many points are wanted; reached within 1 %. The voxels of very regular meshes may then be
  /// those of a rotated grid.
  std::size_t target_points = 0;
  std::size_t point_limit = std::size_t{1} << 26;  ///< a larger shell is refused; <= kMostPoints
  unsigned threads = 0;                            ///< 0: one a core; the shell is the same
};

/// Points on a mesh's surface with outward unit normals and the area that each stands for, in the
/// order of their point-sphere tree. Metres, the mesh's frame; no two at the same place.
///
/// There is one point a surface voxel: the closest to the voxel's centre of the surface within it
/// (thesis, section 5.3). Where part of that surface faces away from the point, more than 90
/// degrees, as in thin plates and at sharp edges, it has a point of its own (three more at most: no
/// more than four directions face away from one another).
///
/// So no place of the surface is farther than sqrt(3) spacings, the diagonal of a voxel, from a
/// point, and none farther than that from a point that does not face away from it; as far as
/// float32 tells places apart, and but for needles, triangles narrower than a billionth of their
/// length, which face nowhere.
class PointShell {
 public:
  /// Those errors of build() that can be told before the work: kInvalidArgument, kTooLarge.
  static Result<std::monostate> check(const TriangleMesh& mesh, const PointShellSettings& settings);

  /// Errors: kInvalidArgument, kTooLarge, kCancelled.
  static Result<PointShell> build(const TriangleMesh& mesh, const PointShellSettings& settings,
                                  const Progress& progress = {});
  /// Only of what is visible of the mesh; null: of all.
  static Result<PointShell> build(const TriangleMesh& mesh, const VisibleSurface* visible,
                                  const PointShellSettings& settings, const Progress& progress);

  /// The same with more points, which stand for no area. They differ; those at the place of one
  /// that there is are left out.
  PointShell with_points(std::span<const Vec3f> points, std::span<const Vec3f> normals,
                         unsigned threads) const;

  /// What the functions below return.
  struct Parts {
    PointSphereTree tree;  ///< which holds the points
    std::vector<Vec3f> normals;
    std::vector<float> areas;
    double spacing = 0.0;
    std::optional<EdgeSegments> edges = {};
  };

  /// Checked: as many of each, finite, of unit length, no area below zero.
  static Result<PointShell> from_parts(Parts parts);

  std::size_t size() const { return tree_.point_count(); }
  BucketPoints points() const { return tree_.points(); }
  std::span<const Vec3f> normals() const { return normals_; }
  std::span<const float> areas() const { return areas_; }  ///< m2; they sum to the mesh's area
  /// Edge of the sampling voxels, metres; of a shell by tolerance, of the largest.
  double spacing() const { return spacing_; }
  const PointSphereTree& tree() const { return tree_; }

  /// The sharp edges of a shell by tolerance that has some; else null.
  const EdgeSegments* edges() const { return edges_ ? &*edges_ : nullptr; }

  // Elements of a shell are its points, by their ids, and then its edge segments, in the order of
  // their own tree. Contacts name them by these numbers.

  std::size_t element_count() const { return size() + (edges_ ? edges_->size() : 0); }
  bool is_point(std::uint32_t id) const { return id < size(); }
  /// The outward unit normal of an element; zero where the surface faces nowhere.
  const Vec3f& normal_of(std::uint32_t id) const {
    return is_point(id) ? normals_[id] : edges()->normals()[id - size()];
  }
  /// The surface that an element stands for, m2; edge segments have none.
  float area_of(std::uint32_t id) const { return is_point(id) ? areas_[id] : 0.0f; }
  /// The cluster of an element on a level. Those of edges follow on those of points.
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
