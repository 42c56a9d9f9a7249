#pragma once

#include <optional>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

namespace voxshell::bullet {

/// Lets the normals of contacts between Bullet's own shapes turn with the bodies.
///
/// Bullet keeps a contact for several steps. Meanwhile its places move with the bodies, and its
/// normal stays as it was. When a tray tips with a box on it, Bullet finds two of the box's corners
/// again and keeps the other two, with the normal of the level tray. They hold the box at any
/// slope.
class CarriedNormals {
 public:
  /// Turns the normals of a world's contacts like the body that has turned less since the last
  /// call: a normal belongs to a face of either body, and Bullet does not say which. Contacts of
  /// models stay as they are, because their algorithm sets their normals in each step.
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
