#include "seamless_bodies.h"

#include <algorithm>

#include "bounds_of_change.h"
#include "contact_constants.h"
#include "voxshell/bullet/convert.h"

namespace voxshell::bullet {
namespace {

/// Of a ball about the body's origin that holds it, meters.
double reach_of(const btCollisionObject& body) {
  btVector3 center;
  btScalar radius = 0;
  body.getCollisionShape()->getBoundingSphere(center, radius);
  return static_cast<double>(center.length() + radius);
}

}  // namespace

void SeamlessBody::describe(std::span<const Touching> of_body, double time_step) {
  const btCollisionObject& body = *of_body.front().body;
  const Pose world_from_body = from_bullet(body.getWorldTransform());
  const Pose body_from_world = world_from_body.inverse();
  const Motion motion = Motion::of(body, time_step);
  radius_ = smallest_ = reach_of(body);
  has_parts_ = body.getCollisionShape()->isCompound();
  now_.shape = body.getCollisionShape();
  now_.time_step = time_step;
  now_.others.clear();
  now_.points.clear();
  for (const Touching& each : of_body) {
    const btCollisionObject& other = *each.other;
    const bool is_known =
        std::ranges::any_of(now_.others, [&](const Other& known) { return known.body == &other; });
    if (!is_known) {
      now_.others.push_back(
          {&other, body_from_world * from_bullet(other.getWorldTransform()),
           RelativeMotion::of(Motion::of(other, time_step), motion, world_from_body)});
      smallest_ = std::min(smallest_, reach_of(other));
      has_parts_ = has_parts_ || other.getCollisionShape()->isCompound();
    }
    for (int i = 0; i < each.manifold->getNumContacts(); ++i) {
      const btManifoldPoint& point = each.manifold->getContactPoint(i);
      now_.points.push_back(
          {point.m_index0, body_from_world.rotate(from_bullet(point.m_normalWorldOnB))});
    }
  }
}

bool SeamlessBody::are_as_now(const Surroundings& then) const {
  const double most = kSeamKeptOfRadius * smallest_;
  const auto is_same_other = [&](const Other& before, const Other& now) {
    return before.body == now.body &&
           bound_displacement(before.pose.inverse(), now.pose.inverse(), {}, radius_) <= most &&
           bound_difference(before.motion, now.motion, {}, radius_) * now_.time_step <= most;
  };
  const auto is_same_point = [](const Point& before, const Point& now) {
    return before.id == now.id && dot(before.normal, now.normal) >= kSeamAligned;
  };
  return !has_parts_ && then.shape == now_.shape && then.time_step == now_.time_step &&
         std::ranges::equal(then.points, now_.points, is_same_point) &&
         std::ranges::equal(then.others, now_.others, is_same_other);
}

bool SeamlessBody::hold(std::span<const Touching> of_body, double time_step) {
  describe(of_body, time_step);
  return are_as_now(kept_);
}

void SeamlessBody::keep(bool has_seams) {
  if (has_seams) {
    kept_.shape = nullptr;
  } else {
    std::swap(kept_, now_);
  }
}

SeamlessBody& SeamlessBodies::of(const btCollisionObject& body) {
  Kept& kept = kept_[&body];
  kept.step = step_;
  return kept.body;
}

void SeamlessBodies::end() {
  std::erase_if(kept_, [&](const auto& each) { return each.second.step != step_; });
}

}  // namespace voxshell::bullet
