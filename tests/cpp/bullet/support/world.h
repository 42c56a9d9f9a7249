#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include <btBulletDynamicsCommon.h>

#include "voxshell/bullet/collision_configuration.h"
#include "voxshell/bullet/convert.h"
#include "voxshell/bullet/model_shape.h"

namespace voxshell::bullet::test_support {

inline btScalar scalar(double x) { return static_cast<btScalar>(x); }

inline constexpr bool kIsDouble = sizeof(btScalar) == sizeof(double);

/// A stock world with the adapter's collision configuration, and all that lives in it.
template <class World, class Solver, class Dispatcher = btCollisionDispatcher>
class WorldOf {
 public:
  explicit WorldOf(const ContactSettings& settings = {}, const Vec3& gravity = {0, 0, -9.81})
      : configuration(settings) {
    world.setGravity(to_bullet(gravity));
    world.getSolverInfo().m_splitImpulse = 1;
    world.getSolverInfo().m_splitImpulsePenetrationThreshold = 0;
    world.getDispatchInfo().m_deterministicOverlappingPairs = true;
  }
  ~WorldOf() {
    for (const auto& body : bodies_) {
      if (body->getBroadphaseHandle() != nullptr) world.removeRigidBody(body.get());
    }
  }
  WorldOf(const WorldOf&) = delete;
  WorldOf& operator=(const WorldOf&) = delete;

  template <class Shape, class... Args>
  Shape& make(Args&&... args) {
    auto shape = std::make_unique<Shape>(std::forward<Args>(args)...);
    Shape& made = *shape;
    shapes_.push_back(std::move(shape));
    return made;
  }

  /// Friction, restitution and damping 0; mass 0: static.
  btRigidBody& add(btCollisionShape& shape, double mass, const Pose& world_from_body = {}) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0.0) shape.calculateLocalInertia(scalar(mass), inertia);
    btRigidBody::btRigidBodyConstructionInfo info(scalar(mass), nullptr, &shape, inertia);
    info.m_startWorldTransform = to_bullet(world_from_body);
    info.m_friction = 0;
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    world.addRigidBody(bodies_.back().get());
    return *bodies_.back();
  }

  btRigidBody& add_model(const std::shared_ptr<const Model>& model, double mass,
                         const Pose& world_from_body = {}) {
    return add(make<ModelShape>(model), mass, world_from_body);
  }

  void step(int count, double time_step = 1.0 / 200.0) {
    for (int i = 0; i < count; ++i) {
      world.stepSimulation(scalar(time_step), 0, scalar(time_step));
    }
  }

  std::vector<const btManifoldPoint*> points() {
    std::vector<const btManifoldPoint*> all;
    for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
      const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(m);
      for (int i = 0; i < manifold.getNumContacts(); ++i) {
        all.push_back(&manifold.getContactPoint(i));
      }
    }
    return all;
  }

 private:
  // Destroyed after the world, which refers to them.
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;

 public:
  CollisionConfiguration configuration;
  Dispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  Solver solver;
  World world{&dispatcher, &broadphase, &solver, &configuration};
};

using TestWorld = WorldOf<btDiscreteDynamicsWorld, btSequentialImpulseConstraintSolver>;

inline double height(const btRigidBody& body) {
  return static_cast<double>(body.getWorldTransform().getOrigin().z());
}

}  // namespace voxshell::bullet::test_support
