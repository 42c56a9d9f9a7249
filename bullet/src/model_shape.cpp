#include "voxshell/bullet/model_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>
#include <BulletCollision/NarrowPhaseCollision/btRaycastCallback.h>
#include <LinearMath/btMatrix3x3.h>

#include "rest_margin.h"
#include "transform_bounds.h"
#include "voxshell/bullet/convert.h"

namespace voxshell::bullet {
BodyFrame compute_principal_frame(const MassProperties& mass_properties) {
  // Jacobi rotations in float64, whatever Bullet's own precision.
  std::array<Vec3, 3> inertia{mass_properties.inertia.row_x, mass_properties.inertia.row_y,
                              mass_properties.inertia.row_z};
  std::array<Vec3, 3> axes{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};  // rows: body axes
  constexpr int kSweeps = 32;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const auto& [p, q] : {std::pair{0, 1}, std::pair{0, 2}, std::pair{1, 2}}) {
      const auto row_p = static_cast<std::size_t>(p);
      const auto row_q = static_cast<std::size_t>(q);
      const double off = inertia[row_p][q];
      if (off == 0.0) continue;
      const double theta = (inertia[row_q][q] - inertia[row_p][p]) / (2.0 * off);
      const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::hypot(theta, 1.0));
      const double c = 1.0 / std::hypot(t, 1.0);
      const double s = t * c;
      for (std::size_t k = 0; k < 3; ++k) {  // columns
        const double at_p = inertia[k][p];
        const double at_q = inertia[k][q];
        inertia[k][p] = c * at_p - s * at_q;
        inertia[k][q] = s * at_p + c * at_q;
      }
      const auto rotate_rows = [&](std::array<Vec3, 3>& rows) {
        const Vec3 at_p = rows[row_p];
        const Vec3 at_q = rows[row_q];
        rows[row_p] = c * at_p - s * at_q;
        rows[row_q] = s * at_p + c * at_q;
      };
      rotate_rows(inertia);
      rotate_rows(axes);
    }
  }
  std::array<std::size_t, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return inertia[a][static_cast<int>(a)] < inertia[b][static_cast<int>(b)];
  });
  Matrix3 body_from_model{axes[order[0]], axes[order[1]], axes[order[2]]};
  if (dot(cross(body_from_model.row_x, body_from_model.row_y), body_from_model.row_z) < 0.0) {
    body_from_model.row_z = -body_from_model.row_z;
  }
  const auto moment = [&](std::size_t i) { return inertia[order[i]][static_cast<int>(order[i])]; };
  return {{body_from_model.transposed(), mass_properties.center_of_mass},
          {moment(0), moment(1), moment(2)}};
}

/// The mesh as Bullet keeps meshes, in the body's frame.
struct ModelShape::Triangles {
  Triangles(const TriangleMesh& mesh, const Pose& body_from_model)
      : vertices(copy_vertices(mesh, body_from_model)),
        array(static_cast<int>(mesh.triangles().size()), indices_of(mesh),
              static_cast<int>(sizeof(Triangle)), static_cast<int>(mesh.vertices().size()),
              vertices.data(), 3 * sizeof(btScalar)),
        shape(&array, /*useQuantizedAabbCompression=*/mesh.triangles().size() < kMostQuantized) {}

  static std::vector<btScalar> copy_vertices(const TriangleMesh& mesh,
                                             const Pose& body_from_model) {
    std::vector<btScalar> coordinates;
    coordinates.reserve(3 * mesh.vertices().size());
    for (const Vec3& vertex : mesh.vertices()) {
      const btVector3 in_body = to_bullet(body_from_model.transform_point(vertex));
      coordinates.insert(coordinates.end(), {in_body.x(), in_body.y(), in_body.z()});
    }
    return coordinates;
  }
  /// Bullet reads 32-bit indices as int, and writes none.
  static int* indices_of(const TriangleMesh& mesh) {
    return const_cast<int*>(reinterpret_cast<const int*>(mesh.triangles().data()));
  }

  static constexpr std::size_t kMostQuantized = std::size_t{1} << 20;  ///< of Bullet's tree

  std::vector<btScalar> vertices;
  btTriangleIndexVertexArray array;
  btBvhTriangleMeshShape shape;
};

ModelShape::~ModelShape() = default;

ModelShape::ModelShape(std::shared_ptr<const Model> model, const Pose& body_from_model)
    : model_(std::move(model)),
      body_from_model_(body_from_model),
      center_(static_cast<Vec3>(model_->shell().tree().spheres(1)[0].center)) {
  // Prepared here, so that the step in which the body first comes near another does not wait for
  // it.
  model_->smooth_surface();
  for (const Vec3& vertex : model_->mesh().vertices()) {
    radius_ = std::max(radius_, length(vertex - center_));
  }
  // The one concave type that Bullet itself uses nowhere. CUSTOM_CONCAVE_SHAPE_TYPE equals Bullet's
  // SDF type: shapes of that id are cast to its class.
  m_shapeType = FAST_CONCAVE_MESH_PROXYTYPE;
  m_collisionMargin = btScalar(0);
}

void ModelShape::getAabb(const btTransform& world_from_body, btVector3& lower,
                         btVector3& upper) const {
  const Pose world_from_model = from_bullet(world_from_body) * body_from_model_;
  const Bounds box = transform_bounds(world_from_model, model_->bounds());
  // Turned, the box of a round body is up to three times as large as the body's.
  const Vec3 center = world_from_model.transform_point(center_);
  const Vec3 radii{radius_, radius_, radius_};
  // Compounds compare the bounds of children without Bullet's own slack for contacts: points within
  // the rest margin must lie inside.
  const btScalar reach =
      m_collisionMargin +
      static_cast<btScalar>(default_rest_margin(
          static_cast<double>(model_->shell().tree().spheres(1)[0].radius), model_->thickness()));
  const btVector3 margin(reach, reach, reach);
  lower = to_bullet(box.lower);
  upper = to_bullet(box.upper);
  lower.setMax(to_bullet(center - radii));
  upper.setMin(to_bullet(center + radii));
  lower -= margin;
  upper += margin;
}

void ModelShape::calculateLocalInertia(btScalar mass, btVector3& inertia) const {
  const MassProperties solid = model_->solid_mass_properties().with_mass(static_cast<double>(mass));
  const Matrix3 in_body =
      body_from_model_.rotation * solid.inertia * body_from_model_.rotation.transposed();
  inertia = to_bullet(Vec3{in_body.row_x.x, in_body.row_y.y, in_body.row_z.z});
}

void ModelShape::setLocalScaling(const btVector3& scaling) {
  if (scaling == unit_scaling_) return;
  throw std::logic_error(
      "a ModelShape cannot be scaled: a model never changes; build a model from the scaled "
      "mesh");
}

int ModelShape::calculateSerializeBufferSize() const {
  throw std::logic_error(
      "a ModelShape cannot be serialized by Bullet: save the model with save_model() and create "
      "the "
      "shape from it");
}

const char* ModelShape::serialize(void*, btSerializer*) const {
  calculateSerializeBufferSize();
  return nullptr;
}

void ModelShape::processAllTriangles(btTriangleCallback* callback, const btVector3& lower,
                                     const btVector3& upper) const {
  std::call_once(triangles_built_, [&] {
    triangles_ = std::make_unique<Triangles>(model_->mesh(), body_from_model_);
  });
  btBvhTriangleMeshShape& mesh = triangles_->shape;
  // Bullet asks meshes of its own for the triangles along a ray, others for all in the ray's box.
  if (auto* ray = dynamic_cast<btTriangleRaycastCallback*>(callback)) {
    mesh.performRaycast(ray, ray->m_from, ray->m_to);
  } else if (auto* sweep = dynamic_cast<btTriangleConvexcastCallback*>(callback)) {
    const btTransform body_from_world = sweep->m_triangleToWorld.inverse();
    const btVector3 from = body_from_world * sweep->m_convexShapeFrom.getOrigin();
    const btVector3 to = body_from_world * sweep->m_convexShapeTo.getOrigin();
    btVector3 first = from;
    btVector3 last = from;
    first.setMin(to);
    last.setMax(to);
    mesh.performConvexcast(sweep, from, to, lower - first, upper - last);
  } else {
    mesh.processAllTriangles(callback, lower, upper);
  }
}

}  // namespace voxshell::bullet
