#include "deep_on_the_way.h"

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/two_bodies.h"

namespace voxshell::bullet::deep_on_the_way_test {
namespace {

using namespace test_support;
using voxshell::test_support::make_box;

constexpr double kStep = 1.0 / 100.0;

/// A cube, 2 cm wide, at a height above the middle of a plate of 4 mm, which falls without gravity.
struct Fall {
  Fall(double gap, double speed, double spin = 0.0)
      : plate(world.add_model(build_by_tolerance(make_box({0.2, 0.2, 0.002})), 0,
                              {{}, {0, 0, -0.002}})),
        cube(world.add_model(build_by_tolerance(make_box({0.01, 0.01, 0.01})), 1,
                             {{}, {0, 0, 0.01 + gap}})) {
    cube.setLinearVelocity(to_bullet(Vec3{0, 0, -speed}));
    cube.setAngularVelocity(to_bullet(Vec3{0, spin, 0}));
  }

  /// In either order of the bodies.
  bool may_be_deep(double depth) {
    const TwoBodies bodies(plate, cube);
    const TwoBodies swapped(cube, plate);
    const bool is_deep = may_be_deep_on_the_way(bodies.pair, kStep, depth);
    EXPECT_EQ(is_deep, may_be_deep_on_the_way(swapped.pair, kStep, depth));
    return is_deep;
  }

  TestWorld world{{}, {0, 0, 0}};
  btRigidBody& plate;
  btRigidBody& cube;
};

TEST(DeepOnTheWay, IsWhatEndsTheStepInTheOtherBody) {
  EXPECT_TRUE(Fall(0.002, 0.3).may_be_deep(0.0009));  // 1 mm
  EXPECT_FALSE(Fall(0.002, 0.3).may_be_deep(0.0011));
  EXPECT_FALSE(Fall(0.002, 0.19).may_be_deep(0.0));
  EXPECT_FALSE(Fall(0.0, 0.0).may_be_deep(0.0001));   // at rest, in contact
  EXPECT_FALSE(Fall(0.0, -1.0).may_be_deep(0.0001));  // flies away
}

// It is 16 mm below the plate at the end.
TEST(DeepOnTheWay, IsWhatHasPassedThroughTheOtherBody) {
  EXPECT_TRUE(Fall(0.01, 5.0).may_be_deep(0.0005));
  EXPECT_FALSE(Fall(0.07, 5.0).may_be_deep(0.0005));
}

// Its corner is 14.1 mm from the middle once it is turned by an eighth of a turn, 10 mm before.
TEST(DeepOnTheWay, IsWhatTurnsIntoTheOtherBody) {
  EXPECT_TRUE(Fall(0.001, 0.0, 60.0).may_be_deep(0.001));
  EXPECT_FALSE(Fall(0.005, 0.0, 60.0).may_be_deep(0.0));
}

TEST(DeepOnTheWay, IsNotKnownOfWhatIsTooFastOrNoModel) {
  EXPECT_TRUE(Fall(0.5, -100.0).may_be_deep(0.001));
  Fall fall(0.5, 0.0);
  btRigidBody& box = fall.world.add(
      fall.world.make<btBoxShape>(btVector3(scalar(0.01), scalar(0.01), scalar(0.01))), 1,
      {{}, {0, 0, 1}});
  const TwoBodies bodies(fall.plate, box);
  EXPECT_TRUE(may_be_deep_on_the_way(bodies.pair, kStep, 0.001));
}

}  // namespace
}  // namespace voxshell::bullet::deep_on_the_way_test
