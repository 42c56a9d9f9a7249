#pragma once

#include <memory>
#include <variant>
#include <vector>

#include <btBulletCollisionCommon.h>

#include "voxshell/model.h"
#include "voxshell/pose.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell::python {

/// What a body is made of, in the frame of its geometry. Metres.
struct ModelGeometry {
  std::shared_ptr<const Model> model;
};
struct PlaneGeometry {
  Vec3 normal;
  double offset;
};
struct BoxGeometry {
  Vec3 half_extents;
};
struct SphereGeometry {
  double radius;
};
/// Bullet's own ways with a mesh, for comparison. The margin is Bullet's collision margin.
struct GImpactGeometry {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  double margin;
};
struct HullsGeometry {
  std::vector<std::vector<Vec3>> hulls;  ///< one: a convex hull; more: a compound of them
  double margin;
};

using Geometry = std::variant<ModelGeometry, PlaneGeometry, BoxGeometry, SphereGeometry,
                              GImpactGeometry, HullsGeometry>;

/// A Bullet shape with all that it refers to.
class BulletShape {
 public:
  /// The geometry as seen from the body's frame.
  BulletShape(const Geometry& geometry, const Pose& body_from_geometry);

  btCollisionShape* get() const { return parts_.back().get(); }

 private:
  void make(const ModelGeometry& geometry, const Pose& body_from_geometry);
  void make(const PlaneGeometry& geometry, const Pose& body_from_geometry);
  void make(const BoxGeometry& geometry, const Pose& body_from_geometry);
  void make(const SphereGeometry& geometry, const Pose& body_from_geometry);
  void make(const GImpactGeometry& geometry, const Pose& body_from_geometry);
  void make(const HullsGeometry& geometry, const Pose& body_from_geometry);

  std::vector<btScalar> vertices_;
  std::vector<int> indices_;
  std::unique_ptr<btStridingMeshInterface> mesh_;
  std::vector<std::unique_ptr<btCollisionShape>> parts_;  ///< children first, the shape last
};

/// The convex hulls of sets of points as one mesh of triangles, for mass properties and pictures.
/// Bullet rounds the corners to a grid: they are off by up to 2e-4 of the hull's size.
struct HullMesh {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
};
HullMesh triangulate_hulls(const std::vector<std::vector<Vec3>>& hulls);

/// The convex hull's vertices in the 42 directions that btShapeHull samples: the thesis' hull.
std::vector<Vec3> sample_hull(const std::vector<Vec3>& points);

}  // namespace voxshell::python
