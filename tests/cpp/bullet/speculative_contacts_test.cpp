#include "speculative_contacts.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "contact_list.h"
#include "support/models.h"
#include "support/two_bodies.h"

namespace voxshell::bullet::speculative_contacts_test {
namespace {

using namespace test_support;

constexpr double kStep = 1.0 / 100.0;

/// A ball at `place` that moves past a static body without gravity, and what of the ball's points
/// is within the step's margin of that body.
struct Thrown {
  Thrown(TestWorld& world, const btRigidBody& target, const Vec3& place, const Vec3& velocity)
      : ball(world.add_model(ball_model(), 1, {{}, place})), bodies(ball, target) {
    ball.setLinearVelocity(to_bullet(velocity));
    step = bodies.step(kStep);
    near = bodies.near(step.margin);
  }

  std::vector<Contact> speculative() const {
    std::vector<Contact> all;
    for (const Contact& contact : near) {
      if (const auto found = find_speculative(step, step.motion, {}, contact, 1.0))
        all.push_back(*found);
    }
    return all;
  }

  btRigidBody& ball;
  TwoBodies bodies;
  PairStep step{};
  std::vector<Contact> near;
};

btRigidBody& add_plane(TestWorld& world) {
  return world.add(world.make<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0);
}

TEST(SpeculativeContacts, HaveTheGapThatIsLeftNow) {
  TestWorld world({}, {0, 0, 0});
  const Thrown thrown(world, add_plane(world), {0, 0, kBallRadius + 0.03}, {2, 0, -10});
  const auto contacts = thrown.speculative();
  ASSERT_FALSE(contacts.empty());
  const Contact& first = find_deepest(contacts);
  EXPECT_NEAR(first.depth, -0.03, 1e-3);
  EXPECT_NEAR(first.normal.z, 1.0f, 1e-6);
}

TEST(SpeculativeContacts, TouchWithinTheStepOrNotAtAll) {
  TestWorld world({}, {0, 0, 0});
  const Thrown thrown(world, add_plane(world), {0, 0, kBallRadius + 0.11}, {0, 0, -10});
  EXPECT_FALSE(thrown.near.empty());
  EXPECT_TRUE(thrown.speculative().empty());
}

TEST(SpeculativeContacts, AreFoundBehindAThinModel) {
  static const auto sheet = build_model(voxshell::test_support::make_box({0.3, 0.3, 0.005}), 0.005);
  TestWorld world({}, {0, 0, 0});
  // A step of 0.5 m ends far behind the sheet.
  const Thrown thrown(world, world.add_model(sheet, 0), {0, 0, 0.2 + kBallRadius}, {0, 0, -50});
  const auto contacts = thrown.speculative();
  ASSERT_FALSE(contacts.empty());
  for (const Contact& contact : contacts) EXPECT_GT(contact.normal.z, 0.9f) << contact.id;
  EXPECT_NEAR(find_deepest(contacts).depth, -0.195, 2e-3);
}

TEST(SpeculativeContacts, AreNoneOfABodyThatPassesBeside) {
  TestWorld world({}, {0, 0, 0});
  const auto& cube = world.add_model(cube_model(), 0);
  const Thrown thrown(world, cube, {0.205, 0, 0.3}, {0, 0, -50});
  EXPECT_FALSE(thrown.near.empty());
  EXPECT_TRUE(thrown.speculative().empty());
}

// A swept contact over the point that the smaller body will reach had a lever that turned it.
TEST(SpeculativeContacts, OfALargerShellActWhereTheSmallerBodyIs) {
  TestWorld world({}, {0, 0, 0});
  btRigidBody& ground = world.add_model(ball_model(), 0);
  btRigidBody& box = world.add(world.make<btBoxShape>(to_bullet(Vec3{0.01, 0.01, 0.01})), 1,
                               {{}, {-0.05, 0, kBallRadius + 0.04}});
  box.setLinearVelocity(btVector3(5, 0, -5));
  const TwoBodies bodies(ground, box);
  const PairStep step = bodies.step(kStep);
  ASSERT_EQ(step.larger, &bodies.pair.shell_side());
  int count = 0;
  for (const Contact& contact : bodies.near(step.margin)) {
    const auto found = find_speculative(step, step.motion, {}, contact, 1.0);
    if (!found) continue;
    ++count;
    const Vec3 on_box = static_cast<Vec3>(found->point) +
                        static_cast<double>(found->depth) * static_cast<Vec3>(found->normal);
    EXPECT_LT(length(on_box - Vec3{-0.05, 0, kBallRadius + 0.04}), std::sqrt(3.0) * 0.0101);
  }
  EXPECT_GT(count, 0);
}

TEST(SpeculativeContacts, AreCarriedBackToTheStart) {
  TestWorld world({}, {0, 0, 0});
  const Thrown thrown(world, add_plane(world), {0, 0, kBallRadius + 0.03}, {2, 0, -10});
  // As if the lowest point had been found touching after three tenths of the step.
  std::vector<Contact> contacts{{7, 0.0f, {0, 0, -0.1f}, {0, 0, 1}}};
  move_to_start(thrown.step, 0.3, contacts);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_NEAR(contacts[0].depth, -0.03, 1e-6);
  EXPECT_NEAR(contacts[0].normal.z, 1.0, 1e-6);
}

}  // namespace
}  // namespace voxshell::bullet::speculative_contacts_test
