#include "turning_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "contact_list.h"
#include "support/models.h"
#include "support/two_bodies.h"
#include "support/world.h"

namespace voxshell::bullet::turning_contacts_test {
namespace {

using namespace test_support;
using voxshell::test_support::make_icosphere;
using voxshell::test_support::make_prism;

constexpr double kStep = 1.0 / 60.0;
constexpr double kBall = 0.05;
constexpr double kTrough = 0.1;

/// A third of a round trough about the z axis, open toward y, with its lowest line at y =
/// -kTrough.
///
/// @param wall  Its thickness, meters; 0 for a block with a flat bottom.
std::shared_ptr<const Model> build_trough(double wall) {
  constexpr std::uint32_t kFacets = 60;
  std::vector<std::array<double, 2>> polygon;
  std::vector<Triangle> caps;
  const auto at = [&](std::uint32_t i, double radius) {
    const double angle = std::numbers::pi * (7.0 / 6.0 + 2.0 / 3.0 * i / kFacets);
    return std::array{radius * std::cos(angle), radius * std::sin(angle)};
  };
  for (std::uint32_t i = 0; i <= kFacets; ++i) {
    if (wall > 0.0) {
      polygon.push_back(at(i, kTrough + wall));
    } else {
      polygon.push_back({at(i, kTrough)[0], -1.3 * kTrough});
    }
  }
  for (std::uint32_t i = 0; i <= kFacets; ++i) polygon.push_back(at(kFacets - i, kTrough));
  for (std::uint32_t i = 0; i < kFacets; ++i) {
    const std::uint32_t above = 2 * kFacets + 1 - i;
    caps.push_back({i, i + 1, above - 1});
    caps.push_back({i, above - 1, above});
  }
  return build_by_tolerance(make_prism(polygon, caps, -0.1, 0.1));
}

std::shared_ptr<const Model> trough_model() {
  static const auto model = build_trough(0.0);
  return model;
}

std::shared_ptr<const Model> small_ball() {
  static const auto model = build_by_tolerance(make_icosphere(kBall, 4));
  return model;
}

/// A ball on something else, and the contact that is nearest now.
struct Rolling {
  Rolling(const std::shared_ptr<const Model>& ground, const Pose& pose, const Vec3& velocity,
          const Vec3& spin = {}, bool ball_first = true, const Vec3& normal = {0, 1, 0})
      : ball(world.add_model(small_ball(), 1, pose)),
        low(world.add_model(ground, 0)),
        bodies(ball_first ? ball : low, ball_first ? low : ball) {
    ball.setLinearVelocity(to_bullet(velocity));
    ball.setAngularVelocity(to_bullet(spin));
    step = bodies.step(kStep, {.solver_turns_contacts = true});
    nearest = find_deepest(bodies.near(0.01));
    // As if it had slid.
    nearest.normal = static_cast<Vec3f>(bodies.pair.shell_is_a == ball_first ? normal : -normal);
    turning.find(step, std::span(&nearest, 1), std::span(&nearest.id, 1));
  }
  /// By how much it counts on coming nearer, meters.
  double turn() const { return kStep * turning.speed_of(nearest.id); }

  TestWorld world{{}, {0, 0, 0}};
  btRigidBody& ball;
  btRigidBody& low;
  TwoBodies bodies;
  PairStep step{};
  Contact nearest{};
  TurningContacts turning;
};

const Pose kLowest{{}, {0, -(kTrough - kBall), 0}};

TEST(TurningContacts, AreAsFastAsATroughTurns) {
  for (const double speed : {0.1, 0.3, 1.0}) {
    for (const double rolls : {0.0, 1.0}) {
      for (const bool ball_first : {true, false}) {
        const Vec3 spin{0, 0, -rolls * speed / kBall};
        const Rolling rolling(trough_model(), kLowest, {speed, 0, 0}, spin, ball_first);
        const double turn = std::hypot(kTrough - kBall, kStep * speed) - (kTrough - kBall);
        EXPECT_NEAR(rolling.turn(), turn, 0.03 * turn + 1e-8)
            << speed << " m/s, rolls " << rolls << ", ball first " << ball_first;
        EXPECT_FALSE(rolling.turning.motions().empty());
      }
    }
  }
}

// Straight ahead, the ball would end the step beyond the middle of the wall, or on its other side.
TEST(TurningContacts, LeadAlongAThinTrough) {
  static const auto trough = build_trough(0.008);
  constexpr double kWay = kTrough - kBall;
  for (const double speed : {0.8, 1.1, 1.3, 1.5}) {
    // Along the normal of the start, to where the step ends on the trough.
    const double turn = kWay - std::sqrt(kWay * kWay - speed * speed * kStep * kStep);
    EXPECT_NEAR(Rolling(trough, kLowest, {speed, 0, 0}).turn(), turn, 0.05 * turn)
        << speed << " m/s";
  }
}

TEST(TurningContacts, AreFoundOnABallThatSpinsFast) {
  const double turn = std::hypot(kTrough - kBall, kStep) - (kTrough - kBall);
  for (const double spin : {0.0, 30.0, 60.0, 120.0}) {
    const Rolling rolling(trough_model(), kLowest, {1, 0, 0}, {0, 0.6 * spin, 0.8 * spin});
    EXPECT_NEAR(rolling.turn(), turn, 0.03 * turn) << spin << " rad/s";
  }
}

TEST(TurningContacts, GoOnWithoutForcesAndWithThem) {
  TestWorld world{{}, {3, -10, 0}};
  btRigidBody& ball = world.add_model(small_ball(), 1, kLowest);
  btRigidBody& low = world.add_model(trough_model(), 0);
  ball.setLinearVelocity({1, 0, 0});
  // As worlds do before they look for contacts.
  ball.applyGravity();
  TwoBodies bodies(ball, low);
  const PairStep step = bodies.step(kStep, {.solver_turns_contacts = true});
  Contact nearest = find_deepest(bodies.near(0.01));
  const double side = bodies.pair.shell_is_a ? 1.0 : -1.0;
  nearest.normal = static_cast<Vec3f>(Vec3{0, side, 0});
  TurningContacts turning;
  turning.find(step, std::span(&nearest, 1), std::span(&nearest.id, 1));
  const auto motions = turning.motions();
  ASSERT_EQ(motions.size(), 2U);
  EXPECT_NEAR(side * motions[0].velocity.x, 1.0, 1e-9);
  EXPECT_NEAR(side * motions[1].velocity.x, 1.0 + 3.0 * kStep, 1e-9);
  for (const RelativeMotion& motion : motions) {
    EXPECT_NEAR(side * motion.velocity.y, turning.speed_of(nearest.id), 1e-9);
  }
}

TEST(TurningContacts, DoNotTurnAlongTheAxis) {
  EXPECT_EQ(Rolling(trough_model(), kLowest, {0, 0, 1}).turn(), 0.0);
}

TEST(TurningContacts, DoNotTurnOnAPlane) {
  const Rolling rolling(slab_model(), {{}, {0, 0, kBall}}, {1, 0, 0}, {0, 1 / kBall, 0}, true,
                        {0, 0, 1});
  EXPECT_EQ(rolling.turn(), 0.0);
  EXPECT_TRUE(rolling.turning.motions().empty());
}

TEST(TurningContacts, LeaveAWallAheadToOtherContacts) {
  // A floor of which the far half is a wall.
  static const auto step = build_by_tolerance(
      make_prism({{-0.2, -0.1}, {0.2, -0.1}, {0.2, 0.2}, {0, 0.2}, {0, 0}, {-0.2, 0}},
                 {{0, 1, 4}, {0, 4, 5}, {1, 2, 4}, {2, 3, 4}}, -0.1, 0.1));
  const double gap = 0.003;
  const Rolling rolling(step, {{}, {-kBall - gap, kBall, 0}}, {1, 0, 0});
  EXPECT_EQ(rolling.turn(), 0.0);
}

TEST(TurningContacts, DoNotTurnForOtherSolvers) {
  Rolling rolling(trough_model(), kLowest, {1, 0, 0});
  rolling.step.solver_turns_contacts = false;
  rolling.turning.find(rolling.step, std::span(&rolling.nearest, 1),
                       std::span(&rolling.nearest.id, 1));
  EXPECT_EQ(rolling.turn(), 0.0);
}

TEST(TurningContacts, LeaveBlowsOfElasticBodiesToRebound) {
  Rolling rolling(trough_model(), kLowest, {1, -1, 0});
  rolling.step.restitution = 0.5;
  const auto find = [&] {
    rolling.turning.find(rolling.step, std::span(&rolling.nearest, 1),
                         std::span(&rolling.nearest.id, 1));
    return rolling.turn();
  };
  EXPECT_EQ(find(), 0.0);
  rolling.ball.setLinearVelocity(btVector3(1, 0, 0));
  rolling.step = rolling.bodies.step(kStep, {.solver_turns_contacts = true});
  rolling.step.restitution = 0.5;
  EXPECT_GT(find(), 0.0);
}

}  // namespace
}  // namespace voxshell::bullet::turning_contacts_test
