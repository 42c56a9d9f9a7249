#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "voxshell/point_shell.h"
#include "voxshell/triangle_mesh.h"
#include "voxshell/vector.h"

namespace voxshell {

class BoxFinder;
class DistanceTree;

/// The smooth surface that a mesh of small facets represents.
///
/// Each triangle carries a quadratic patch through its corners: Phong tessellation (Boubekeur and
/// Alexa 2008) with a shape factor of one half, with which patches equal spheres and cylinders to
/// second order. Normals of corners are the means of those of the faces around them, weighted by
/// their angles and squared areas. Edges that bend by more than kMostBend are creases: a mesh with
/// such facets is a polyhedron, and its patches are flat. Meters, the mesh's frame.
class SmoothSurface {
 public:
  /// Radians. A turn of 30 facets is round, and one of 29 has edges.
  static constexpr double kMostBend = 0.2095;

  /// A place on a triangle's patch. The weights belong to its corners and sum to 1.
  struct Place {
    std::uint32_t triangle;
    std::array<double, 3> weights;
  };

  /// Builds the surface of a mesh, which must outlive it, and of the elements of its shell.
  SmoothSurface(const TriangleMesh& mesh, const PointShell& shell);
  ~SmoothSurface();
  SmoothSurface(const SmoothSurface&) = delete;
  SmoothSurface& operator=(const SmoothSurface&) = delete;

  /// Whether any patch is curved.
  bool is_curved() const { return most_lift_ > 0.0f; }
  bool is_flat(std::uint32_t triangle) const { return lifts_[triangle] == 0.0f; }

  /// The triangle that an element of the shell lies on; at a crease between a flat patch and a
  /// curved one, the curved one. Only for curved surfaces.
  std::uint32_t triangle_of(std::uint32_t element) const { return triangle_of_element_[element]; }

  /// Whether the element lies on a flat patch whose normal has at least this cosine with a
  /// direction, including at a crease to a curved one. Only for curved surfaces.
  bool lies_flat(std::uint32_t element, const Vec3& direction, double cosine) const;

  /// Largest distance of a patch from its triangle, meters; 0 if the patch is flat.
  float lift(std::uint32_t triangle) const { return lifts_[triangle]; }
  float most_lift() const { return most_lift_; }
  /// Whether the surface ends or bends sharply there.
  bool is_at_crease(const Place& place) const;
  Vec3 position(const Place& place) const;
  Vec3 normal(const Place& place) const;  ///< unit length

  struct TangentPlane {
    Vec3 position;
    Vec3 normal;  ///< unit length
  };
  TangentPlane tangent_plane(const Place& place) const;

  /// The place of a triangle that is nearest to a point.
  Place nearest_on(std::uint32_t triangle, const Vec3& point) const;
  /// The nearest place of the surface to a point; exact if the point is near. A near triangle as a
  /// guess shortens the search.
  Place nearest(const Vec3& point, std::uint32_t guess = 0) const;
  /// The nearest place of the flat triangles to a point, found by walking over adjacent ones.
  Place below(const Place& start, const Vec3& point) const;
  /// The nearest place of the surface to a point, found in the same way; none if it is more than a
  /// few triangles away. It need not be the nearest of all.
  std::optional<Place> nearest_from(const Place& start, const Vec3& point) const;

  /// The result of a slide.
  struct Slide {
    Place place;
    bool is_at_rest;  ///< no place beside it is farther along; never where the surface is concave
  };
  /// Slides from triangle to triangle to the place of the surrounding surface that is farthest
  /// along `direction`. It moves only along directions in which the surface is convex by at least
  /// `least_curvature`, 1/meters: along a cylinder's axis it stays. At creases it continues along
  /// them.
  Slide slide(const Place& start, const Vec3& direction, double least_curvature) const;

 private:
  using Weights = std::array<double, 3>;  ///< of a triangle's corners, or a change of them
  struct Beside;
  struct Chart;
  struct Height;
  struct Nearness;

  void connect(std::span<const Vec3> face_normals);
  std::vector<double> measure_faces(std::span<const Vec3> face_normals) const;
  void average_normals(std::span<const Vec3> face_normals);
  void sharpen_tips(std::span<const Vec3> face_normals);
  void measure_lifts(std::span<const Vec3> face_normals);
  void find_elements(const PointShell& shell);
  void build_tree();
  std::uint32_t nearest_triangle(const Vec3& place, std::uint32_t guess) const;
  Beside find_beside(const Vec3& place, double distance, const BoxFinder& finder) const;
  Chart chart_of(std::uint32_t triangle) const;
  std::array<Vec3, 3> normals_of(std::uint32_t triangle) const;
  Place across(const Place& place, std::size_t side) const;
  template <class F>
  std::optional<Place> project(const Vec3& point, Place place, const F& find) const;
  double along_side(std::uint32_t triangle, const Weights& way, std::size_t side) const;
  template <class Objective>
  Slide climb(Place place, const Objective& objective, int most_triangles) const;

  const TriangleMesh* mesh_;
  std::vector<std::array<std::uint32_t, 3>> neighbors_;  ///< across from each corner, if smooth
  std::vector<std::array<std::uint32_t, 3>> corner_normals_;
  std::vector<Vec3f> normals_;
  std::vector<float> lifts_;
  std::vector<std::uint32_t> triangle_of_element_;
  std::vector<std::uint32_t> flat_of_element_;  ///< the flat one that it lies on, too, if any
  float most_lift_ = 0.0f;
  std::unique_ptr<const DistanceTree> tree_;
  std::vector<std::int32_t> guesses_;  ///< for the tree, of places near each triangle
  double unit_ = 1.0;                  ///< of the tree's lengths, meters
};

}  // namespace voxshell
