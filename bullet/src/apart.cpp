#include "apart.h"

#include <algorithm>

#include <LinearMath/btAabbUtil2.h>

#include "ball.h"
#include "contact_constants.h"
#include "motion.h"
#include "pair_step.h"
#include "posed_pair.h"
#include "round_contacts.h"
#include "voxshell/bullet/model_shape.h"

namespace voxshell::bullet {
namespace {

const ModelShape* model_shape_of(const btCollisionObjectWrapper& wrap) {
  const btCollisionShape& shape = *wrap.getCollisionShape();
  return collision_method_of(shape) == CollisionMethod::kModel
             ? static_cast<const ModelShape*>(&shape)
             : nullptr;
}

Pose world_from_model(const btCollisionObjectWrapper& wrap, const ModelShape& shape) {
  return from_bullet(wrap.getWorldTransform()) * shape.body_from_model();
}

Ball ball_about(const btCollisionObjectWrapper& wrap, const ModelShape* model) {
  if (model == nullptr) return Ball::about(wrap);
  return {world_from_model(wrap, *model).transform_point(model->ball_center()),
          model->ball_radius()};
}

/// Whether the model's box is farther from that of the other object along the same axes.
bool are_boxes_apart(const btCollisionObjectWrapper& wrap, const ModelShape& shape,
                     const btCollisionObjectWrapper& other, double reach) {
  btVector3 lower;
  btVector3 upper;
  const btTransform model_from_other =
      to_bullet(world_from_model(wrap, shape)).inverseTimes(other.getWorldTransform());
  other.getCollisionShape()->getAabb(model_from_other, lower, upper);
  const Vec3 more{reach, reach, reach};
  const Bounds& box = shape.model().bounds();
  return !TestAabbAgainstAabb2(to_bullet(box.lower - more), to_bullet(box.upper + more), lower,
                               upper);
}

}  // namespace

bool are_apart(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b,
               const ContactSettings& settings, double time_step) {
  const ModelShape* model_a = model_shape_of(a);
  const ModelShape* model_b = model_shape_of(b);
  const Ball ball_a = ball_about(a, model_a);
  const Ball ball_b = ball_about(b, model_b);
  const Ball& smaller = ball_b.radius < ball_a.radius ? ball_b : ball_a;
  const Motion motion_a = Motion::of(*a.getCollisionObject(), time_step);
  const Motion motion_b = Motion::of(*b.getCollisionObject(), time_step);
  const double rest_margin =
      settings.margin >= 0.0 ? settings.margin : kRestMarginOfDiameter * 2.0 * smaller.radius;
  double reach = std::max(rest_margin, find_touch_reach(motion_a, motion_b, smaller, time_step));
  for (const ModelShape* model : {model_a, model_b}) {
    if (model != nullptr) reach += most_above_samples(model->model());
  }
  const double between = ball_a.radius + ball_b.radius + reach;
  if (squared_length(ball_a.center - ball_b.center) > between * between) return true;
  return (model_a != nullptr && are_boxes_apart(a, *model_a, b, reach)) ||
         (model_b != nullptr && are_boxes_apart(b, *model_b, a, reach));
}

}  // namespace voxshell::bullet
