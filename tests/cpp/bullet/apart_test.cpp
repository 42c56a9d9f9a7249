#include "apart.h"

#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "contact_rule.h"
#include "contact_search.h"
#include "support/models.h"
#include "support/random.h"
#include "support/two_bodies.h"
#include "support/world.h"

namespace voxshell::bullet::apart_test {
namespace {

using namespace test_support;
using voxshell::test_support::Random;

constexpr double kStep = 1.0 / 60.0;

btVector3 random_velocity(Random& random, double most) {
  return to_bullet(random.uniform(0.0, most) * random.direction());
}

/// Whether anything touches, or would within the step.
bool touches(TwoBodies& bodies, const ContactSettings& settings) {
  const PairStep step = bodies.step(kStep, settings);
  ContactSearch search;
  search.find_near(settings, bodies.pair, step.margin, &step,
                   step.uses_ccd ? Wanted::kOneASegment : Wanted::kAll);
  PairMemory memory;
  std::vector<Contact>& contacts = search.contacts();
  apply_contact_rule(step, search.features(), search.exact(), search.hits(), 0.0, contacts, memory);
  return !contacts.empty();
}

TEST(Apart, IsNoPairThatTouchesWithinTheStep) {
  Random random(11);
  const std::vector<std::shared_ptr<const Model>> models{cube_model(), blob_model(), torus_model(),
                                                         slab_model()};
  int apart = 0;
  int touching = 0;
  for (int i = 0; i < 4000; ++i) {
    TestWorld world;
    const auto add = [&](double distance) -> btRigidBody& {
      Pose pose = random.pose(0.0);
      pose.translation = distance * random.direction();
      btRigidBody& body = world.add_model(models[static_cast<std::size_t>(i) / 2 % 4], 1, pose);
      body.setLinearVelocity(random_velocity(random, 10.0));
      body.setAngularVelocity(random_velocity(random, 20.0));
      return body;
    };
    const btRigidBody& a = add(0.0);
    btRigidBody* b = nullptr;
    if (i % 3 == 0) {
      Pose pose = random.pose(0.0);
      pose.translation = random.uniform(0.0, 0.8) * random.direction();
      b = &world.add(world.make<btBoxShape>(btVector3(scalar(0.1), scalar(0.02), scalar(0.2))), 1,
                     pose);
      b->setLinearVelocity(random_velocity(random, 10.0));
    } else {
      b = &add(random.uniform(0.0, 0.8));
    }
    TwoBodies bodies(a, *b);
    const ContactSettings settings;
    const bool touch = touches(bodies, settings);
    const bool is_apart = are_apart(bodies.wrap_a, bodies.wrap_b, settings, kStep);
    EXPECT_FALSE(is_apart && touch) << "pair " << i;
    apart += is_apart ? 1 : 0;
    touching += touch ? 1 : 0;
  }
  EXPECT_GT(apart, 800);
  EXPECT_GT(touching, 800);
}

TEST(Apart, AreSlabsSideBySideThatAreTurnedInTheWorld) {
  TestWorld world;
  const double turn = std::sqrt(0.5);
  const Pose aslant{{{turn, 0, turn}, {0, 1, 0}, {-turn, 0, turn}}, {}};
  Pose beside = aslant;
  beside.translation = aslant.rotate({0, 0, 0.15});  // slabs are 0.1 thick
  const btRigidBody& a = world.add_model(slab_model(), 1, aslant);
  btRigidBody& b = world.add_model(slab_model(), 1, beside);
  const TwoBodies bodies(a, b);
  EXPECT_TRUE(are_apart(bodies.wrap_a, bodies.wrap_b, {}, kStep));
  b.setLinearVelocity(to_bullet(aslant.rotate({0, 0, -4})));  // 67 mm a step
  EXPECT_FALSE(are_apart(bodies.wrap_a, bodies.wrap_b, {}, kStep));
}

}  // namespace
}  // namespace voxshell::bullet::apart_test
