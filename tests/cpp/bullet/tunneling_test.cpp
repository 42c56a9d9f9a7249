#include <algorithm>
#include <limits>

#include <gtest/gtest.h>

#include "support/drop.h"
#include "support/models.h"
#include "support/random.h"
#include "support/world.h"
#include "voxshell/bullet/force_aware_world.h"

namespace voxshell::bullet::tunneling_test {
namespace {

using namespace test_support;
using voxshell::test_support::Random;

enum class Ground { kPlane, kBox, kModel };

class Throws : public testing::TestWithParam<std::tuple<Ground, ContactMode>> {};

INSTANTIATE_TEST_SUITE_P(
    Grounds, Throws,
    testing::Combine(testing::Values(Ground::kPlane, Ground::kBox, Ground::kModel),
                     testing::Values(ContactMode::kRegular, ContactMode::kSegmented)));

/// 5 cm thick, its top at z = 0.
std::shared_ptr<const Model> slab_model() {
  static const auto slab =
      build_model(voxshell::test_support::moved(voxshell::test_support::make_box({0.5, 0.5, 0.025}),
                                                {0, 0, -0.025}),
                  0.01);
  return slab;
}

/// Such a slab, or a plane at z = 0.
void add_ground(TestWorld& world, Ground ground) {
  switch (ground) {
    case Ground::kPlane:
      world.add(world.make<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0).setFriction(1);
      return;
    case Ground::kBox:
      world.add(world.make<btBoxShape>(to_bullet(Vec3{0.5, 0.5, 0.025})), 0, {{}, {0, 0, -0.025}})
          .setFriction(1);
      return;
    case Ground::kModel:
      world.add_model(slab_model(), 0).setFriction(1);
  }
}

// Without CCD, a step of 5 or 50 m/s at 60 Hz is 8 and 83 cm.
TEST_P(Throws, StayOnTheirSideOfASlab) {
  Random random(3);
  for (const double speed : {5.0, 50.0}) {
    for (const auto& model : {cube_model(), blob_model(), torus_model()}) {
      for (int i = 0; i < 4; ++i) {
        TestWorld world({.mode = std::get<1>(GetParam())});
        add_ground(world, std::get<0>(GetParam()));
        Pose pose = random.pose(0.0);
        pose.translation = {0.0, 0.0, random.uniform(0.5, 1.0)};
        btRigidBody& body = world.add_model(model, 1, pose);
        body.setFriction(1);
        body.setLinearVelocity(btVector3(0, 0, scalar(-speed)));
        ASSERT_GT(lowest_over(world, body, 60, 0.45), 0.0) << "speed " << speed << ", throw " << i;
      }
    }
  }
}

TEST_P(Throws, FallThroughAtNoRate) {
  Random random(4);
  for (const double rate : {60.0, 20.0, 10.0, 5.0}) {
    for (int i = 0; i < 4; ++i) {
      TestWorld world({.mode = std::get<1>(GetParam())});
      add_ground(world, std::get<0>(GetParam()));
      Pose pose = random.pose(0.0);
      pose.translation = {0.0, 0.0, 0.6};
      btRigidBody& body = world.add_model(blob_model(), 1, pose);
      body.setFriction(1);
      for (int step = 0; step < 40; ++step) {
        world.step(1, 1.0 / rate);
        ASSERT_GT(height(body), 0.0) << rate << " Hz, drop " << i << ", step " << step;
      }
    }
  }
}

// A body at rest falls by 39 cm in a step of 0.2 s; Bullet's own bounds stay where it is.
TEST(Throws, AreFoundAsFarAsGravityTakesThem) {
  for (const double gap : {0.05, 0.2, 0.35}) {
    WorldOf<ForceAwareWorld<>, btSequentialImpulseConstraintSolver> world;
    world.add_model(slab_model(), 0);
    btRigidBody& ball = world.add_model(ball_model(), 1, {{}, {0, 0, kBallRadius + gap}});
    world.step(1, 0.2);
    EXPECT_NEAR(height(ball), kBallRadius, 0.005) << "from " << gap;
  }
}

/// A compound of two children, neither about its middle.
btCompoundShape& make_compound(TestWorld& world, btCollisionShape& child) {
  auto& compound = world.make<btCompoundShape>();
  compound.addChildShape(to_bullet(Pose{{}, {0.1, 0, 0}}), &child);
  compound.addChildShape(to_bullet(Pose{{}, {-0.1, 0.05, 0}}), &child);
  return compound;
}

// Bullet itself tries children once their bounds overlap those of the other shape.
TEST(Throws, OfCompoundsStayOnTheirSide) {
  Random random(5);
  enum class Child { kModel, kBox };
  for (const Child child : {Child::kModel, Child::kBox}) {
    for (const bool onto_compound : {false, true}) {
      for (const bool ground_first : {false, true}) {
        for (const double speed : {5.0, 50.0}) {
          TestWorld world({}, {0, 0, 0});
          btCollisionShape* slab =
              child == Child::kModel && !onto_compound
                  ? &world.make<btBoxShape>(to_bullet(Vec3{0.5, 0.5, 0.025}))
                  : static_cast<btCollisionShape*>(&world.make<ModelShape>(slab_model()));
          const double top = slab->isConvex() ? 0.025 : 0.0;
          if (onto_compound) {
            auto& compound = world.make<btCompoundShape>();
            compound.addChildShape(btTransform::getIdentity(), slab);
            slab = &compound;
          }
          if (ground_first) world.add(*slab, 0).setFriction(1);
          btCollisionShape& part =
              child == Child::kModel
                  ? static_cast<btCollisionShape&>(world.make<ModelShape>(blob_model()))
                  : world.make<btBoxShape>(to_bullet(Vec3{0.02, 0.03, 0.04}));
          Pose pose = random.pose(0.0);
          pose.translation = {0.0, 0.0, random.uniform(0.5, 1.0)};
          btRigidBody& body = world.add(make_compound(world, part), 1, pose);
          if (!ground_first) world.add(*slab, 0).setFriction(1);
          body.setFriction(1);
          body.setLinearVelocity(btVector3(0, 0, scalar(-speed)));
          ASSERT_GT(lowest_over(world, body, 40, 0.3), top - 0.01)
              << (child == Child::kModel ? "models" : "boxes") << " at "
              << (onto_compound ? "a compound" : "a slab") << ", speed " << speed;
        }
      }
    }
  }
}

// A child that is slow beside its size is not beside what it lands on.
TEST(Throws, OfThickChildrenStopAtThinModels) {
  const auto cube = build_model(voxshell::test_support::make_box({0.1, 0.1, 0.1}), 0.02);
  const auto sheet = build_model(voxshell::test_support::make_box({0.3, 0.3, 0.0025}), 0.001);
  for (const double start : {0.105, 0.11, 0.115, 0.12, 0.125}) {
    TestWorld world({}, {0, 0, 0});
    world.add_model(sheet, 0);
    auto& compound = world.make<btCompoundShape>();
    compound.addChildShape(to_bullet(Pose{{}, {0.003, 0.004, 0}}), &world.make<ModelShape>(cube));
    btRigidBody& body = world.add(compound, 1, {{}, {0, 0, start}});
    body.setLinearVelocity(btVector3(0, 0, scalar(-1.4)));
    world.step(60, 1.0 / 60.0);
    EXPECT_GT(height(body), 0.1) << start;
  }
}

// What stops a body early must not stop it where it would have passed.
TEST(Throws, PassBesideAnEdge) {
  TestWorld world({}, {0, 0, 0});
  world.add_model(cube_model(), 0);
  btRigidBody& body = world.add_model(ball_model(), 1, {{}, {0.205, 0, 1.0}});
  body.setLinearVelocity(btVector3(0, 0, -50));
  world.step(6, 1.0 / 60.0);
  EXPECT_NEAR(height(body), 1.0 - 50 * 6 / 60.0, 1e-3);
  EXPECT_NEAR(body.getLinearVelocity().x(), 0.0, 1e-3);
}

TEST(Throws, PenetrateFirstWithoutCcd) {
  TestWorld world({.ccd_motion_threshold = std::numeric_limits<double>::infinity()});
  add_ground(world, Ground::kPlane);
  world.add_model(ball_model(), 1, {{}, {0, 0, 0.6}});
  double deepest = 0.0;
  for (int i = 0; i < 100; ++i) {
    world.step(1, 1.0 / 60.0);
    for (const btManifoldPoint* point : world.points()) {
      deepest = std::max(deepest, -static_cast<double>(point->getDistance()));
    }
  }
  EXPECT_GT(deepest, 0.01);
}

}  // namespace
}  // namespace voxshell::bullet::tunneling_test
