#include "posed_pair.h"

#include <algorithm>
#include <limits>
#include <variant>

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btConeShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>

#include "contact_constants.h"
#include "voxshell/bullet/convert.h"
#include "voxshell/bullet/model_shape.h"

namespace voxshell::bullet {
namespace {

/// From a frame whose z axis is the shape's axis of revolution, which is Bullet's x, y or z.
Pose shape_from_axis(int axis) {
  switch (axis) {
    case 0:
      return {{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}, {}};
    case 1:
      return {{{0, 1, 0}, {0, 0, 1}, {1, 0, 0}}, {}};
    default:
      return {};
  }
}

}  // namespace

CollisionMethod collision_method_of(int shape_type) {
  switch (shape_type) {
    case FAST_CONCAVE_MESH_PROXYTYPE:
      return CollisionMethod::kModel;
    case STATIC_PLANE_PROXYTYPE:
    case BOX_SHAPE_PROXYTYPE:
    case SPHERE_SHAPE_PROXYTYPE:
    case CAPSULE_SHAPE_PROXYTYPE:
    case CYLINDER_SHAPE_PROXYTYPE:
    case CONE_SHAPE_PROXYTYPE:
      return CollisionMethod::kField;
    case CONVEX_HULL_SHAPE_PROXYTYPE:
    case CONVEX_POINT_CLOUD_SHAPE_PROXYTYPE:
    case CONVEX_TRIANGLEMESH_SHAPE_PROXYTYPE:
    case TETRAHEDRAL_SHAPE_PROXYTYPE:
      return CollisionMethod::kHull;
    case TRIANGLE_MESH_SHAPE_PROXYTYPE:
    case SCALED_TRIANGLE_MESH_SHAPE_PROXYTYPE:
    case MULTIMATERIAL_TRIANGLE_MESH_PROXYTYPE:
    case TERRAIN_SHAPE_PROXYTYPE:
    case GIMPACT_SHAPE_PROXYTYPE:
      return CollisionMethod::kTriangles;
    case COMPOUND_SHAPE_PROXYTYPE:
      return CollisionMethod::kCompound;
    case EMPTY_SHAPE_PROXYTYPE:
      return CollisionMethod::kNever;
    default:
      break;
  }
  return btBroadphaseProxy::isConvex(shape_type) ? CollisionMethod::kConvex
                                                 : CollisionMethod::kUnserved;
}

CollisionMethod collision_method_of(const btCollisionShape& shape) {
  // Of GImpact's compounds, processAllTriangles() is empty.
  if (shape.getShapeType() == GIMPACT_SHAPE_PROXYTYPE &&
      static_cast<const btGImpactShapeInterface&>(shape).getGImpactShapeType() ==
          CONST_GIMPACT_COMPOUND_SHAPE) {
    return CollisionMethod::kUnserved;
  }
  return collision_method_of(shape.getShapeType());
}

Side::Side(const btCollisionObjectWrapper& wrap, const Hull* hull)
    : wrap_(wrap), world_from_geometry_(from_bullet(wrap.getWorldTransform())) {
  const btCollisionShape& shape = *wrap.getCollisionShape();
  switch (collision_method_of(shape)) {
    case CollisionMethod::kModel: {
      const auto& model_shape = static_cast<const ModelShape&>(shape);
      world_from_geometry_ = world_from_geometry_ * model_shape.body_from_model();
      model_ = &model_shape.model();
      participant_ = {.field = &model_->field(),
                      .shell = &model_->shell(),
                      .accuracy = &model_->accuracy(),
                      .thickness = model_->thickness(),
                      .inner_point = &model_->inner_point()};
      return;
    }
    case CollisionMethod::kTriangles:
      triangles_ = static_cast<const btConcaveShape*>(&shape);
      thickness_ = static_cast<double>(triangles_->getMargin());
      return;
    case CollisionMethod::kHull:
      hull_ = hull;
      participant_.field = &hull_->field();
      thickness_ = static_cast<double>(shape.getMargin());
      return;
    default:
      break;
  }
  make_analytic(shape);
  if (analytic_) participant_.field = &*analytic_;
}

void Side::make_analytic(const btCollisionShape& shape) {
  const auto number = [](btScalar x) { return static_cast<double>(x); };
  const auto along = [&](int axis) {
    world_from_geometry_ = world_from_geometry_ * shape_from_axis(axis);
  };
  switch (shape.getShapeType()) {
    case STATIC_PLANE_PROXYTYPE: {
      const auto& plane = static_cast<const btStaticPlaneShape&>(shape);
      analytic_ = PlaneField{from_bullet(plane.getPlaneNormal()), number(plane.getPlaneConstant())};
      return;
    }
    case BOX_SHAPE_PROXYTYPE:
      analytic_ =
          BoxField{from_bullet(static_cast<const btBoxShape&>(shape).getHalfExtentsWithMargin())};
      return;
    case SPHERE_SHAPE_PROXYTYPE:
      analytic_ = SphereField{number(static_cast<const btSphereShape&>(shape).getRadius())};
      return;
    case CAPSULE_SHAPE_PROXYTYPE: {
      const auto& capsule = static_cast<const btCapsuleShape&>(shape);
      along(capsule.getUpAxis());
      analytic_ = CapsuleField{number(capsule.getRadius()), 2.0 * number(capsule.getHalfHeight())};
      return;
    }
    case CYLINDER_SHAPE_PROXYTYPE: {
      const auto& cylinder = static_cast<const btCylinderShape&>(shape);
      along(cylinder.getUpAxis());
      analytic_ =
          CylinderField{number(cylinder.getRadius()),
                        2.0 * number(cylinder.getHalfExtentsWithMargin()[cylinder.getUpAxis()])};
      return;
    }
    case CONE_SHAPE_PROXYTYPE: {
      const auto& cone = static_cast<const btConeShape&>(shape);
      along(cone.getConeUpIndex());
      analytic_ = ConeField{number(cone.getRadius()), number(cone.getHeight())};
      thickness_ = number(cone.getMargin());
      return;
    }
    default:
      btAssert(!"collision_method_of() says which shapes have a field");
  }
}

GeometryKey Side::key() const {
  const void* object = model_;
  if (triangles_ != nullptr) object = triangles_;
  if (hull_ != nullptr) object = hull_;
  GeometryKey key{object, 0, {}};
  if (!analytic_) return key;
  key.kind = analytic_->index();
  const Field& field = *analytic_;
  if (const auto* plane = std::get_if<PlaneField>(&field)) {
    key.dimensions = {plane->normal.x, plane->normal.y, plane->normal.z, plane->offset};
  } else if (const auto* box = std::get_if<BoxField>(&field)) {
    key.dimensions = {box->half_extents.x, box->half_extents.y, box->half_extents.z};
  } else if (const auto* sphere = std::get_if<SphereField>(&field)) {
    key.dimensions = {sphere->radius};
  } else if (const auto* capsule = std::get_if<CapsuleField>(&field)) {
    key.dimensions = {capsule->radius, capsule->length};
  } else if (const auto* cylinder = std::get_if<CylinderField>(&field)) {
    key.dimensions = {cylinder->radius, cylinder->length};
  } else if (const auto* cone = std::get_if<ConeField>(&field)) {
    key.dimensions = {cone->radius, cone->height};
  }
  return key;
}

Ball Side::bounding_ball() const {
  if (model_ != nullptr) {
    const Sphere& sphere = model_->shell().tree().spheres(1)[0];
    return {world_from_geometry_.transform_point(static_cast<Vec3>(sphere.center)),
            static_cast<double>(sphere.radius)};
  }
  return Ball::about(wrap_);
}

Vec3 Side::middle() const { return hull_ != nullptr ? hull_->middle() : Vec3{}; }

double Side::thinnest() const {
  constexpr double kUnbounded = std::numeric_limits<double>::infinity();
  if (model_ != nullptr) return model_->thickness();
  const Field* field = participant_.field;
  if (field == nullptr || std::holds_alternative<PlaneField>(*field)) return kUnbounded;
  const auto at = static_cast<Vec3f>(middle());
  return std::visit(
      [&](const auto& typed) {
        return 2.0 * (thickness_ - static_cast<double>(typed.distance(at)));
      },
      *field);
}

double Side::detail() const {
  if (model_ == nullptr) {
    return std::min(kDetailOfInnerDiameter * thinnest(),
                    2.0 * kDetailOfSize * bounding_ball().radius);
  }
  const Vec3 sides = model_->bounds().extents();
  return std::min(kDetailOfThickness * thinnest(),
                  kDetailOfSize * std::max({sides.x, sides.y, sides.z}));
}

PosedPair::PosedPair(const btCollisionObjectWrapper& a_wrap, const btCollisionObjectWrapper& b_wrap,
                     const Hull* hull, ShellRule rule)
    : a(a_wrap, hull), b(b_wrap, hull) {
  settle_roles(rule);
}

void PosedPair::settle_roles(ShellRule rule) {
  if (a.triangles() != nullptr || b.triangles() != nullptr) {
    shell_is_a = a.triangles() != nullptr;
    return;
  }
  const ShellChoice choice =
      rule == ShellRule::kFewest ? ShellChoice::kFewest : ShellChoice::kAutomatic;
  // One of the two is a model, or the algorithm would not have been made.
  const PairRole pair = *decide_role(a.participant(), b.participant(), choice);
  asks_both = pair.role == Role::kBoth;
  shell_is_a = pair.first == PairBody::kA;
}

bool PosedPair::swap_roles_if_enclosed() {
  if (!is_enclosed(field_side().participant(), shell_side().participant(),
                   field_from_shell().inverse())) {
    return false;
  }
  shell_is_a = !shell_is_a;
  return true;
}

WorldContact PosedPair::to_world(const Contact& contact) const {
  const Pose& world_from_shell = shell_side().world_from_geometry();
  // Made a unit vector in double precision: with one friction direction, Bullet's solvers take what
  // a longer normal leaves of the velocity for sliding, and friction then acts along the normal.
  const Vec3 out_of_field = world_from_shell.rotate(normalized(static_cast<Vec3>(contact.normal)));
  const auto depth = static_cast<double>(contact.depth) + thickness();
  const Vec3 on_shell = world_from_shell.transform_point(static_cast<Vec3>(contact.point)) -
                        shell_side().thickness() * out_of_field;
  const Vec3 on_field = on_shell + depth * out_of_field;
  return {contact.id, shell_is_a ? on_shell : on_field, shell_is_a ? on_field : on_shell,
          shell_is_a ? out_of_field : -out_of_field, depth};
}

}  // namespace voxshell::bullet
