#include "swept_hits.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "contact_constants.h"
#include "contact_list.h"
#include "support/models.h"
#include "support/two_bodies.h"

namespace voxshell::bullet::swept_hits_test {
namespace {

using namespace test_support;

constexpr double kStep = 1.0 / 100.0;

/// The points of a ball that falls on a plane with 10 m/s, 0.1 m a step, without gravity.
struct Fall {
  explicit Fall(double gap)
      : ball(world.add_model(ball_model(), 1, {{}, {0, 0, kBallRadius + gap}})),
        bodies(ball,
               world.add(world.make<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0)) {
    ball.setLinearVelocity({0, 0, -10});
    step = bodies.step(kStep);
    QueryLists lists;
    hits.find(step, bodies.pair.shell(), bodies.pair.field(), /*is_of_field=*/false,
              kDefaultCcdLevel, lists, contacts);
  }

  TestWorld world{{}, {0, 0, 0}};
  btRigidBody& ball;
  TwoBodies bodies;
  PairStep step{};
  std::vector<Contact> contacts;
  SweptHits hits;
};

TEST(SweptHits, AreWhereTheyAreNow) {
  const Fall fall(0.03);
  ASSERT_FALSE(fall.contacts.empty());
  EXPECT_EQ(fall.hits.ids().size(), fall.contacts.size());
  EXPECT_NEAR(find_deepest(fall.contacts).depth, -0.03, 2e-3);
  for (const Contact& contact : fall.contacts) {
    // What is a step away at most.
    EXPECT_LT(contact.depth, 0.0f);
    EXPECT_GT(contact.depth, -0.1001f);
    EXPECT_NEAR(contact.normal.z, 1.0f, 1e-6f);
  }
}

TEST(SweptHits, AreNoneBeyondTheStep) { EXPECT_TRUE(Fall(0.11).contacts.empty()); }

TEST(SweptHits, AreAscendingAndOnce) {
  Fall fall(0.03);
  const std::vector<Contact> before = fall.contacts;
  QueryLists lists;
  fall.hits.find(fall.step, fall.bodies.pair.shell(), fall.bodies.pair.field(),
                 /*is_of_field=*/false, kDefaultCcdLevel, lists, fall.contacts);
  EXPECT_EQ(fall.contacts.size(), before.size());
  EXPECT_TRUE(std::ranges::is_sorted(fall.hits.ids()));
  EXPECT_TRUE(std::ranges::is_sorted(fall.contacts, {}, &Contact::id));
}

}  // namespace
}  // namespace voxshell::bullet::swept_hits_test
