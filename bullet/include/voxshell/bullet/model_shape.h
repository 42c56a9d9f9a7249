#pragma once

#include <memory>
#include <mutex>

#include <BulletCollision/CollisionShapes/btConcaveShape.h>

#include "voxshell/model.h"

namespace voxshell::bullet {

/// Pose of a rigid body's frame in its model's frame. Bullet requires a body's origin at its center
/// of mass and its axes along the principal axes of inertia.
struct BodyFrame {
  Pose model_from_body;
  Vec3 principal_inertia;  ///< kg m2, about the body's axes
};

/// The frame at the center of mass along the principal axes, in ascending order of inertia.
BodyFrame compute_principal_frame(const MassProperties& mass_properties);

/// A model as a shape of stock Bullet: static or dynamic, shared by any number of bodies. The world
/// needs voxshell::bullet::CollisionConfiguration.
///
/// Two operations of Bullet throw std::logic_error: scaling by anything but 1 (build the model from
/// a scaled mesh instead), and serialization (save_model() saves the model).
ATTRIBUTE_ALIGNED16(class) ModelShape : public btConcaveShape {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// `body_from_model` places the model in the frame of the bodies that use the shape. For dynamic
  /// bodies, it is the inverse of BodyFrame::model_from_body.
  explicit ModelShape(std::shared_ptr<const Model> model, const Pose& body_from_model = {});
  ~ModelShape() override;

  const Model& model() const { return *model_; }
  const Pose& body_from_model() const { return body_from_model_; }
  /// Center of a ball around the mesh, in the model's frame, meters.
  const Vec3& ball_center() const { return center_; }
  double ball_radius() const { return radius_; }

  void getAabb(const btTransform& world_from_body, btVector3& lower, btVector3& upper)
      const override;
  void calculateLocalInertia(btScalar mass, btVector3 & inertia) const override;
  const char* getName() const override { return "voxshell::Model"; }
  void setLocalScaling(const btVector3& scaling) override;
  const btVector3& getLocalScaling() const override { return unit_scaling_; }

  int calculateSerializeBufferSize() const override;
  const char* serialize(void*, btSerializer*) const override;

  /// Passes on the mesh's triangles that may touch a box in the body's frame. Bullet's ray and
  /// sweep tests, its debug drawing, and its algorithms for shapes without an algorithm of
  /// voxshell's use it. The first call builds a tree of the triangles. Callbacks of rays and sweeps
  /// get those that lie along their path.
  void processAllTriangles(btTriangleCallback * callback, const btVector3& lower,
                           const btVector3& upper) const override;

 private:
  struct Triangles;

  std::shared_ptr<const Model> model_;
  Pose body_from_model_;
  Vec3 center_;  ///< see ball_center()
  double radius_ = 0.0;
  btVector3 unit_scaling_{1, 1, 1};
  mutable std::once_flag triangles_built_;
  mutable std::unique_ptr<Triangles> triangles_;
};

}  // namespace voxshell::bullet
