#pragma once

#include <algorithm>
#include <limits>
#include <variant>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btBroadphaseProxy.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>

#include "contact_constants.h"
#include "motion.h"
#include "posed_pair.h"

namespace voxshell::bullet {

/// The field of one shape, in the world.
class PlacedField {
 public:
  explicit PlacedField(const Side& side)
      : model_(side.model()),
        world_from_field_(side.world_from_geometry()),
        field_from_world_(side.world_from_geometry().inverse()),
        thickness_(side.thickness()) {
    if (model_ != nullptr) {
      field_ = side.participant().field;
    } else {
      field_ = *side.participant().field;
    }
  }

  /// Negative inside, meters.
  double distance(const Vec3& place) const {
    const auto local = static_cast<Vec3f>(field_from_world_.transform_point(place));
    return std::visit([&](const auto& f) { return static_cast<double>(f.distance(local)); },
                      field()) -
           thickness_;
  }

  /// Whether the surface that is nearest to a place is flat there. `farther` is a place that the
  /// same surface would be nearest to, if it is.
  bool is_flat(const Vec3& place, const Vec3& farther) const {
    if (model_ == nullptr) return dot(outwards(place), outwards(farther)) >= kFlatFace;
    const SmoothSurface& surface = model_->smooth_surface();
    if (!surface.is_curved()) return true;
    return surface.is_flat(surface.nearest(field_from_world_.transform_point(place)).triangle);
  }

  Vec3 outwards(const Vec3& place) const {
    const auto local = static_cast<Vec3f>(field_from_world_.transform_point(place));
    const Vec3f gradient = std::visit([&](const auto& f) { return f.gradient(local); }, field());
    return world_from_field_.rotate(normalized(static_cast<Vec3>(gradient)));
  }

 private:
  const Field& field() const {
    if (const auto* of_model = std::get_if<const Field*>(&field_)) return **of_model;
    return std::get<Field>(field_);
  }

  const Model* model_;
  std::variant<const Field*, Field> field_;  ///< models keep theirs
  Pose world_from_field_;
  Pose field_from_world_;
  double thickness_;  ///< of Bullet's margin about it, meters
};

/// Of the ball about a body, meters.
double radius_of(const btCollisionObject& body);

/// A body that another one touches.
class Neighbor {
 public:
  Neighbor(const btCollisionObject& body, double time_step)
      : body_(&body), motion_(Motion::of(body, time_step)), radius_(radius_of(body)) {}

  const btCollisionObject& body() const { return *body_; }
  const Motion& motion() const { return motion_; }
  double radius() const { return radius_; }
  bool is_model() const {
    return collision_method_of(*body_->getCollisionShape()) == CollisionMethod::kModel;
  }

  /// Whether a place may be that near, by the bounds that Bullet looks for pairs with.
  bool may_be_near(const Vec3& place, double reach) const {
    const btBroadphaseProxy* const bounds = body_->getBroadphaseHandle();
    if (bounds == nullptr) return false;
    const auto is_between = [&](btScalar low, double x, btScalar high) {
      return static_cast<double>(low) - reach <= x && x <= static_cast<double>(high) + reach;
    };
    const btVector3& low = bounds->m_aabbMin;
    const btVector3& high = bounds->m_aabbMax;
    return is_between(low.x(), place.x, high.x()) && is_between(low.y(), place.y, high.y()) &&
           is_between(low.z(), place.z, high.z());
  }

  /// Hulls and Bullet's triangles have none at hand.
  bool has_field() { return !fields().empty(); }

  /// Of the part that is nearest to a place; null where the body has no field.
  const PlacedField* nearest(const Vec3& place) {
    const auto found = std::ranges::min_element(
        fields(), {}, [&](const PlacedField& field) { return field.distance(place); });
    return found == fields_.end() ? nullptr : &*found;
  }

  /// Infinite where the body has no field.
  double distance(const Vec3& place) {
    const PlacedField* const field = nearest(place);
    return field != nullptr ? field->distance(place) : std::numeric_limits<double>::infinity();
  }

 private:
  const std::vector<PlacedField>& fields();

  const btCollisionObject* body_;
  Motion motion_;
  double radius_;
  bool is_placed_ = false;
  std::vector<PlacedField> fields_;
};

}  // namespace voxshell::bullet
