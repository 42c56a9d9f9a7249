#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <BulletDynamics/Featherstone/btMultiBody.h>
#include <BulletDynamics/Featherstone/btMultiBodyConstraintSolver.h>
#include <BulletDynamics/Featherstone/btMultiBodyDynamicsWorld.h>
#include <BulletDynamics/Featherstone/btMultiBodyLinkCollider.h>

#include "support/world.h"

namespace voxshell::bullet::test_support {

using MultiBodyWorld = WorldOf<btMultiBodyDynamicsWorld, btMultiBodyConstraintSolver>;

/// A tree of bodies in reduced coordinates, each of 1 kg, in a world while it lives.
class Tree {
 public:
  enum class Base { kFree, kFixed };

  Tree(MultiBodyWorld& world, Base base, const std::vector<btCollisionShape*>& shapes,
       const Pose& world_from_base)
      : body(static_cast<int>(shapes.size()) - 1, 1, inertia_of(*shapes[0]), base == Base::kFixed,
             /*canSleep=*/true),
        world_(world),
        shapes_(shapes) {
    body.setBaseWorldTransform(to_bullet(world_from_base));
    body.setLinearDamping(0);
    body.setAngularDamping(scalar(0.05));
  }
  ~Tree() {
    for (const auto& collider : colliders) world_.world.removeCollisionObject(collider.get());
    world_.world.removeMultiBody(&body);
  }
  Tree(const Tree&) = delete;
  Tree& operator=(const Tree&) = delete;

  static btVector3 inertia_of(const btCollisionShape& shape) {
    btVector3 inertia;
    shape.calculateLocalInertia(1, inertia);
    return inertia;
  }

  /// Once all joints are set up.
  void enter_world() {
    body.finalizeMultiDof();
    world_.world.addMultiBody(&body);
    for (int link = -1; link < body.getNumLinks(); ++link) {
      colliders.push_back(std::make_unique<btMultiBodyLinkCollider>(&body, link));
      btMultiBodyLinkCollider* collider = colliders.back().get();
      collider->setCollisionShape(shapes_[colliders.size() - 1]);
      collider->setFriction(scalar(0.8));
      if (link < 0) {
        body.setBaseCollider(collider);
      } else {
        body.getLink(link).m_collider = collider;
      }
      world_.world.addCollisionObject(collider, btBroadphaseProxy::DefaultFilter,
                                      btBroadphaseProxy::AllFilter);
    }
    btAlignedObjectArray<btQuaternion> rotations;
    btAlignedObjectArray<btVector3> origins;
    body.forwardKinematics(rotations, origins);
    body.updateCollisionObjectWorldTransforms(rotations, origins);
  }

  struct Velocities {
    btAlignedObjectArray<btVector3> linear;  ///< of the base, then the links, each in its frame
    btAlignedObjectArray<btVector3> angular;
  };
  Velocities velocities() const {
    Velocities v;
    v.linear.resize(body.getNumLinks() + 1);
    v.angular.resize(body.getNumLinks() + 1);
    body.compTreeLinkVelocities(&v.angular[0], &v.linear[0]);
    return v;
  }

  btMultiBody body;
  std::vector<std::unique_ptr<btMultiBodyLinkCollider>> colliders;  ///< of the base, then the links

 private:
  MultiBodyWorld& world_;
  std::vector<btCollisionShape*> shapes_;
};

/// Of the last link, or the base where there is none.
inline btVector3 place_of(const Tree& tree) {
  return tree.colliders.back()->getWorldTransform().getOrigin();
}

inline double turn_of(const Tree& tree) {
  return static_cast<double>(tree.velocities().angular[tree.body.getNumLinks()].length());
}

inline double energy_of(const Tree& tree) {
  const Tree::Velocities v = tree.velocities();
  double sum = 0.0;
  for (int i = tree.body.hasFixedBase() ? 1 : 0; i <= tree.body.getNumLinks(); ++i) {
    const btVector3& inertia =
        i == 0 ? tree.body.getBaseInertia() : tree.body.getLinkInertia(i - 1);
    const btTransform& at = tree.colliders[static_cast<std::size_t>(i)]->getWorldTransform();
    sum += 9.81 * static_cast<double>(at.getOrigin().z()) +
           0.5 * static_cast<double>(v.linear[i].length2()) +
           0.5 * static_cast<double>((inertia * v.angular[i]).dot(v.angular[i]));
  }
  return sum;
}

}  // namespace voxshell::bullet::test_support
