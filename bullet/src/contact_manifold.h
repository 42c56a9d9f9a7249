#pragma once

#include <cstdint>
#include <span>

#include <BulletCollision/CollisionDispatch/btCollisionObjectWrapper.h>
#include <BulletCollision/NarrowPhaseCollision/btPersistentManifold.h>

#include "voxshell/vector.h"

namespace voxshell::bullet {

/// A contact as Bullet wants it, between the wrapped objects a and b. Meters, world frame.
struct WorldContact {
  std::uint32_t id;  ///< of the shell's point, a feature (kFirstFeature) or a cell of triangles
  Vec3 point_a;      ///< where the place that touches is now; see Sliding
  Vec3 point_b;
  Vec3 normal;                    ///< unit, on b, pointing toward a
  double depth;                   ///< positive where the bodies overlap
  double restitution = 0.0;       ///< what the solver is to take for it
  double first_impulse = 0.0;     ///< where the solver is to start if the point is new, N s
  double rolling_friction = 0.0;  ///< at least that of the objects, meters
  double turning_speed = 0.0;     ///< see TurningContacts
  bool keeps_impulse =
      false;  ///< the solver is to start from all of the impulse of the step before
  bool is_resting = false;
  /// Of resting bodies: how far a has slipped on b since they took hold of each other, meters.
  Vec3 slip{};
};

/// What all contacts of two objects have in common.
struct Materials {
  /// Through Bullet's pointers, which users may have set to rules of their own.
  Materials(const btCollisionObject& a, const btCollisionObject& b);

  btScalar friction;
  btScalar rolling_friction;
  btScalar spinning_friction;
  btScalar damping = 0;
  btScalar stiffness = 0;
  int flags = 0;  ///< btContactPointFlags
};

/// Fills manifolds with contacts between the wrapped objects a and b.
class ManifoldFiller {
 public:
  ManifoldFiller(const btCollisionObjectWrapper& a, const btCollisionObjectWrapper& b);

  /// Replaces the points of `manifold`, which is of a and b in any order, by `contacts` (at most
  /// four). The impulses of points whose id it held before are carried over, so that the solver
  /// starts warm. Other material properties are those of the two objects, and Bullet's contact
  /// callbacks are honored.
  void fill(btPersistentManifold& manifold, std::span<const WorldContact> contacts) const;

 private:
  bool is_swapped(const btPersistentManifold& manifold) const;
  btManifoldPoint& add(btPersistentManifold& manifold, const WorldContact& contact) const;

  const btCollisionObjectWrapper& a_;
  const btCollisionObjectWrapper& b_;
  Materials materials_;
  bool stays_awake_;  ///< one of the two; else they may keep the impulses as they are filled in
  bool tells_added_;  ///< to gContactAddedCallback
};

}  // namespace voxshell::bullet
