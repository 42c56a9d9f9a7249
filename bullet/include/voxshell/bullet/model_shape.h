#pragma once

#include <memory>
#include <mutex>

#include <BulletCollision/CollisionShapes/btConcaveShape.h>

#include "voxshell/model.h"

namespace voxshell::bullet {

/// Where a rigid body's frame lies in its model's frame: Bullet wants a body's origin at its centre
/// of mass and its axes along the principal axes of inertia.
struct BodyFrame {
  Pose model_from_body;
  Vec3 principal_inertia;  ///< kg m2, about the body's axes
};

/// The frame at the centre of mass along the principal axes, in ascending order of inertia.
BodyFrame compute_principal_frame(const MassProperties& mass_properties);

/// A model as a shape of stock Bullet: static or dynamic, shared between any number of bodies. It
/// needs a world with voxshell::bullet::CollisionConfiguration.
///
/// Two of Bullet's requests are refused with std::logic_error: scaling by anything but 1 (build the
/// model from a scaled mesh), and serialisation (save_model() keeps the model).
ATTRIBUTE_ALIGNED16(class) ModelShape : public btConcaveShape {
 public:
  BT_DECLARE_ALIGNED_ALLOCATOR();

  /// `body_from_model` places the model in the frame of the bodies that use the shape; the inverse
  /// of BodyFrame::model_from_body for dynamic bodies.
  explicit ModelShape(std::shared_ptr<const Model> model, const Pose& body_from_model = {});
  ~ModelShape() override;

  const Model& model() const { return *model_; }
  const Pose& body_from_model() const { return body_from_model_; }
  /// Of a ball around the mesh, in the model's frame, metres.
  const Vec3& ball_centre() const { return centre_; }
  double ball_radius() const { return radius_; }

  void getAabb(const btTransform& world_from_body, btVector3& lower, btVector3& upper)
      const override;
  void calculateLocalInertia(btScalar mass, btVector3 & inertia) const override;
  const char* getName() const override { return "voxshell::Model"; }
  void setLocalScaling(const btVector3& scaling) override;
  const btVector3& getLocalScaling() const override { return unit_scaling_; }

  int calculateSerializeBufferSize() const override;
  const char* serialize(void*, btSerializer*) const override;

  /// The mesh's triangles that may touch a box of the body's frame: how Bullet's ray and sweep
  /// tests, its debug drawing, and its algorithms for shapes that voxshell has none for, see a
  /// model. The first call builds their tree. Callbacks of rays and sweeps see those that lie along
  /// the way.
  void processAllTriangles(btTriangleCallback * callback, const btVector3& lower,
                           const btVector3& upper) const override;

 private:
  struct Triangles;

  std::shared_ptr<const Model> model_;
  Pose body_from_model_;
  Vec3 centre_;  ///< see ball_centre()
  double radius_ = 0.0;
  btVector3 unit_scaling_{1, 1, 1};
  mutable std::once_flag triangles_built_;
  mutable std::unique_ptr<Triangles> triangles_;
};

}  // namespace voxshell::bullet
