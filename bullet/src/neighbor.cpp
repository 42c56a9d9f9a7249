#include "neighbor.h"

#include <BulletCollision/CollisionShapes/btCompoundShape.h>

#include "wrap_object.h"

namespace voxshell::bullet {

namespace {

/// Appends the fields of a shape's parts; those that have none are left out.
void place_fields(const btCollisionObject& body, const btCollisionShape& shape,
                  const btTransform& world_from_shape, std::vector<PlacedField>& fields) {
  if (shape.isCompound()) {
    const auto& compound = static_cast<const btCompoundShape&>(shape);
    for (int i = 0; i < compound.getNumChildShapes(); ++i) {
      place_fields(body, *compound.getChildShape(i),
                   world_from_shape * compound.getChildTransform(i), fields);
    }
    return;
  }
  const CollisionMethod method = collision_method_of(shape);
  if (method != CollisionMethod::kModel && method != CollisionMethod::kField) return;
  fields.emplace_back(Side(wrap_object(body, shape, world_from_shape), nullptr));
}

}  // namespace

double radius_of(const btCollisionObject& body) {
  btVector3 center;
  btScalar radius = 0;
  body.getCollisionShape()->getBoundingSphere(center, radius);
  return static_cast<double>(radius);
}

const std::vector<PlacedField>& Neighbor::fields() {
  if (!is_placed_) {
    place_fields(*body_, *body_->getCollisionShape(), body_->getWorldTransform(), fields_);
    is_placed_ = true;
  }
  return fields_;
}

}  // namespace voxshell::bullet
