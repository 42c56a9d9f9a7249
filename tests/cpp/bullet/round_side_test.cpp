#include "round_side.h"

#include <cmath>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/world.h"
#include "voxshell/bullet/convert.h"

namespace voxshell::bullet {
namespace {

using namespace test_support;

constexpr double kLeastCurvature = 0.01;
const Vec3 kDirection = normalized(Vec3{0.6, 0.0, -0.8});

/// The one side of a body, in the frame of its geometry.
struct OneSide {
  explicit OneSide(const btRigidBody& body)
      : wrap(nullptr, body.getCollisionShape(), &body, body.getWorldTransform(), -1, -1),
        side(wrap, nullptr) {}

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

}  // namespace
}  // namespace voxshell::bullet
