#include "contact_search.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "contact_constants.h"
#include "contact_rule.h"
#include "impact.h"
#include "round_contacts.h"
#include "support/models.h"
#include "support/random.h"
#include "support/two_bodies.h"
#include "support/world.h"

namespace voxshell::bullet::contact_search_test {
namespace {

using namespace test_support;
using voxshell::test_support::Random;

constexpr double kStep = 1.0 / 200.0;

/// A body that falls on another one, in any orientations.
struct Fall {
  Fall(Random& random, double speed, double distance)
      : low(world.add_model(torus_model(), 0, random.pose(0.0))), high(add_high(random, distance)) {
    high.setLinearVelocity(btVector3(0, 0, scalar(-speed)));
  }

  btRigidBody& add_high(Random& random, double distance) {
    Pose pose = random.pose(0.0);
    pose.translation = {0, 0, distance};
    return world.add_model(blob_model(), 1, pose);
  }

  TestWorld world;
  btRigidBody& low;
  btRigidBody& high;
};

TEST(ContactSearch, FindsSomethingWhereverAnyPointWouldTouchWithinTheStep) {
  Random random(5);
  int touching = 0;
  int skipped = 0;
  for (int i = 0; i < 1500; ++i) {
    Fall fall(random, random.uniform(1.0, 10.0), random.uniform(0.05, 0.35));
    TwoBodies bodies(fall.low, fall.high);
    const PairStep step = bodies.step(kStep);
    ASSERT_TRUE(step.uses_ccd);
    const std::vector<Contact> all = bodies.near(step.margin);
    const bool touches = std::ranges::any_of(all, [&](const Contact& contact) {
      const Impact impact = impact_of(step, contact);
      return is_contact(step, impact) || closing_of(step, impact) >= impact.gap;
    });
    ContactSearch search;
    search.find_near({}, bodies.pair, step.margin, &step, Wanted::kOneASegment);
    EXPECT_FALSE(touches && search.contacts().empty()) << "fall " << i;
    touching += touches ? 1 : 0;
    skipped += !all.empty() && search.contacts().empty() ? 1 : 0;
  }
  EXPECT_GT(touching, 200);
  EXPECT_GT(skipped, 100);
}

TEST(ContactSearch, KeepsGuardsAsTheyWereSampled) {
  Random random(6);
  int guards = 0;
  int slid = 0;
  for (int i = 0; i < 400; ++i) {
    Fall fall(random, 5.0, random.uniform(0.1, 0.2));
    TwoBodies bodies(fall.low, fall.high);
    const PairStep step = bodies.step(kStep);
    ContactSearch search;
    search.find_near({}, bodies.pair, step.margin, &step, Wanted::kOneASegment);
    EXPECT_TRUE(std::ranges::is_sorted(search.contacts(), {}, &Contact::id));
    const PointShell& shell = bodies.pair.shell();
    for (const Contact& contact : search.contacts()) {
      if (contact.id >= shell.size()) continue;  // an edge, or of the second shell
      if (std::ranges::binary_search(search.exact(), contact.id)) {
        ++slid;
      } else if (!may_reach(step, contact, 0.0)) {
        ++guards;
        EXPECT_EQ(contact.point, shell.points()[contact.id]) << "fall " << i;
      }
    }
  }
  EXPECT_GT(guards, 1000);
  EXPECT_GT(slid, 100);
}

TEST(ContactSearch, GuardsBodiesThatFallTogetherOnceASegment) {
  Random random(7);
  std::size_t guards = 0;
  std::size_t within_reach = 0;
  for (int i = 0; i < 100; ++i) {
    Fall fall(random, 3.0, random.uniform(0.1, 0.2));
    fall.low.setMassProps(1, btVector3(1, 1, 1));
    fall.low.setLinearVelocity(fall.high.getLinearVelocity());
    TwoBodies bodies(fall.low, fall.high);
    const PairStep step = bodies.step(kStep);
    ASSERT_FALSE(step.uses_ccd);
    ASSERT_GT(step.margin, 10.0 * step.rest_margin);
    ContactSearch search;
    search.find_near({}, bodies.pair, step.margin, &step, Wanted::kAll);
    const PointShell& shell = bodies.pair.shell();
    // Of what may touch now, all samples are found.
    const double near = step.rest_margin + most_above_samples(*bodies.pair.shell_side().model());
    std::set<std::uint32_t> segments;
    for (const Contact& contact : search.contacts()) {
      const bool is_near = static_cast<double>(contact.depth) >= -near;
      if (contact.id >= shell.size() || is_near) continue;
      EXPECT_TRUE(segments.insert(shell.segment_of(contact.id, kDefaultCcdLevel)).second);
      ++guards;
    }
    within_reach += bodies.near(step.margin).size();
  }
  EXPECT_GT(guards, 200u);
  EXPECT_GT(within_reach, 4 * guards);
}

}  // namespace
}  // namespace voxshell::bullet::contact_search_test
