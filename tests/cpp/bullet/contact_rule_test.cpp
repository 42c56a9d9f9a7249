#include "contact_rule.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "contact_constants.h"
#include "contact_list.h"
#include "impact.h"
#include "support/models.h"
#include "support/two_bodies.h"

namespace voxshell::bullet::contact_rule_test {
namespace {

using namespace test_support;

constexpr double kStep = 1.0 / 100.0;
constexpr double kMargin = 1e-3;  // of rest, meters
constexpr ContactSettings kWithoutCcd{
    .margin = kMargin, .ccd_motion_threshold = std::numeric_limits<double>::infinity()};

/// In which no contact is left out for others that imply it.
constexpr ContactSettings kSegmented{.mode = ContactMode::kSegmented};

using Ids = std::vector<std::uint32_t>;

Ids ids_of(const std::vector<Contact>& contacts) {
  Ids ids;
  for (const Contact& contact : contacts) ids.push_back(contact.id);
  return ids;
}

btRigidBody& add_plane(TestWorld& world) {
  return world.add(world.make<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0);
}

/// A model over a plane at z = 0 that moves at `velocity` without gravity, as either body of the
/// pair. Frames of the model and of the world have the same axes.
struct OverPlane {
  OverPlane(const std::shared_ptr<const Model>& model, double height, const Vec3& velocity,
            const ContactSettings& settings = {}, bool is_a = true)
      : body(world.add_model(model, 2, {{}, {0, 0, height}})),
        plane(add_plane(world)),
        bodies(is_a ? body : plane, is_a ? plane : body) {
    body.setLinearVelocity(to_bullet(velocity));
    describe(settings);
  }
  void describe(const ContactSettings& settings) { step = bodies.step(kStep, settings); }

  std::vector<Contact> left_of(std::vector<Contact> contacts, const Ids& exact = {}) {
    of_step = apply_contact_rule(step, {}, exact, {}, 0.0, contacts, memory);
    return contacts;
  }
  WorldContact in_world(const Contact& contact, double lever = 0.0) const {
    return to_world(step, of_step, contact, lever);
  }

  TestWorld world{{}, {0, 0, 0}};
  btRigidBody& body;
  btRigidBody& plane;
  TwoBodies bodies;
  PairStep step{};
  StepContacts of_step{};
  PairMemory memory;
};

/// Of a cube, below its corners or beside it.
Contact below(std::uint32_t id, double gap) {
  constexpr float kHalf = static_cast<float>(kCubeHalf);
  const std::array<Vec3f, 4> corners{{{-kHalf, -kHalf, -kHalf},
                                      {kHalf, -kHalf, -kHalf},
                                      {kHalf, kHalf, -kHalf},
                                      {-kHalf, kHalf, -kHalf}}};
  return {id, static_cast<float>(-gap), corners[id % 4], {0, 0, 1}};
}
Contact beside(std::uint32_t id, double gap) {
  return {id, static_cast<float>(-gap), {-static_cast<float>(kCubeHalf), 0, 0}, {1, 0, 0}};
}

TEST(ContactRule, LeavesWhatPenetratesAndWhatIsSlowWithinTheRestMargin) {
  const std::vector<Contact> found{below(1, -2e-4), below(2, 0.9 * kMargin),
                                   below(3, 1.1 * kMargin)};
  // Slow is what takes a step and more to cross the margin.
  const double slow = 0.9 * kMargin / kStep;
  for (const double speed : {0.0, slow, -5.0}) {
    OverPlane cube(cube_model(), kCubeHalf, {0, 0, -speed}, kWithoutCcd);
    EXPECT_EQ(ids_of(cube.left_of(found)), (Ids{1, 2})) << speed;
  }
}

TEST(ContactRule, WithoutCcdTakesTheFaceThatLandsWhole) {
  const std::vector<Contact> landing{below(1, -1e-4), below(2, 5e-4), beside(3, 5e-4),
                                     below(4, 1.1 * kMargin)};
  // Nothing touches yet: the nearest is the face, and what is beside it would stop it.
  const std::vector<Contact> arriving{beside(1, 9.5e-4), below(2, 4e-4), below(3, 9e-4)};
  const Vec3 aslant{-0.5, 0, -0.5};  // m/s, 5 mm a step
  OverPlane cube(cube_model(), kCubeHalf, aslant, kWithoutCcd);
  EXPECT_EQ(ids_of(cube.left_of(landing)), (Ids{1, 2}));
  EXPECT_EQ(ids_of(cube.left_of(arriving)), (Ids{2, 3}));
  // Forces hold it back, so that it does not reach what it would reach at its speed.
  OverPlane held(cube_model(), kCubeHalf, {0.5, 0, -0.15}, kWithoutCcd);
  held.body.applyCentralForce({0, 0, scalar(2.0 * 10.0)});
  held.describe(kWithoutCcd);
  EXPECT_EQ(ids_of(held.left_of({below(1, -1e-4), below(2, 4e-4), below(3, 6e-4)})), (Ids{1, 2}));
  // What rebounds is to touch first.
  cube.body.setRestitution(1);
  cube.plane.setRestitution(1);
  cube.describe(kWithoutCcd);
  EXPECT_EQ(ids_of(cube.left_of(landing)), (Ids{1}));
  EXPECT_TRUE(cube.left_of(arriving).empty());
}

TEST(ContactRule, WithCcdLeavesGapsThatAreClosedWithinTheStepAndThoseBehind) {
  constexpr double kSpeed = 10.0;  // m/s, 0.1 m a step
  for (const double gap : {0.05, 0.09}) {
    OverPlane ball(ball_model(), kBallRadius + gap, {3, 0, -kSpeed}, kSegmented);
    const std::vector<Contact> near = ball.bodies.near(ball.step.margin);
    const std::vector<Contact> left = ball.left_of(near);
    ASSERT_FALSE(left.empty());
    // Those that do not touch, too: the solver may make them faster.
    EXPECT_EQ(ids_of(left), ids_of(near));
    double farthest = 0.0;
    for (const Contact& contact : left) {
      const double height = kBallRadius + gap + static_cast<double>(contact.point.z);
      EXPECT_NEAR(contact.depth, -height, 1e-6);
      EXPECT_EQ(contact.normal, (Vec3f{0, 0, 1}));
      farthest = std::max(farthest, height);
    }
    EXPECT_NEAR(find_deepest(left).depth, -gap, 1e-3);
    EXPECT_GT(farthest, 1.5 * kSpeed * kStep);
  }
  // None is closed within the step, though some might be.
  OverPlane above(ball_model(), kBallRadius + 0.11, {3, 0, -kSpeed});
  EXPECT_FALSE(above.bodies.near(above.step.margin).empty());
  EXPECT_TRUE(above.left_of(above.bodies.near(above.step.margin)).empty());
  OverPlane leaving(ball_model(), kBallRadius + 0.01, {3, 0, kSpeed});
  EXPECT_TRUE(leaving.left_of(leaving.bodies.near(leaving.step.margin)).empty());
}

/// A ball that flies past the side of a cube has places that close on it and miss its edge.
TEST(ContactRule, LeavesOutWhatPassesTheOtherBody) {
  TestWorld world({}, {0, 0, 0});
  const btRigidBody& cube = world.add_model(cube_model(), 0);
  btRigidBody& ball = world.add_model(ball_model(), 1, {{}, {0.205, 0, 0.3}});
  ball.setLinearVelocity(btVector3(0, 0, -50));
  const TwoBodies bodies(ball, cube);
  ASSERT_TRUE(bodies.pair.shell_is_a);
  const PairStep step = bodies.step(kStep);
  std::vector<Contact> contacts = bodies.near(step.margin);
  // Something must touch, or nothing is left at all.
  contacts[0].depth = 0.001f;
  Ids passing;
  for (const Contact& contact : contacts) {
    const Impact impact = impact_of(step, contact);
    if (impact.gap > 0.0 && closing_of(step, impact) >= impact.gap) passing.push_back(contact.id);
  }
  ASSERT_GT(passing.size(), 10u);
  PairMemory memory;
  apply_contact_rule(step, {}, {}, {}, 0.0, contacts, memory);
  ASSERT_FALSE(contacts.empty());
  for (const Contact& contact : contacts) {
    EXPECT_FALSE(std::ranges::binary_search(passing, contact.id)) << contact.id;
  }
}

/// Two cubes that fall together, one above the other: the lower one may land.
TEST(ContactRule, LeavesWhatTouchesIfTheOtherBodyIsStopped) {
  constexpr double kGap = 0.004;
  constexpr double kSpeed = 2.0;  // m/s, 20 mm a step
  TestWorld world({}, {0, 0, 0});
  btRigidBody& lower = world.add_model(cube_model(), 1);
  btRigidBody& upper = world.add_model(cube_model(), 1, {{}, {0, 0, 2 * kCubeHalf + kGap}});
  const TwoBodies bodies(upper, lower);
  ASSERT_TRUE(bodies.pair.shell_is_a);
  for (const double speed : {kSpeed, 0.0}) {
    for (btRigidBody* body : {&lower, &upper}) {
      body->setLinearVelocity(to_bullet(Vec3{0, 0, -speed}));
    }
    const PairStep step = bodies.step(kStep, {.margin = kMargin});
    std::vector<Contact> contacts{below(1, kGap), below(2, 0.021)};
    EXPECT_EQ(may_reach(step, contacts[0], 0.0), speed > 0.0);
    EXPECT_FALSE(may_reach(step, contacts[1], 0.0));
    EXPECT_TRUE(may_reach(step, below(3, 0.5 * kMargin), 0.0));
    EXPECT_EQ(may_reach(step, contacts[1], 0.002), speed > 0.0);
    PairMemory memory;
    apply_contact_rule(step, {}, {}, {}, 0.0, contacts, memory);
    EXPECT_EQ(ids_of(contacts), speed > 0.0 ? Ids{1} : Ids{});
  }
}

TEST(ContactRule, GivesTheSlipOfTheFirstBodyOnTheSecondAndTheLever) {
  constexpr double kSlip = 1e-5;  // less than a 30th of the margin
  constexpr double kLever = 0.02;
  for (const bool is_a : {true, false}) {
    OverPlane cube(cube_model(), kCubeHalf, {}, kWithoutCcd, is_a);
    ASSERT_EQ(cube.left_of({below(1, 0.0)}).size(), 1u);
    EXPECT_EQ(length(cube.in_world(below(1, 0.0)).slip), 0.0);
    const auto slip_after = [&](double way, const Vec3& velocity) {
      cube.body.setWorldTransform(to_bullet(Pose{{}, {way, 0, kCubeHalf}}));
      cube.body.setLinearVelocity(to_bullet(velocity));
      const TwoBodies moved(is_a ? cube.body : cube.plane, is_a ? cube.plane : cube.body);
      const PairStep step = moved.step(kStep, kWithoutCcd);
      std::vector<Contact> contacts{below(1, 0.0)};
      const StepContacts of_step = apply_contact_rule(step, {}, {}, {}, 0.0, contacts, cube.memory);
      return to_world(step, of_step, contacts[0], kLever);
    };
    const WorldContact held = slip_after(kSlip, {});
    EXPECT_TRUE(held.is_resting);
    EXPECT_TRUE(held.keeps_impulse);
    EXPECT_LT(length(held.slip - Vec3{is_a ? kSlip : -kSlip, 0, 0}), 1e-8);
    EXPECT_EQ(held.rolling_friction, kLever);
    const WorldContact sliding = slip_after(kSlip, {1, 0, 0});
    EXPECT_FALSE(sliding.is_resting);
    EXPECT_FALSE(sliding.keeps_impulse);
    EXPECT_EQ(length(sliding.slip), 0.0);
    EXPECT_EQ(sliding.rolling_friction, 0.0);
  }
}

TEST(ContactRule, LevelsThePointsThatAStillBodyLiesOn) {
  const std::vector<Contact> tipped{below(1, -1e-5), below(2, 0.3 * kMargin),
                                    below(3, 0.6 * kMargin)};
  OverPlane still(cube_model(), kCubeHalf, {}, kWithoutCcd);
  const std::vector<Contact> level = still.left_of(tipped);
  ASSERT_EQ(level.size(), 3u);
  EXPECT_EQ(level[1].depth, 0.0f);
  EXPECT_EQ(level[2].depth, tipped[2].depth);  // too high to carry
  OverPlane moving(cube_model(), kCubeHalf, {0.05, 0, 0}, kWithoutCcd);
  EXPECT_EQ(moving.left_of(tipped), tipped);
}

/// A ball without spin that flies aslant touches with its lowest place, and the plane where the
/// ball will be by then.
TEST(ContactRule, PutsAContactThatSlidesOnThePlacesThatTouch) {
  constexpr double kGap = 0.03;
  for (const bool is_a : {true, false}) {
    OverPlane ball(ball_model(), kBallRadius + kGap, {5, 0, -10}, {}, is_a);
    const Contact lowest = find_deepest(ball.bodies.near(ball.step.margin));
    const std::vector<Contact> left = ball.left_of({lowest}, {lowest.id});
    ASSERT_EQ(left.size(), 1u);
    const WorldContact world = ball.in_world(left[0]);
    EXPECT_LT(length((is_a ? world.point_a : world.point_b) - Vec3{0, 0, kGap}), 1e-3);
    EXPECT_LT(length((is_a ? world.point_b : world.point_a) - Vec3{0.5 * kGap, 0, 0}), 1e-3);
    EXPECT_NEAR(world.depth, -kGap, 1e-3);
  }
}

TEST(ContactRule, SharesTheImpulseThatTurnsABodyRound) {
  constexpr double kSpeed = 2.0;
  OverPlane cube(cube_model(), kCubeHalf, {0, 0, -kSpeed}, kWithoutCcd);
  cube.body.setRestitution(1);
  cube.plane.setRestitution(scalar(0.6));
  cube.describe(kWithoutCcd);
  const std::vector<Contact> left = cube.left_of({below(1, -1e-4), below(2, -1e-4)});
  ASSERT_EQ(left.size(), 2u);
  for (const Contact& contact : left) {
    const WorldContact world = cube.in_world(contact);
    EXPECT_NEAR(world.restitution, 0.6, 1e-6);
    // Of 2 kg; the solver starts from a fraction of it.
    EXPECT_NEAR(kWarmStartingFactor * world.first_impulse, 0.5 * 2.0 * 1.6 * kSpeed, 1e-5);
  }
}

/// It comes to the surface late in the step, with so little energy that it would not rise again to
/// where it started from. The rule passes all of it on to the next step, as the square of a speed.
TEST(ContactRule, OwesTheEnergyOfAReboundThatEndsAtTheSurface) {
  constexpr double kSpeed = 2.0;
  constexpr double kRestitution = 0.1;
  OverPlane cube(cube_model(), kCubeHalf + 0.019, {0, 0, -kSpeed}, {.margin = kMargin});
  cube.body.setRestitution(1);
  cube.plane.setRestitution(scalar(kRestitution));
  cube.body.setGravity(btVector3(0, 0, scalar(-9.81)));
  cube.body.applyGravity();
  cube.describe({.margin = kMargin});
  const std::vector<Contact> left = cube.left_of({below(1, 0.019)});
  ASSERT_EQ(left.size(), 1u);
  const double of_fall = kSpeed * kSpeed + 2 * 9.81 * 0.019 + 9.81 * kStep * kSpeed;
  EXPECT_NEAR(cube.memory.owed_energy, kRestitution * kRestitution * of_fall, 1e-5);
  // The solver aims at restitution * approach - gap / step: nothing is left of the gap.
  const WorldContact stopped = cube.in_world(left[0]);
  EXPECT_NEAR(stopped.restitution, 0.0, 1e-5);
  EXPECT_TRUE(cube.left_of({}).empty());
  EXPECT_EQ(cube.memory.owed_energy, 0.0);
}

}  // namespace
}  // namespace voxshell::bullet::contact_rule_test
