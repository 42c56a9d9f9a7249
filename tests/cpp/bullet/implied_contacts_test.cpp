#include "implied_contacts.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "contact_constants.h"
#include "impact.h"
#include "support/models.h"
#include "support/random.h"
#include "support/two_bodies.h"
#include "support/world.h"
#include "turning_contacts.h"

namespace voxshell::bullet::implied_contacts_test {
namespace {

using namespace test_support;
using voxshell::test_support::Random;

constexpr double kStep = 1.0 / 100.0;
constexpr double kSpeed = 2.0;  // m/s, 20 mm a step

/// A ball that flies toward another one.
struct Flying {
  explicit Flying(const ContactSettings& settings = {}) {
    ball.setLinearVelocity(btVector3(0, 0, scalar(-kSpeed)));
    step = TwoBodies(ball, other).step(kStep, settings);
  }
  std::vector<Contact> left_of(std::vector<Contact> contacts) const {
    std::vector<Contact> places = contacts;
    drop_implied(step, TurningContacts(), contacts, places);
    EXPECT_EQ(places.size(), contacts.size());
    return contacts;
  }

  TestWorld world{{}, {0, 0, 0}};
  btRigidBody& ball{world.add_model(ball_model(), 1, {{}, {0, 0, 0.3}})};
  btRigidBody& other{world.add_model(ball_model(), 0)};
  PairStep step{};
};

Contact ahead(std::uint32_t id, double gap, const Vec3& point, const Vec3& normal) {
  return {id, static_cast<float>(-gap), static_cast<Vec3f>(point), static_cast<Vec3f>(normal)};
}

std::vector<std::uint32_t> ids_of(const std::vector<Contact>& contacts) {
  std::vector<std::uint32_t> ids;
  for (const Contact& contact : contacts) ids.push_back(contact.id);
  return ids;
}

const std::vector<Contact> kAhead{
    ahead(1, 0.001, {0, 0, 0}, {0, 0, 1}), ahead(2, 0.030, {0.01, 0, 0}, {0, 0, 1}),
    ahead(3, 0.030, {0, 0, 0}, {0, 1, 0}), ahead(4, 0.030, {0, 0.09, 0}, {0, 0, 1}),
    ahead(5, 0.019, {0.01, 0, 0}, {0, 0, 1})};

TEST(ImpliedContacts, AreThoseThatNearerOnesKeepTheBodiesFrom) {
  // Of 2: 20 mm less than the ball reaches at twice its speed. 3 looks elsewhere, 4 is where a turn
  // may lead, and 5 touches within the step.
  EXPECT_EQ(ids_of(Flying().left_of(kAhead)), (std::vector<std::uint32_t>{1, 3, 4, 5}));
}

TEST(ImpliedContacts, StayInSegmentsAndWhereNothingNeedsCcd) {
  EXPECT_EQ(Flying({.mode = ContactMode::kSegmented}).left_of(kAhead).size(), kAhead.size());
  Flying flying;
  flying.step.uses_ccd = false;
  EXPECT_EQ(flying.left_of(kAhead).size(), kAhead.size());
}

/// However the ball moves and turns, as far as it may: if it passes none of those that are left, it
/// passes none of the others.
TEST(ImpliedContacts, HoldWhereTheOthersDo) {
  Random random(3);
  int dropped = 0;
  int held = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Flying flying;
    const PairStep& step = flying.step;
    const double farthest = kCcdReach * step.farthest_displacement;
    std::vector<Contact> contacts;
    for (std::uint32_t id = 0; id < 30; ++id) {
      const Vec3 lean = Vec3{0, 0, 1} + 0.4 * random.direction();
      const Vec3 normal = lean / length(lean);
      contacts.push_back(
          ahead(id, random.uniform(0.0, 2.0 * farthest), kBallRadius * random.direction(), normal));
    }
    const std::vector<Contact> left = flying.left_of(contacts);
    dropped += static_cast<int>(contacts.size() - left.size());
    for (int i = 0; i < 50; ++i) {
      const Vec3 shift = random.uniform(0.0, farthest) * random.direction();
      const Vec3 turn = random.uniform(0.0, farthest / step.ball.radius) * random.direction();
      const auto is_passed = [&](const Contact& contact) {
        const Vec3 moved = shift + cross(turn, static_cast<Vec3>(contact.point));
        // What a place may move by bounds the rule.
        return length(moved) <= farthest && -dot(moved, static_cast<Vec3>(contact.normal)) >
                                                -static_cast<double>(contact.depth) + 1e-6;
      };
      const auto is_far = [&](const Contact& contact) {
        return length(shift + cross(turn, static_cast<Vec3>(contact.point))) > farthest;
      };
      if (std::ranges::any_of(left, is_passed) || std::ranges::any_of(contacts, is_far)) continue;
      ++held;
      EXPECT_FALSE(std::ranges::any_of(contacts, is_passed));
    }
  }
  EXPECT_GT(dropped, 1000);
  EXPECT_GT(held, 500);
}

}  // namespace
}  // namespace voxshell::bullet::implied_contacts_test
