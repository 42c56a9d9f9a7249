#include "bullet/shapes.h"

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

}  // namespace

BulletShape::BulletShape(const Geometry& geometry, const Pose& body_from_geometry) {
  std::visit([&](const auto& typed) { make(typed, body_from_geometry); }, geometry);
}

void BulletShape::make(const ModelGeometry& geometry, const Pose& body_from_geometry) {
  parts_.push_back(std::make_unique<bullet::ModelShape>(geometry.model, body_from_geometry));
}

void BulletShape::make(const PlaneGeometry& geometry, const Pose&) {
  parts_.push_back(
      std::make_unique<btStaticPlaneShape>(to_bullet(geometry.normal), geometry.offset));
}

void BulletShape::make(const BoxGeometry& geometry, const Pose&) {
  parts_.push_back(std::make_unique<btBoxShape>(to_bullet(geometry.half_extents)));
}

void BulletShape::make(const SphereGeometry& geometry, const Pose&) {
  parts_.push_back(std::make_unique<btSphereShape>(geometry.radius));
}

void BulletShape::make(const GImpactGeometry& geometry, const Pose& body_from_geometry) {
  vertices_.reserve(3 * geometry.vertices.size());
  for (const Vec3& vertex : geometry.vertices) {
    const Vec3 p = body_from_geometry.transform_point(vertex);
    vertices_.insert(vertices_.end(), {p.x, p.y, p.z});
  }
  indices_.reserve(3 * geometry.triangles.size());
  for (const Triangle& triangle : geometry.triangles) {
    for (const std::uint32_t index : triangle) indices_.push_back(static_cast<int>(index));
  }
  mesh_ = std::make_unique<btTriangleIndexVertexArray>(
      static_cast<int>(geometry.triangles.size()), indices_.data(),
      static_cast<int>(3 * sizeof(int)), static_cast<int>(geometry.vertices.size()),
      vertices_.data(), static_cast<int>(3 * sizeof(btScalar)));
  auto shape = std::make_unique<btGImpactMeshShape>(mesh_.get());
  shape->setMargin(geometry.margin);
  shape->updateBound();
  parts_.push_back(std::move(shape));
}

void BulletShape::make(const HullsGeometry& geometry, const Pose& body_from_geometry) {
  for (const std::vector<Vec3>& points : geometry.hulls) {
    parts_.push_back(make_hull(points, body_from_geometry, geometry.margin));
  }
  if (geometry.hulls.size() == 1) return;
  auto compound = std::make_unique<btCompoundShape>();
  for (const auto& hull : parts_) {
    compound->addChildShape(btTransform::getIdentity(), hull.get());
  }
  parts_.push_back(std::move(compound));
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
