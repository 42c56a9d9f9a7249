#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "voxshell/point_shell.h"
#include "voxshell/triangle_mesh.h"
#include "voxshell/vector.h"

namespace voxshell {

class TriangleFinder;
struct SmoothPatches;

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
  bool is_curved() const;
  bool is_flat(std::uint32_t triangle) const;

  /// The triangle that an element of the shell lies on; at a crease between a flat patch and a
  /// curved one, the curved one. Only for curved surfaces.
  std::uint32_t triangle_of(std::uint32_t element) const;

  /// Whether the element lies on a flat patch whose normal has at least this cosine with a
  /// direction, including at a crease to a curved one. Only for curved surfaces.
  bool lies_flat(std::uint32_t element, const Vec3& direction, double cosine) const;

  /// Largest distance of a patch from its triangle, meters; 0 if the patch is flat.
  float lift(std::uint32_t triangle) const;
  float most_lift() const;
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
  struct Chart;
  struct Height;
  struct Nearness;

  Chart chart_of(std::uint32_t triangle) const;
  Place across(const Place& place, std::size_t side) const;
  template <class F>
  std::optional<Place> project(const Vec3& point, Place place, const F& find) const;
  double along_side(std::uint32_t triangle, const Weights& way, std::size_t side) const;
  template <class Objective>
  Slide climb(Place place, const Objective& objective, int most_triangles) const;

  const TriangleMesh* mesh_;
  std::unique_ptr<const TriangleFinder> finder_;
  std::unique_ptr<const SmoothPatches> patches_;
};

}  // namespace voxshell
