#pragma once

#include <optional>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btDispatcher.h>
#include <BulletCollision/CollisionDispatch/btCollisionObject.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorld.h>

namespace voxshell::bullet {

/// Keeps the contacts that Bullet's own shapes carry over from earlier steps true.
///
/// Bullet keeps a contact for several steps. Meanwhile its places move with the bodies, and its
/// normal stays as it was. When a tray tips with a box on it, Bullet finds two of the box's corners
/// again and keeps the other two, with the normal of the level tray. They hold the box at any
/// slope. Besides, Bullet drops contacts whose places have slid apart only after it has added new
/// ones, of which a manifold has room for four: a box that slides by more than a 50th of its size
/// in a step keeps one or two of its corners, and sinks with the others.
class CarriedContacts {
 public:
  /// Call it before Bullet looks for contacts. It turns the normals of a world's contacts like the
  /// body that has turned less since the last call: a normal belongs to a face of either body, and
  /// Bullet does not say which. It drops contacts whose places have slid apart. Contacts of models
  /// stay as they are, because their algorithm finds them in each step.
  void renew(btDispatcher& dispatcher, const btCollisionObjectArray& objects);

 private:
  struct Known {
    int id;  ///< of the broad phase, which gives none twice
    btMatrix3x3 basis;
  };

  void turn(btPersistentManifold& manifold) const;
  std::optional<btMatrix3x3> turn_of(const btCollisionObject& body) const;

  std::vector<Known> known_;  ///< by the objects' places in the world
};

/// A Bullet dynamics world in which carried contacts are true.
template <class World = btDiscreteDynamicsWorld>
class CarriedContactsWorld : public World {
 public:
  using World::World;

  /// Brings contacts up to date with bodies that have moved since they were found.
  void renew_carried_contacts() {
    carried_.renew(*this->getDispatcher(), this->getCollisionObjectArray());
  }

  void performDiscreteCollisionDetection() override {
    renew_carried_contacts();
    World::performDiscreteCollisionDetection();
  }

 private:
  CarriedContacts carried_;
};

}  // namespace voxshell::bullet
