#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/CollisionShapes/btConcaveShape.h>

#include "ball.h"
#include "contact_manifold.h"
#include "hull.h"
#include "voxshell/bullet/contact_settings.h"
#include "voxshell/contacts.h"
#include "voxshell/model.h"
#include "voxshell/pair.h"

namespace voxshell::bullet {

/// How a model meets a shape of some type.
enum class CollisionMethod {
  kModel,      ///< by its field and shell
  kField,      ///< by an analytic field: the model is the shell
  kHull,       ///< the same by the field of its hull, where it has one; else as kConvex
  kTriangles,  ///< by its triangles in the model's field
  kConvex,     ///< by Bullet's own algorithm, with the model's triangles
  kCompound,   ///< child by child
  kNever,      ///< there is nothing to touch
  kUnserved,   ///< not at all: see check_served()
};
CollisionMethod collision_method_of(int shape_type);
/// Of shapes of one type, some may be kUnserved.
CollisionMethod collision_method_of(const btCollisionShape& shape);

/// Tells the geometry of one side from that of others.
struct GeometryKey {
  const void* object;  ///< its model, triangles or hull; null of analytic fields
  std::size_t kind;    ///< of analytic fields, Field's alternative
  std::array<double, 4> dimensions;

  friend bool operator==(const GeometryKey&, const GeometryKey&) = default;
};

/// One side of a pair as the core sees it. Analytic fields live here, models in their shapes, hulls
/// where the pair's algorithm is.
class Side {
 public:
  /// `hull` is of a shape that meets the model by it; else null.
  Side(const btCollisionObjectWrapper& wrap, const Hull* hull);
  Side(const Side&) = delete;
  Side& operator=(const Side&) = delete;

  const Participant& participant() const { return participant_; }
  const Model* model() const { return model_; }
  /// Of sides that meet a model by triangles; else null.
  const btConcaveShape* triangles() const { return triangles_; }
  /// Of sides that meet a model by their hull; else null.
  const Hull* hull() const { return hull_; }
  GeometryKey key() const;
  const Pose& world_from_geometry() const { return world_from_geometry_; }
  const btCollisionObjectWrapper& wrap() const { return wrap_; }
  /// Bullet's collision margin where the shape is thicker by it than its geometry, meters.
  double thickness() const { return thickness_; }
  /// All of it is in there, world frame.
  Ball bounding_ball() const;
  /// Of the geometry's frame, a place that is well inside.
  Vec3 middle() const;
  /// Of the geometry where it is thinnest, meters; infinity of planes and triangles.
  double thinnest() const;
  /// Whether its field tells the sides of an edge apart. Uniform models round edges over a voxel.
  bool has_sharp_field() const { return model_ == nullptr || model_->settings().tolerance > 0.0; }
  /// What moves by more in a step may be through it unseen, meters: a 50th of its longest side, or
  /// two fifths of a model's thickness, or a quarter of the depth of another shape's middle.
  double detail() const;

 private:
  void make_analytic(const btCollisionShape& shape);

  const btCollisionObjectWrapper& wrap_;
  Pose world_from_geometry_;
  std::optional<Field> analytic_;
  Participant participant_;
  const Model* model_ = nullptr;
  const btConcaveShape* triangles_ = nullptr;
  const Hull* hull_ = nullptr;
  double thickness_ = 0.0;
};

/// Contacts of the second shell have ids from here on: no shell has so many elements.
inline constexpr std::uint32_t kFirstOfSecond = 0x80000000u;

/// The two sides with their roles settled. Where one is made of triangles, they are the shell.
/// Where both models' shells are asked, that with which less is missed is the shell, and the other
/// one, of the field's side, is the second.
struct PosedPair {
  /// `hull` is of the shape that meets the model by it, if one does, and outlives this.
  PosedPair(const btCollisionObjectWrapper& a_wrap, const btCollisionObjectWrapper& b_wrap,
            const Hull* hull, ShellRule rule);

  const Side& shell_side() const { return shell_is_a ? a : b; }
  const Side& field_side() const { return shell_is_a ? b : a; }
  bool has_triangles() const { return shell_side().triangles() != nullptr; }
  const PointShell& shell() const { return *shell_side().participant().shell; }
  const Field& field() const { return *field_side().participant().field; }
  /// Where both are asked: the shell of the field's side, and the field that it is tested against.
  const PointShell& second_shell() const { return *field_side().participant().shell; }
  const Field& second_field() const { return *shell_side().participant().field; }
  double thickness() const { return a.thickness() + b.thickness(); }
  Pose field_from_shell() const {
    return field_side().world_from_geometry().inverse() * shell_side().world_from_geometry();
  }

  /// Makes the other body the shell where it may lie inside the one that is. For pairs without
  /// contact, by ShellRule::kFewest.
  bool swap_roles_if_enclosed();

  WorldContact to_world(const Contact& contact) const;

  Side a;
  Side b;
  bool shell_is_a = true;
  bool asks_both = false;

 private:
  void settle_roles(ShellRule rule);
};

}  // namespace voxshell::bullet
