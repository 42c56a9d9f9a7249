#include "round_side.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/world.h"
#include "voxshell/bullet/convert.h"
#include "wrap_object.h"

namespace voxshell::bullet::round_side_test {
namespace {

using namespace test_support;

constexpr double kLeastCurvature = 0.01;
const Vec3 kDirection = normalized(Vec3{0.6, 0.0, -0.8});

/// The one side of a body, in the frame of its geometry.
struct OneSide {
  explicit OneSide(const btRigidBody& body) : wrap(wrap_object(body)), side(wrap, nullptr) {}

  btCollisionObjectWrapper wrap;
  Side side;
};

TEST(RoundSide, FindsThePlaceOfABallThatFacesADirection) {
  TestWorld world;
  const OneSide ball(world.add_model(ball_model(), 1, {}));
  const auto found = find_facing(ball.side, {0, 0, -kBallRadius}, kDirection, kLeastCurvature);
  ASSERT_TRUE(found);
  EXPECT_NEAR(length(*found - kBallRadius * kDirection), 0.0, 1e-3 * kBallRadius);
}

TEST(RoundSide, FindsItOnBulletsSpheres) {
  TestWorld world;
  const OneSide ball(world.add(world.make<btSphereShape>(btScalar(0.2)), 1));
  const auto found = find_facing(ball.side, {0, 0, -0.2}, kDirection, kLeastCurvature);
  ASSERT_TRUE(found);
  EXPECT_NEAR(length(*found - 0.2 * kDirection), 0.0, 1e-6);
}

TEST(RoundSide, FindsNoneAlongTheAxisOfACylinder) {
  TestWorld world;
  const OneSide can(world.add(world.make<btCylinderShapeZ>(to_bullet(Vec3{0.1, 0.1, 0.3})), 1));
  EXPECT_TRUE(find_facing(can.side, {0.1, 0, 0}, {0, 1, 0}, kLeastCurvature));
  EXPECT_FALSE(find_facing(can.side, {0.1, 0, 0}, {0, 0, -1}, kLeastCurvature));
}

TEST(RoundSide, FindsNoneOnABox) {
  TestWorld world;
  const OneSide box(world.add(world.make<btBoxShape>(to_bullet(Vec3{0.1, 0.1, 0.1})), 1));
  EXPECT_FALSE(find_facing(box.side, {0, 0, -0.1}, {0, 0, -1}, kLeastCurvature));
}

TEST(RoundSide, FindsTheLowestPlaceOfARim) {
  constexpr double kRadius = 0.1;
  constexpr double kHalf = 0.05;
  const auto can =
      build_by_tolerance(voxshell::test_support::make_cylinder(kRadius, 2.0 * kHalf, 96));
  // Leaning over, it touches with its rim.
  const Vec3 down = normalized(Vec3{0.6, 0.0, -0.3});
  const Vec3 lowest{kRadius, 0.0, -kHalf};
  for (const Vec3& start : {Vec3{0.08, 0.06, -kHalf}, Vec3{0.075, 0.055, -kHalf}}) {
    const auto found = find_lowest_of_rim(*can, start, 0.02, down, kLeastCurvature);
    ASSERT_TRUE(found);
    EXPECT_NEAR(length(*found - lowest), 0.0, 2e-3);
  }
  // The middle of the base is of no rim.
  EXPECT_FALSE(find_lowest_of_rim(*can, {0, 0, -kHalf}, 0.02, down, kLeastCurvature));
}

TEST(RoundSide, ABoxHasNoRim) {
  const auto box = build_by_tolerance(Vec3{0.1, 0.1, 0.1});
  EXPECT_FALSE(find_lowest_of_rim(*box, {0.1, 0, -0.1}, 0.02, {0, 0, -1}, kLeastCurvature));
}

}  // namespace
}  // namespace voxshell::bullet::round_side_test
