#include "bullet/shapes.h"

#include <algorithm>

#include <BulletCollision/CollisionShapes/btShapeHull.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <LinearMath/btConvexHullComputer.h>

#include "voxshell/bullet/convert.h"
#include "voxshell/bullet/model_shape.h"

namespace voxshell::python {
using bullet::from_bullet;
using bullet::to_bullet;

namespace {

std::unique_ptr<btConvexHullShape> make_hull(const std::vector<Vec3>& points,
                                             const Pose& body_from_geometry, double margin) {
  auto hull = std::make_unique<btConvexHullShape>();
  for (const Vec3& p : points) {
    hull->addPoint(to_bullet(body_from_geometry.transform_point(p)), false);
  }
  hull->setMargin(margin);
  hull->recalcLocalAabb();
  return hull;
}

/// Compounds skip children whose bounds are apart, so models' bounds include their contact margin.
void widen(btCollisionShape& shape) {
  if (shape.getShapeType() != FAST_CONCAVE_MESH_PROXYTYPE) return;
  constexpr double kOfRadius = 0.05;
  btVector3 center;
  btScalar radius = 0.0;
  shape.getBoundingSphere(center, radius);
  shape.setMargin(std::max(shape.getMargin(), kOfRadius * radius));
}

}  // namespace

bool is_axis_bound(const Geometry& geometry) {
  return !std::holds_alternative<ModelGeometry>(geometry) &&
         !std::holds_alternative<GImpactGeometry>(geometry) &&
         !std::holds_alternative<HullsGeometry>(geometry);
}

BulletShape::BulletShape(const Geometry& geometry, const Pose& body_from_geometry) {
  std::visit([&](const auto& typed) { make(typed, body_from_geometry); }, geometry);
  if (placed_.size() == 1 && to_bullet(placed_[0].body_from_shape) == btTransform::getIdentity()) {
    shape_ = placed_[0].shape;
    return;
  }
  auto compound = std::make_unique<btCompoundShape>();
  for (const Placed& part : placed_) {
    widen(*part.shape);
    compound->addChildShape(to_bullet(part.body_from_shape), part.shape);
  }
  shape_ = compound.get();
  owned_.push_back(std::move(compound));
}

void BulletShape::place(std::unique_ptr<btCollisionShape> shape, const Pose& body_from_shape) {
  placed_.push_back({shape.get(), body_from_shape});
  owned_.push_back(std::move(shape));
}

void BulletShape::make(const ModelGeometry& geometry, const Pose& body_from_geometry) {
  place(std::make_unique<bullet::ModelShape>(geometry.model, body_from_geometry), {});
}

void BulletShape::make(const PlaneGeometry& geometry, const Pose& body_from_geometry) {
  place(std::make_unique<btStaticPlaneShape>(to_bullet(geometry.normal), geometry.offset),
        body_from_geometry);
}

void BulletShape::make(const BoxGeometry& geometry, const Pose& body_from_geometry) {
  place(std::make_unique<btBoxShape>(to_bullet(geometry.half_extents)), body_from_geometry);
}

void BulletShape::make(const SphereGeometry& geometry, const Pose& body_from_geometry) {
  place(std::make_unique<btSphereShape>(geometry.radius), body_from_geometry);
}

void BulletShape::make(const CapsuleGeometry& geometry, const Pose& body_from_geometry) {
  place(std::make_unique<btCapsuleShapeZ>(geometry.radius, geometry.length), body_from_geometry);
}

void BulletShape::make(const CylinderGeometry& geometry, const Pose& body_from_geometry) {
  place(std::make_unique<btCylinderShapeZ>(
            btVector3(geometry.radius, geometry.radius, geometry.length / 2.0)),
        body_from_geometry);
}

void BulletShape::make(const ConeGeometry& geometry, const Pose& body_from_geometry) {
  auto cone = std::make_unique<btConeShapeZ>(geometry.radius, geometry.height);
  cone->setMargin(0.0);  // Bullet would add the margin to a cone
  place(std::move(cone), body_from_geometry);
}

void BulletShape::make(const GImpactGeometry& geometry, const Pose& body_from_geometry) {
  auto mesh = std::make_unique<Mesh>();
  mesh->vertices.reserve(3 * geometry.vertices.size());
  for (const Vec3& vertex : geometry.vertices) {
    const Vec3 p = body_from_geometry.transform_point(vertex);
    mesh->vertices.insert(mesh->vertices.end(), {p.x, p.y, p.z});
  }
  mesh->indices.reserve(3 * geometry.triangles.size());
  for (const Triangle& triangle : geometry.triangles) {
    for (const std::uint32_t index : triangle) mesh->indices.push_back(static_cast<int>(index));
  }
  mesh->triangles = std::make_unique<btTriangleIndexVertexArray>(
      static_cast<int>(geometry.triangles.size()), mesh->indices.data(),
      static_cast<int>(3 * sizeof(int)), static_cast<int>(geometry.vertices.size()),
      mesh->vertices.data(), static_cast<int>(3 * sizeof(btScalar)));
  auto shape = std::make_unique<btGImpactMeshShape>(mesh->triangles.get());
  shape->setMargin(geometry.margin);
  shape->updateBound();
  meshes_.push_back(std::move(mesh));
  place(std::move(shape), {});
}

void BulletShape::make(const HullsGeometry& geometry, const Pose& body_from_geometry) {
  for (const std::vector<Vec3>& points : geometry.hulls) {
    place(make_hull(points, body_from_geometry, geometry.margin), {});
  }
}

void BulletShape::make(const CompoundGeometry& geometry, const Pose& body_from_geometry) {
  for (const CompoundGeometry::Part& part : geometry.parts) {
    const Pose body_from_part = body_from_geometry * part.compound_from_part;
    std::visit([&](const auto& typed) { make(typed, body_from_part); }, part.geometry);
  }
}

HullMesh triangulate_hulls(const std::vector<std::vector<Vec3>>& hulls) {
  HullMesh mesh;
  for (const std::vector<Vec3>& points : hulls) {
    btConvexHullComputer hull;
    hull.compute(&points.data()->x, static_cast<int>(sizeof(Vec3)), static_cast<int>(points.size()),
                 0.0, 0.0);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int i = 0; i < hull.vertices.size(); ++i) {
      mesh.vertices.push_back(from_bullet(hull.vertices[i]));
    }
    for (int face = 0; face < hull.faces.size(); ++face) {
      const auto* start = &hull.edges[hull.faces[face]];
      const auto corner = static_cast<std::uint32_t>(start->getSourceVertex());
      for (auto* edge = start->getNextEdgeOfFace();
           edge->getTargetVertex() != start->getSourceVertex(); edge = edge->getNextEdgeOfFace()) {
        mesh.triangles.push_back({first + corner,
                                  first + static_cast<std::uint32_t>(edge->getSourceVertex()),
                                  first + static_cast<std::uint32_t>(edge->getTargetVertex())});
      }
    }
  }
  return mesh;
}

std::vector<Vec3> sample_hull(const std::vector<Vec3>& points) {
  const auto hull = make_hull(points, {}, 0.0);
  btShapeHull sampled(hull.get());
  sampled.buildHull(0.0);
  std::vector<Vec3> vertices;
  for (int i = 0; i < sampled.numVertices(); ++i) {
    vertices.push_back(from_bullet(sampled.getVertexPointer()[i]));
  }
  return vertices;
}

}  // namespace voxshell::python
