#include <atomic>
#include <cstdlib>
#include <new>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/multi_body.h"
#include "support/world.h"
#include "voxshell/bullet/model_shape.h"
#include "voxshell/smooth_surface.h"

namespace {

std::atomic<long> allocations{0};

/// What Bullet's containers take, the adapter's among them.
void* allocate_for_bullet(std::size_t size) {
  ++allocations;
  return std::malloc(size);
}

}  // namespace

// Not inline, or compilers see a malloc freed by delete.
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations;
  return std::malloc(size == 0 ? 1 : size);
}
[[gnu::noinline]] void* operator new(std::size_t size) {
  if (void* memory = operator new(size, std::nothrow)) return memory;
  throw std::bad_alloc();
}
void* operator new[](std::size_t size, const std::nothrow_t& tag) noexcept {
  return operator new(size, tag);
}
void* operator new[](std::size_t size) { return operator new(size); }
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { operator delete(memory); }
void operator delete[](void* memory) noexcept { operator delete(memory); }
void operator delete[](void* memory, std::size_t) noexcept { operator delete(memory); }

namespace voxshell::bullet::allocation_test {
namespace {

using namespace test_support;

class Allocation : public testing::TestWithParam<ContactMode> {
 protected:
  static void SetUpTestSuite() { btAlignedAllocSetCustom(&allocate_for_bullet, &std::free); }

  /// In 200 steps of a world that has settled.
  template <class World>
  static long count_in(World& world, int settling = 600) {
    world.step(settling);
    const long before = allocations;
    world.step(200);
    return allocations - before;
  }
};

INSTANTIATE_TEST_SUITE_P(Modes, Allocation,
                         testing::Values(ContactMode::kRegular, ContactMode::kSegmented));

TEST_P(Allocation, IsNoneInASettledStep) {
  TestWorld world({.mode = GetParam()});
  world.add(world.make<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0).setFriction(1);
  world.add(world.make<btBoxShape>(to_bullet(Vec3{0.3, 0.3, 0.1})), 0, {{}, {1, 0, 0.1}});
  auto& compound = world.make<btCompoundShape>();
  compound.addChildShape(btTransform::getIdentity(), &world.make<ModelShape>(cube_model()));
  // One child lies half a millimeter over a box, near enough to be tried without touching.
  world.add(world.make<btBoxShape>(to_bullet(Vec3{0.4, 0.4, 0.1})), 0, {{}, {0, 6, 0.1}});
  auto& lifted = world.make<btCompoundShape>();
  lifted.addChildShape(btTransform::getIdentity(), &world.make<ModelShape>(cube_model()));
  lifted.addChildShape(to_bullet(Pose{{}, {0.25, 0, 0.0005}}),
                       &world.make<ModelShape>(cube_model()));
  world.add_model(slab_model(), 0, {{}, {0, 2, 0.1}}).setFriction(1);
  auto& hull = world.make<btConvexHullShape>();
  for (const Vec3& v : voxshell::test_support::make_box({0.1, 0.1, 0.1}).vertices) {
    hull.addPoint(to_bullet(v));
  }
  world.add_model(slab_model(), 0, {{}, {0, 4, 0.1}}).setFriction(1);
  btRigidBody* const bodies[] = {&world.add_model(cube_model(), 1, {{}, {0, 0, 0.1}}),
                                 &world.add_model(torus_model(), 1, {{}, {0, 2, 0.13}}),
                                 &world.add_model(cube_model(), 1, {{}, {1, 0, 0.3}}),
                                 &world.add(compound, 1, {{}, {2, 0, 0.1}}),
                                 &world.add(hull, 1, {{}, {0, 4, 0.25}}),
                                 &world.add(lifted, 1, {{}, {-0.1, 6, 0.3}})};
  for (btRigidBody* body : bodies) {
    body->setFriction(scalar(0.8));
    body->setActivationState(DISABLE_DEACTIVATION);
  }
  TestWorld of_bullet;  // allocates once a step, whatever lies in it
  of_bullet.add(of_bullet.make<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0);
  of_bullet.add(of_bullet.make<btBoxShape>(to_bullet(Vec3{0.1, 0.1, 0.1})), 1, {{}, {0, 0, 0.1}})
      .setActivationState(DISABLE_DEACTIVATION);
  EXPECT_EQ(count_in(world), count_in(of_bullet));
  EXPECT_GE(world.points().size(), 16u);
}

TEST_P(Allocation, IsNoneInASettledStepOfAMultiBody) {
  MultiBodyWorld world({.mode = GetParam()});
  world.add_model(slab_model(), 0).setFriction(1);
  auto& shape = world.make<ModelShape>(cube_model());
  Tree cube(world, Tree::Base::kFree, {&shape}, {{}, {0, 0, 0.11}});
  cube.body.setCanSleep(false);
  cube.enter_world();
  MultiBodyWorld of_bullet;
  of_bullet.add(of_bullet.make<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0);
  auto& box = of_bullet.make<btBoxShape>(to_bullet(Vec3{0.1, 0.1, 0.1}));
  Tree bullet_cube(of_bullet, Tree::Base::kFree, {&box}, {{}, {0, 0, 0.11}});
  bullet_cube.body.setCanSleep(false);
  bullet_cube.enter_world();
  // It trembles by micrometers per second, and only then has searched in all ways.
  EXPECT_EQ(count_in(world, 1000), count_in(of_bullet));
  EXPECT_GE(world.points().size(), 3u);
}

TEST_P(Allocation, IsCounted) {
  const long before = allocations;
  TestWorld world({.mode = GetParam()});
  world.add_model(slab_model(), 0);
  world.add_model(cube_model(), 1, {{}, {0, 0, 0.099}});
  const long built = allocations;
  world.world.performDiscreteCollisionDetection();
  EXPECT_GT(built, before);
  EXPECT_GT(allocations, built);  // the first step does allocate
}

TEST(AllocationOfShapes, LeavesNothingOfARoundModelToTheStepInWhichItMeetsAnother) {
  const auto model = build_by_tolerance(voxshell::test_support::make_blob(0.1, 3));
  const ModelShape shape(model);
  const long before = allocations;
  ASSERT_TRUE(model->smooth_surface().is_curved());
  model->smooth_surface().nearest({0.2, 0.1, 0.0});
  EXPECT_EQ(allocations, before);
}

}  // namespace
}  // namespace voxshell::bullet::allocation_test
