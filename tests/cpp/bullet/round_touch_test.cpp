#include "round_touch.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "contact_list.h"
#include "speculative_contacts.h"
#include "support/models.h"
#include "support/two_bodies.h"
#include "support/world.h"

namespace voxshell::bullet::round_touch_test {
namespace {

using namespace test_support;

constexpr double kStep = 1.0 / 60.0;

/// A ball over a plane, and what of its points is within the step's margin of that.
struct Rolling {
  explicit Rolling(double spin, const Vec3& velocity)
      : ball(world.add_model(ball_model(), 1, {{}, {0, 0, kBallRadius + 0.002}})),
        plane(world.add(world.make<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0)),
        bodies(ball, plane) {
    ball.setLinearVelocity(to_bullet(velocity));
    ball.setAngularVelocity(to_bullet(Vec3{0, spin, 0}));
    step = bodies.step(kStep);
    near = bodies.near(step.margin);
  }

  TestWorld world{{}, {0, 0, 0}};
  btRigidBody& ball;
  btRigidBody& plane;
  TwoBodies bodies;
  PairStep step{};
  std::vector<Contact> near;
};

TEST(RoundTouch, LeavesNoLeverToTheSpinOfABall) {
  const Rolling rolling(30.0, {30.0 * kBallRadius, 0, -0.5});
  int touching = 0;
  for (const Contact& contact : rolling.near) {
    // What is behind the lowest place turns away from the ground.
    if (!(contact.point.x > 0.0f)) continue;
    const auto found = find_speculative(rolling.step, rolling.step.motion, {}, contact, 1.0);
    if (!found) continue;
    ++touching;
    const Vec3 aside = cross(static_cast<Vec3>(found->point), static_cast<Vec3>(found->normal));
    EXPECT_LE(length(aside), 0.01 * kBallRadius) << contact.id;
    EXPECT_NEAR(-found->depth, 0.002, 5e-4) << contact.id;
  }
  EXPECT_GT(touching, 1);
}

TEST(RoundTouch, LeavesBodiesAloneThatDoNotTurn) {
  const Rolling falling(0.0, {0, 0, -0.5});
  int touching = 0;
  for (const Contact& contact : falling.near) {
    const auto found = find_speculative(falling.step, falling.step.motion, {}, contact, 1.0);
    if (!found) continue;
    ++touching;
    EXPECT_EQ(found->point, contact.point);
  }
  EXPECT_GT(touching, 0);
}

TEST(RoundTouch, TellsThePlaceThatFaces) {
  const Rolling rolling(30.0, {30.0 * kBallRadius, 0, -0.5});
  EXPECT_TRUE(is_facing(rolling.step, find_deepest(rolling.near)));
  const auto aside = std::ranges::min_element(rolling.near, {}, &Contact::depth);
  EXPECT_FALSE(is_facing(rolling.step, *aside));
}

TEST(RoundTouch, TellsCurvedPartsFromFlatOnes) {
  EXPECT_TRUE(lies_on_curve(*ball_model(), 0));
  EXPECT_FALSE(lies_on_curve(*cube_model(), 0));
}

}  // namespace
}  // namespace voxshell::bullet::round_touch_test
