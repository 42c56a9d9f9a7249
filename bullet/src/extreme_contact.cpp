#include "extreme_contact.h"

#include <BulletCollision/CollisionShapes/btConvexShape.h>

#include "voxshell/bullet/convert.h"

namespace voxshell::bullet {

std::optional<Contact> find_extreme_contact(const PosedPair& pair, float margin) {
  const btCollisionObjectWrapper& wrap = pair.field_side().wrap();
  const Model* model = pair.shell_side().model();
  if (model == nullptr || !wrap.getCollisionShape()->isConvex()) return std::nullopt;
  const auto& convex = *static_cast<const btConvexShape*>(wrap.getCollisionShape());
  const GridField& field = model->grid();
  const Pose model_from_shape =
      pair.shell_side().world_from_geometry().inverse() * from_bullet(wrap.getWorldTransform());
  const Pose shape_from_model = model_from_shape.inverse();

  const auto extreme = [&](const Vec3& direction) {
    const btVector3 local = to_bullet(shape_from_model.rotate(direction));
    return model_from_shape.transform_point(from_bullet(convex.localGetSupportingVertex(local)));
  };
  Vec3f deepest = static_cast<Vec3f>(model_from_shape.translation);
  float distance = 0.0f;
  constexpr int kMostSteps = 8;
  for (int i = 0; i < kMostSteps; ++i) {
    const auto downwards = -static_cast<Vec3>(field.gradient(deepest));
    const auto next = static_cast<Vec3f>(extreme(downwards));
    const float at_next = field.distance(next);
    if (i > 0 && !(at_next < distance)) break;
    deepest = next;
    distance = at_next;
  }
  if (!(distance < margin)) return std::nullopt;
  const Vec3f outwards = normalized(field.gradient(deepest));
  // Bullet's extreme points include the margin, which a contact's depth leaves out.
  return Contact{kExtremeContact, -distance - static_cast<float>(pair.thickness()),
                 deepest - distance * outwards, -outwards};
}

}  // namespace voxshell::bullet
