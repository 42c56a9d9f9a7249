#include "voxshell/bullet/parallel_dispatcher.h"

#include <memory>
#include <vector>

#include <BulletCollision/BroadphaseCollision/btDbvtBroadphase.h>
#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <gtest/gtest.h>

#include "support/models.h"
#include "support/random.h"
#include "support/world.h"
#include "voxshell/bullet/collision_configuration.h"
#include "voxshell/bullet/convert.h"
#include "voxshell/bullet/model_shape.h"
#include "voxshell/bullet/seamless_world.h"

namespace voxshell::bullet::parallel_dispatcher_test {
namespace {

using namespace test_support;
using voxshell::test_support::Random;

/// A heap of models, boxes and a compound that has fallen for a while, on a number of threads: all
/// places, and whether threads were of use.
struct Heap {
  std::vector<Vec3> places;
  bool was_parallel = false;
};

Heap drop_heap(unsigned threads) {
  CollisionConfiguration configuration;
  ParallelDispatcher dispatcher(&configuration, threads);
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  SeamlessWorld<> world(&dispatcher, &broadphase, &solver, &configuration);
  world.getDispatchInfo().m_deterministicOverlappingPairs = true;
  ModelShape ground(slab_model());
  ModelShape blob(blob_model());
  ModelShape torus(torus_model());
  btBoxShape box(btVector3(scalar(0.05), scalar(0.08), scalar(0.06)));
  btCompoundShape compound;
  compound.addChildShape(btTransform::getIdentity(), &torus);
  std::vector<std::unique_ptr<btRigidBody>> bodies;
  const auto add = [&](btCollisionShape& shape, double mass, const Pose& pose) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0.0) shape.calculateLocalInertia(scalar(mass), inertia);
    btRigidBody::btRigidBodyConstructionInfo info(scalar(mass), nullptr, &shape, inertia);
    info.m_startWorldTransform = to_bullet(pose);
    bodies.push_back(std::make_unique<btRigidBody>(info));
    world.addRigidBody(bodies.back().get());
  };
  add(ground, 0.0, {});
  Random random(3);
  btCollisionShape* const shapes[] = {&blob, &torus, &box, &compound};
  for (int i = 0; i < 24; ++i) {
    Pose pose = random.pose(0.0);
    pose.translation = {0.15 * (i % 3 - 1), 0.15 * (i / 3 % 3 - 1), 0.2 + 0.15 * (i / 9)};
    add(*shapes[i % 4], 1.0, pose);
  }
  Heap heap;
  for (int step = 0; step < 80; ++step) {
    world.stepSimulation(scalar(0.01), 0);
    heap.was_parallel = heap.was_parallel || dispatcher.parallel_seconds() > 0.0;
  }
  for (const auto& body : bodies) {
    heap.places.push_back(from_bullet(body->getWorldTransform().getOrigin()));
    world.removeRigidBody(body.get());
  }
  return heap;
}

TEST(ParallelDispatcher, TakesTheSameStepsOnAnyNumberOfThreads) {
  const Heap one = drop_heap(1);
  EXPECT_FALSE(one.was_parallel);
  for (const unsigned threads : {2u, 3u, 8u}) {
    const Heap many = drop_heap(threads);
    EXPECT_TRUE(many.was_parallel) << threads;
    EXPECT_EQ(many.places, one.places) << threads;
  }
}

}  // namespace
}  // namespace voxshell::bullet::parallel_dispatcher_test
