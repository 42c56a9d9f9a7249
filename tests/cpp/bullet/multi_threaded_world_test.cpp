#include <cstddef>
#include <memory>
#include <vector>

#include <BulletCollision/CollisionDispatch/btCollisionDispatcherMt.h>
#include <BulletDynamics/Dynamics/btDiscreteDynamicsWorldMt.h>
#include <LinearMath/btThreads.h>
#include <gtest/gtest.h>

#include "support/drop.h"
#include "support/ground.h"
#include "support/models.h"
#include "support/random.h"
#include "support/world.h"

namespace voxshell::bullet::multi_threaded_world_test {
namespace {

using namespace test_support;
using voxshell::test_support::Random;

struct SolverPool : btConstraintSolverPoolMt {
  SolverPool() : btConstraintSolverPoolMt(BT_MAX_THREAD_COUNT) {}
};

struct DiscreteWorldMt : btDiscreteDynamicsWorldMt {
  DiscreteWorldMt(btDispatcher* dispatcher, btBroadphaseInterface* broadphase, SolverPool* pool,
                  btCollisionConfiguration* configuration)
      : btDiscreteDynamicsWorldMt(dispatcher, broadphase, pool, nullptr, configuration) {}
};

using TestWorldMt = WorldOf<DiscreteWorldMt, SolverPool, btCollisionDispatcherMt>;

/// Bullet's classes for threads want a scheduler. Where Bullet was built without BT_THREADSAFE, as
/// Debian builds it, there is the sequential one alone.
class MultiThreadedWorld : public testing::TestWithParam<ContactMode> {
 protected:
  MultiThreadedWorld() {
    // Its threads look at its clock for a while after it has ended: it stays.
    static btITaskScheduler* const own = btCreateDefaultTaskScheduler();
    btSetTaskScheduler(own != nullptr ? own : btGetSequentialTaskScheduler());
  }
  ~MultiThreadedWorld() override { btSetTaskScheduler(nullptr); }
};

INSTANTIATE_TEST_SUITE_P(Modes, MultiThreadedWorld,
                         testing::Values(ContactMode::kRegular, ContactMode::kSegmented));

TEST_P(MultiThreadedWorld, BringsADroppedModelToRest) {
  Random random(52);
  for (const Ground ground : {Ground::kPlane, Ground::kBox, Ground::kModel}) {
    SCOPED_TRACE(to_string(ground));
    TestWorldMt world({.mode = GetParam()});
    add_ground(world, ground).setFriction(1);
    btRigidBody& body =
        add_at_principal_frame(world, blob_model(), 1, {random.rotation(), {0, 0, 0.3}});
    body.setFriction(scalar(0.8));
    body.setRollingFriction(scalar(0.005));
    body.setDamping(0, scalar(0.05));
    body.setActivationState(DISABLE_DEACTIVATION);
    expect_calm_landing(world, body);
  }
}

/// Twelve cubes in four piles that do not touch each other: four islands.
template <class World>
std::vector<btRigidBody*> pile_up(World& world) {
  add_ground(world, Ground::kModel).setFriction(1);
  std::vector<btRigidBody*> cubes;
  for (int i = 0; i < 12; ++i) {
    const Vec3 at{0.26 * (i % 2) - 0.13, 0.26 * (i / 2 % 2) - 0.13, 0.11 + 0.21 * (i / 4)};
    cubes.push_back(&world.add_model(cube_model(), 1, {{}, at}));
    cubes.back()->setFriction(scalar(0.6));
  }
  world.step(600);
  return cubes;
}

TEST_P(MultiThreadedWorld, PilesUpAsOneOfOneThread) {
  TestWorld one({.mode = GetParam()});
  TestWorldMt many({.mode = GetParam()});
  const auto in_one = pile_up(one);
  const auto in_many = pile_up(many);
  for (std::size_t i = 0; i < in_one.size(); ++i) {
    EXPECT_LT((place_of(*in_one[i]) - place_of(*in_many[i])).length(), scalar(0.005)) << i;
    EXPECT_NEAR(height(*in_many[i]), 0.1 + 0.2 * static_cast<double>(i / 4), 0.001) << i;
  }
}

}  // namespace
}  // namespace voxshell::bullet::multi_threaded_world_test
