#pragma once

#include <optional>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

namespace voxshell::bullet {

/// Lets the normals of contacts between Bullet's own shapes turn with the bodies.
///
/// Bullet carries the places of a contact along with its bodies until it is found anew, but not its
/// normal. A box that lies on a tray rarely has all four of its corners found anew: as the tray
/// tips, two keep the normal that they had when it was level, and hold the box at any slope.
class CarriedNormals {
 public:
  /// Turns the normals of a world's contacts as far as both bodies have turned since the last call:
  /// like the one that has turned less, as either may be the one whose face the normal is of. Those
  /// of models stay: they are of the last step.
  void carry(btDispatcher& dispatcher, const btCollisionObjectArray& objects);

 private:
  struct Known {
    int id;  ///< of the broad phase, which gives none twice
    btMatrix3x3 basis;
  };

  void turn(btPersistentManifold& manifold) const;
  std::optional<btMatrix3x3> turn_of(const btCollisionObject& body) const;

  std::vector<Known> known_;  ///< by the objects' places in the world
};

/// A Bullet dynamics world in which normals turn with their bodies.
template <class World = btDiscreteDynamicsWorld>
class CarriedNormalsWorld : public World {
 public:
  using World::World;

  /// Brings normals up to date with bodies that have moved since contacts were found.
  void carry_normals() { carried_.carry(*this->getDispatcher(), this->getCollisionObjectArray()); }

  void performDiscreteCollisionDetection() override {
    carry_normals();
    World::performDiscreteCollisionDetection();
  }

 private:
  CarriedNormals carried_;
};

}  // namespace voxshell::bullet
