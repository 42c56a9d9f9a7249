#pragma once

#include <memory>
#include <variant>
#include <vector>

#include <btBulletCollisionCommon.h>

#include "voxshell/model.h"
#include "voxshell/pose.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell::python {

/// The shape of a body in the frame of its geometry. Meters.
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
/// Along z, centered at the origin; a capsule's length is the distance of its caps' centers.
struct CapsuleGeometry {
  double radius;
  double length;
};
struct CylinderGeometry {
  double radius;
  double length;
};
struct ConeGeometry {
  double radius;
  double height;
};
/// Bullet's own shapes for a mesh, as baselines. The margin is Bullet's collision margin.
struct GImpactGeometry {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
  double margin;
};
struct HullsGeometry {
  std::vector<std::vector<Vec3>> hulls;  ///< one: a convex hull; several: a compound of them
  double margin;
};

using PartGeometry =
    std::variant<ModelGeometry, PlaneGeometry, BoxGeometry, SphereGeometry, CapsuleGeometry,
                 CylinderGeometry, ConeGeometry, GImpactGeometry, HullsGeometry>;
/// Several geometries as one body.
struct CompoundGeometry {
  struct Part {
    PartGeometry geometry;
    Pose compound_from_part;
  };
  std::vector<Part> parts;
};

using Geometry =
    std::variant<ModelGeometry, PlaneGeometry, BoxGeometry, SphereGeometry, CapsuleGeometry,
                 CylinderGeometry, ConeGeometry, GImpactGeometry, HullsGeometry, CompoundGeometry>;

/// True if Bullet's shape is aligned with the axes of its own frame, so that a body with another
/// frame needs a compound around it.
bool is_axis_bound(const Geometry& geometry);

/// A Bullet shape with everything that it refers to.
class BulletShape {
 public:
  /// The geometry in the body's frame.
  BulletShape(const Geometry& geometry, const Pose& body_from_geometry);

  btCollisionShape* get() const { return shape_; }

 private:
  struct Placed {
    btCollisionShape* shape;
    Pose body_from_shape;
  };

  void make(const ModelGeometry& geometry, const Pose& body_from_geometry);
  void make(const PlaneGeometry& geometry, const Pose& body_from_geometry);
  void make(const BoxGeometry& geometry, const Pose& body_from_geometry);
  void make(const SphereGeometry& geometry, const Pose& body_from_geometry);
  void make(const CapsuleGeometry& geometry, const Pose& body_from_geometry);
  void make(const CylinderGeometry& geometry, const Pose& body_from_geometry);
  void make(const ConeGeometry& geometry, const Pose& body_from_geometry);
  void make(const GImpactGeometry& geometry, const Pose& body_from_geometry);
  void make(const HullsGeometry& geometry, const Pose& body_from_geometry);
  void make(const CompoundGeometry& geometry, const Pose& body_from_geometry);
  void place(std::unique_ptr<btCollisionShape> shape, const Pose& body_from_shape);

  /// The numbers that a Bullet mesh refers to.
  struct Mesh {
    std::vector<btScalar> vertices;
    std::vector<int> indices;
    std::unique_ptr<btStridingMeshInterface> triangles;
  };
  std::vector<std::unique_ptr<Mesh>> meshes_;
  std::vector<std::unique_ptr<btCollisionShape>> owned_;
  std::vector<Placed> placed_;
  btCollisionShape* shape_ = nullptr;
};

/// The convex hulls of sets of points as one triangle mesh, for mass properties and pictures.
/// Bullet rounds the corners to a grid: their error is up to 2e-4 of the hull's size.
struct HullMesh {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;
};
HullMesh triangulate_hulls(const std::vector<std::vector<Vec3>>& hulls);

/// The convex hull's vertices in the 42 directions that btShapeHull samples, as in the thesis.
std::vector<Vec3> sample_hull(const std::vector<Vec3>& points);

}  // namespace voxshell::python
