#include "sliding_touch.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "contact_list.h"
#include "support/models.h"
#include "support/two_bodies.h"
#include "support/world.h"

namespace voxshell::bullet::sliding_touch_test {
namespace {

using namespace test_support;

constexpr double kStep = 1.0 / 60.0;
constexpr double kHalf = 0.1;

/// A ball beside a box whose edge is above the y axis, and the contact that is nearest now.
struct Falling {
  explicit Falling(const Vec3& place, const Vec3& velocity, const Vec3& spin = {})
      : ball(world.add_model(ball_model(), 1, {{}, place})),
        box(world.add(world.make<btBoxShape>(to_bullet(Vec3{kHalf, kHalf, kHalf})), 0,
                      {{}, {-kHalf, 0, -kHalf}})),
        bodies(ball, box) {
    ball.setLinearVelocity(to_bullet(velocity));
    ball.setAngularVelocity(to_bullet(spin));
    step = bodies.step(kStep);
    nearest = find_deepest(bodies.near(0.1));
  }
  std::optional<Sliding> slide() const { return find_sliding(step, step.motion, nearest, 1.0); }

  TestWorld world{{}, {0, 0, 0}};
  btRigidBody& ball;
  btRigidBody& box;
  TwoBodies bodies;
  PairStep step{};
  Contact nearest{};
};

/// Of a ball that falls with its center beside the edge.
void expect_plane_of_edge(const Falling& falling, double beside, double height) {
  const auto found = falling.slide();
  ASSERT_TRUE(found);
  const double sine = beside / kBallRadius;
  const double cosine = std::sqrt(1.0 - sine * sine);
  EXPECT_NEAR(std::abs(found->contact.normal.x), sine, 0.02);
  EXPECT_NEAR(found->contact.normal.y, 0.0, 0.02);
  EXPECT_NEAR(std::abs(found->contact.normal.z), cosine, 0.02);
  const double gap = sine * beside + cosine * height - kBallRadius;
  EXPECT_NEAR(-found->contact.depth, gap, 0.02 * kBallRadius);
}

TEST(SlidingTouch, MeetsAnEdgeThatTheNearestPlacePasses) {
  const double beside = 0.4 * kBallRadius;
  const double height = 1.5 * kBallRadius;
  expect_plane_of_edge(Falling({beside, 0, height}, {0, 0, -kBallRadius / kStep}), beside, height);
}

TEST(SlidingTouch, LeavesTheEdgeToABallThatSpins) {
  const double beside = 0.4 * kBallRadius;
  const double height = 1.1 * kBallRadius;
  const Falling falling({beside, 0, height}, {0, 0, -kBallRadius / kStep}, {0, 20, 0});
  const auto found = falling.slide();
  ASSERT_TRUE(found);
  const Vec3 lever =
      cross(static_cast<Vec3>(found->contact.point), static_cast<Vec3>(found->contact.normal));
  EXPECT_LE(length(lever), 0.01 * kBallRadius);
}

TEST(SlidingTouch, PassesWhatTheBodyPasses) {
  const Falling falling({1.2 * kBallRadius, 0, 0.5 * kBallRadius}, {0, 0, -kBallRadius / kStep});
  EXPECT_FALSE(falling.slide());
}

TEST(SlidingTouch, IsForRoundBodies) {
  TestWorld world({}, {0, 0, 0});
  btRigidBody& cube = world.add_model(cube_model(), 1, {{}, {0, 0, 1}});
  btRigidBody& plane =
      world.add(world.make<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0);
  const TwoBodies bodies(cube, plane);
  const PairStep step = bodies.step(kStep);
  EXPECT_FALSE(find_sliding(step, step.motion, {0, -0.5f, {0, 0, -0.5f}, {0, 0, 1}}, 1.0));
}

}  // namespace
}  // namespace voxshell::bullet::sliding_touch_test
