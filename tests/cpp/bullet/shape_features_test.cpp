#include "shape_features.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <gtest/gtest.h>

#include "support/deepest_result.h"
#include "support/drop.h"
#include "support/models.h"
#include "support/random.h"
#include "support/world.h"

namespace voxshell::bullet::shape_features_test {
namespace {

using namespace test_support;
using voxshell::test_support::make_box;
using voxshell::test_support::moved;
using voxshell::test_support::Random;

/// A shape that meets a model by its field, smaller than ground() is coarse.
struct Small {
  const char* name;
  std::function<btCollisionShape&(TestWorld&)> make;
};

const std::vector<Small>& small_shapes() {
  static const std::vector<Small> all{
      {"Box",
       [](TestWorld& w) -> btCollisionShape& {
         return w.make<btBoxShape>(to_bullet(Vec3{0.01, 0.03, 0.05}));
       }},
      {"Ball",
       [](TestWorld& w) -> btCollisionShape& { return w.make<btSphereShape>(scalar(0.01)); }},
      {"Capsule",
       [](TestWorld& w) -> btCollisionShape& {
         return w.make<btCapsuleShape>(scalar(0.01), scalar(0.06));
       }},
      {"Cylinder",
       [](TestWorld& w) -> btCollisionShape& {
         return w.make<btCylinderShapeZ>(to_bullet(Vec3{0.02, 0.02, 0.02}));
       }},
      {"Cone",
       [](TestWorld& w) -> btCollisionShape& {
         auto& cone = w.make<btConeShapeZ>(scalar(0.02), scalar(0.04));
         cone.setMargin(scalar(0.001));
         return cone;
       }},
  };
  return all;
}

/// A block whose points are `spacing` apart, its top at z = 0.
std::shared_ptr<const Model> ground(double spacing, double thickness = 0.5) {
  return build_model(moved(make_box({0.6, 0.6, 0.5 * thickness}), {0, 0, -0.5 * thickness}),
                     spacing);
}

class SmallShape : public testing::TestWithParam<std::size_t> {
 protected:
  btCollisionShape& make(TestWorld& world) const { return small_shapes()[GetParam()].make(world); }
};

INSTANTIATE_TEST_SUITE_P(On, SmallShape, testing::Range<std::size_t>(0, 5),
                         [](const auto& tested) { return small_shapes()[tested.param].name; });

TEST_P(SmallShape, LiesStillOnPointsAsFarApartAsItIsLarge) {
  const auto block = ground(0.02);
  Random random(7);
  for (const double rate : {60.0, 200.0}) {
    for (int i = 0; i < 6; ++i) {
      TestWorld world;
      world.add_model(block, 0).setFriction(scalar(0.6));
      Pose pose = random.pose(0.1);
      pose.translation.z = 0.15;
      btRigidBody& body = world.add(make(world), 1, pose);
      body.setFriction(scalar(0.6));
      body.setRollingFriction(scalar(0.002));
      body.setSpinningFriction(scalar(0.002));
      body.setActivationState(DISABLE_DEACTIVATION);
      world.step(static_cast<int>(5 * rate), 1.0 / rate);
      double fastest_turn = 0.0;
      double deepest = 0.0;
      for (int step = 0; step < 60; ++step) {
        world.step(1, 1.0 / rate);
        fastest_turn = std::max(fastest_turn, turn_of(body));
        deepest = std::max(deepest, deepest_of(world));
      }
      EXPECT_GT(height(body), 0.005) << rate << " Hz, drop " << i;
      EXPECT_LT(fastest_turn, 0.01) << rate << " Hz, drop " << i;
      EXPECT_LT(deepest, 1e-4) << rate << " Hz, drop " << i;
    }
  }
}

TEST_P(SmallShape, ThrownAtAThinModelStaysOnItsSide) {
  const auto slab = ground(0.01, 0.05);
  Random random(8);
  for (const double speed : {5.0, 20.0}) {
    for (const double tilt : {0.0, 1.0}) {
      for (int i = 0; i < 6; ++i) {
        TestWorld world({}, {0, 0, 0});
        world.add_model(slab, 0).setFriction(scalar(0.5));
        const Vec3 way{std::sin(tilt), 0, -std::cos(tilt)};
        Pose pose = random.pose(0.1);
        pose.translation = Vec3{-0.2, pose.translation.y, 0} - random.uniform(0.5, 1.0) * way;
        btRigidBody& body = world.add(make(world), 1, pose);
        body.setFriction(scalar(0.5));
        body.setLinearVelocity(to_bullet(speed * way));
        ASSERT_GT(lowest_over(world, body, 40, 0.5), -0.01)
            << speed << " m/s, tilt " << tilt << ", throw " << i;
      }
    }
  }
}

TEST_P(SmallShape, WhollyInsideAModelIsInContactWithIt) {
  for (const bool model_first : {true, false}) {
    TestWorld world({}, {0, 0, 0});
    btRigidBody* model = model_first ? &world.add_model(cube_model(), 0) : nullptr;
    btRigidBody& body = world.add(make(world), 1, {{}, {0.015, 0.005, 0.02}});
    if (!model_first) model = &world.add_model(cube_model(), 0);
    DeepestResult found;
    world.world.contactPairTest(model, &body, found);
    EXPECT_GT(found.depth, 0.02);
    world.step(1);
    EXPECT_FALSE(world.points().empty());
  }
}

// Points that lie in front of a box have the normal of its side.
TEST(CoarseGround, LetsABoxSlideAsFarAsFrictionSays) {
  constexpr double kHalf = 0.25;
  constexpr double kFriction = 0.3;
  const auto block = build_model(moved(make_box({4, 4, 1}), {0, 0, -1}), 0.25);
  for (const double x : {0.0, 0.1, 0.2}) {
    TestWorld world;
    world.add_model(block, 0).setFriction(1);
    btRigidBody& box = world.add(world.make<btBoxShape>(to_bullet(Vec3{kHalf, kHalf, kHalf})), 1,
                                 {{}, {x, x, kHalf}});
    box.setFriction(scalar(kFriction));
    box.setLinearVelocity(btVector3(0, 2, 0));
    world.step(400);
    const double expected = 2.0 * 2.0 / (2.0 * kFriction * 9.81);
    EXPECT_NEAR(static_cast<double>(place_of(box).y()) - x, expected, 0.03 * expected) << x;
    EXPECT_NEAR(height(box), kHalf, 1e-3) << x;
  }
}

// A corner that has passed the middle of a wall is nearer to the wall's far side.
TEST(Features, ArePushedTowardTheMiddleOfTheirShape) {
  const auto wall = ground(0.01, 0.04);
  for (const double depth : {0.005, 0.02, 0.03}) {
    TestWorld world({}, {0, 0, 0});
    world.add_model(wall, 0);
    auto& cone = world.make<btConeShapeZ>(scalar(0.05), scalar(0.2));
    cone.setMargin(scalar(0.0));
    const Pose upside_down{{{1, 0, 0}, {0, -1, 0}, {0, 0, -1}}, {0.003, 0.004, 0.1 - depth}};
    world.add(cone, 1, upside_down);
    world.world.performDiscreteCollisionDetection();
    double deepest = 0.0;
    for (const btManifoldPoint* point : world.points()) {
      if (static_cast<std::uint32_t>(point->m_index0) < kFirstFeature) continue;
      deepest = std::max(deepest, -static_cast<double>(point->getDistance()));
      EXPECT_GT(std::abs(point->m_normalWorldOnB.z()), scalar(0.99));
    }
    EXPECT_NEAR(deepest, depth, 2e-3);
  }
}

}  // namespace
}  // namespace voxshell::bullet::shape_features_test
