#include "kept_contacts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "contact_constants.h"
#include "contact_list.h"
#include "contact_search.h"
#include "support/models.h"
#include "support/two_bodies.h"
#include "support/world.h"

namespace voxshell::bullet::kept_contacts_test {
namespace {

using namespace test_support;

constexpr double kHalf = 0.05;

/// A cube that lies on a slab, whose top is at z = 0.
struct CubeOnSlab {
  CubeOnSlab()
      : slab(world.add_model(build_by_tolerance({0.2, 0.2, 0.02}), 0, {{}, {0, 0, -0.02}})),
        cube(world.add_model(build_by_tolerance({kHalf, kHalf, kHalf}), 1, {{}, {0, 0, kHalf}})) {
    cube.applyGravity();  // without weight, no body lies still
  }

  void move(const Vec3& by, const btVector3& turn = {0, 0, 0}) {
    btTransform pose = cube.getWorldTransform();
    pose.setOrigin(pose.getOrigin() + to_bullet(by));
    if (turn.length() > 0) pose.setRotation(btQuaternion(turn.normalized(), turn.length()));
    cube.setWorldTransform(pose);
  }
  const PairStep& step() {
    current.emplace(bodies.emplace(cube, slab).step());
    return *current;
  }
  const std::vector<Contact>& search() {
    step();
    found.find_near({}, bodies->pair, current->margin, &*current, Wanted::kAll);
    return found.contacts();
  }

  TestWorld world;
  btRigidBody& slab;
  btRigidBody& cube;
  std::optional<TwoBodies> bodies;
  std::optional<PairStep> current;
  ContactSearch found;
};

double most_kept(const PairStep& step) { return kKeptOfMargin * step.rest_margin; }

TEST(KeptContacts, HoldUntilTheBodiesHaveMoved) {
  CubeOnSlab scene;
  KeptContacts kept;
  EXPECT_FALSE(kept.hold_in(scene.step(), true));
  kept.keep(scene.step(), scene.search());
  EXPECT_TRUE(kept.hold_in(scene.step(), true));
  const double most = most_kept(scene.step());
  scene.move({0, 0, 0.9 * most});
  EXPECT_TRUE(kept.hold_in(scene.step(), true));
  scene.move({0, 0, 0.2 * most});  // since they were kept, not since the last step
  EXPECT_FALSE(kept.hold_in(scene.step(), true));
  scene.move({0, 0, -1.1 * most});
  EXPECT_TRUE(kept.hold_in(scene.step(), true));
  const double radius = scene.step().ball.radius;
  scene.move({}, btVector3(0, btScalar(2.0 * most / radius), 0));
  EXPECT_FALSE(kept.hold_in(scene.step(), true));
}

TEST(KeptContacts, HoldUntilTheBodiesMoveOtherwise) {
  CubeOnSlab scene;
  KeptContacts kept;
  kept.keep(scene.step(), scene.search());
  const PairStep& step = scene.step();
  const double slow = 0.5 * most_kept(step) / step.time_step;
  scene.cube.setLinearVelocity(to_bullet(Vec3{slow, 0, 0}));
  EXPECT_TRUE(kept.hold_in(scene.step(), true));
  scene.cube.setLinearVelocity(to_bullet(Vec3{3.0 * slow, 0, 0}));
  EXPECT_FALSE(kept.hold_in(scene.step(), true));
  scene.cube.setLinearVelocity({0, 0, 0});
  EXPECT_TRUE(kept.hold_in(scene.step(), true));
  scene.cube.applyCentralForce({0, 0, 50});
  EXPECT_FALSE(kept.hold_in(scene.step(), true));
  scene.cube.clearForces();
  scene.cube.applyGravity();
  EXPECT_TRUE(kept.hold_in(scene.step(), true));
}

TEST(KeptContacts, OfOtherBodiesOrOtherStepsDoNotHold) {
  CubeOnSlab scene;
  KeptContacts kept;
  kept.keep(scene.step(), scene.search());
  EXPECT_FALSE(kept.hold_in(TwoBodies(scene.slab, scene.cube).step(), true));
  EXPECT_FALSE(kept.hold_in(TwoBodies(scene.cube, scene.slab).step(1.0 / 100.0), true));
  EXPECT_FALSE(
      kept.hold_in(TwoBodies(scene.cube, scene.slab).step(1.0 / 200.0, {.margin = 1e-3}), true));
  CubeOnSlab other;
  EXPECT_FALSE(kept.hold_in(other.step(), true));
}

TEST(KeptContacts, OnBulletsShapesHoldUntilThoseChange) {
  TestWorld world;
  btRigidBody& cube =
      world.add_model(build_by_tolerance({kHalf, kHalf, kHalf}), 1, {{}, {0, 0, kHalf}});
  cube.applyGravity();
  auto& box = world.make<btBoxShape>(btVector3(0.2f, 0.2f, 0.02f));
  auto& larger = world.make<btBoxShape>(btVector3(0.2f, 0.3f, 0.02f));
  auto& plane = world.make<btStaticPlaneShape>(btVector3(0, 0, 1), 0);
  auto& higher = world.make<btStaticPlaneShape>(btVector3(0, 0, 1), 1e-5f);
  btRigidBody& on_box = world.add(box, 0, {{}, {0, 0, -0.02}});
  btRigidBody& on_larger = world.add(larger, 0, {{}, {0, 0, -0.02}});
  btRigidBody& on_plane = world.add(plane, 0);
  btRigidBody& on_higher = world.add(higher, 0);
  for (const auto& [ground, other] :
       {std::pair{&on_box, &on_larger}, std::pair{&on_plane, &on_higher}}) {
    const TwoBodies bodies(cube, *ground);
    const TwoBodies others(cube, *other);
    KeptContacts kept;
    kept.keep(bodies.step(), {});
    EXPECT_TRUE(kept.hold_in(bodies.step(), true));
    EXPECT_FALSE(kept.hold_in(others.step(), true));
  }
}

TEST(KeptContacts, GoAlongWithTheBodies) {
  CubeOnSlab scene;
  KeptContacts kept;
  const std::vector<Contact> before = scene.search();
  ASSERT_GT(before.size(), 100u);
  kept.keep(scene.step(), before);
  const double most = most_kept(scene.step());
  scene.move({0.3 * most, 0, -0.2 * most},
             btVector3(btScalar(0.1 * most / kHalf), 0, btScalar(0.1 * most / kHalf)));
  ASSERT_TRUE(kept.hold_in(scene.step(), true));
  std::vector<Contact> carried;
  kept.move_to(scene.step(), carried);
  const std::vector<Contact> searched = scene.search();
  ASSERT_EQ(carried.size(), before.size());
  std::size_t compared = 0;
  for (const Contact& contact : carried) {
    const std::size_t same = find_from_id(searched, contact.id);
    if (same == searched.size() || searched[same].id != contact.id) continue;
    // Beside an edge, a search takes another normal once the cube has turned.
    if (dot(searched[same].normal, contact.normal) < 0.99999f) continue;
    ++compared;
    EXPECT_NEAR(contact.depth, searched[same].depth, 0.02 * most);
    EXPECT_LT(length(contact.point - searched[same].point), 2.0 * most);
  }
  EXPECT_GT(compared, before.size() / 2);
}

TEST(KeptContacts, AreThoseThatWereChosen) {
  CubeOnSlab scene;
  KeptContacts kept;
  const std::vector<Contact> before = scene.search();
  kept.keep(scene.step(), before);
  const std::vector<Contact> chosen{before[7], before[2], before[30]};
  kept.reduce_to(chosen);
  std::vector<Contact> carried;
  kept.move_to(scene.step(), carried);
  ASSERT_EQ(carried.size(), 3u);
  EXPECT_EQ(carried[0].id, before[2].id);
  EXPECT_EQ(carried[1].id, before[7].id);
  EXPECT_EQ(carried[2].id, before[30].id);
}

/// How far contacts of round surfaces are from where a search finds them, at most, after one of two
/// bodies that touch at the origin has turned about the x axis, in distances by which a ball of the
/// smaller body's radius has rolled. Carried along by the bodies, and followed.
struct Rolled {
  double carried;
  double followed;
};
Rolled roll(btRigidBody& low, btRigidBody& ball, bool ball_is_first, btRigidBody& turned) {
  std::optional<TwoBodies> bodies;
  std::optional<PairStep> step;
  const auto describe = [&] {
    if (ball_is_first) {
      bodies.emplace(ball, low);
    } else {
      bodies.emplace(low, ball);
    }
    step.emplace(bodies->step());
  };
  const auto search_with = [&](ContactSearch& search) {
    search.find_near({}, bodies->pair, step->margin, &*step, Wanted::kAll);
  };
  describe();
  ContactSearch search;
  search_with(search);
  KeptContacts kept;
  kept.keep(*step, search.contacts());
  const double angle = 0.35 * most_kept(*step) / step->ball.radius;
  const btTransform turn(btQuaternion(btVector3(1, 0, 0), btScalar(angle)));
  turned.setWorldTransform(turn * turned.getWorldTransform());
  describe();
  EXPECT_TRUE(kept.hold_in(*step, true));
  EXPECT_TRUE(kept.have_moved_in(*step));
  ContactSearch fresh;
  search_with(fresh);
  const auto farthest = [&] {
    int compared = 0;
    double most = 0.0;
    for (const std::uint32_t id : fresh.exact()) {
      if (!has_id(fresh.contacts(), id) || !has_id(search.contacts(), id)) continue;
      const auto place = [&](ContactSearch& of) {
        const std::vector<Contact>& contacts = of.contacts();
        return bodies->pair.to_world(contacts[find_from_id(contacts, id)]).point_b;
      };
      most = std::max(most, length(place(search) - place(fresh)));
      ++compared;
    }
    EXPECT_GT(compared, 0);
    return most / (angle * step->ball.radius);
  };
  Rolled rolled{};
  kept.move_to(*step, search.contacts());
  rolled.carried = farthest();
  search.follow(bodies->pair);
  rolled.followed = farthest();
  kept.renew(*step, search.contacts());
  EXPECT_TRUE(kept.hold_in(*step, true));
  EXPECT_FALSE(kept.have_moved_in(*step));
  return rolled;
}

/// A contact that is left behind as a ball rolls is a lever by which its own weight pushes it on.
TEST(KeptContacts, OfRoundSurfacesFollowThemAsTheyRoll) {
  constexpr double kRadius = 0.05;
  const auto ball_shape = build_by_tolerance(voxshell::test_support::make_icosphere(kRadius, 5));
  const auto slab = build_by_tolerance({0.2, 0.2, 0.02});
  const auto bar = build_by_tolerance({0.02, 0.2, 0.02});
  const double half_root = std::sqrt(0.5);
  const Pose on_edge{{{half_root, 0, half_root}, {0, 1, 0}, {-half_root, 0, half_root}},
                     {0, 0, -0.02 * std::sqrt(2.0)}};
  for (const bool ball_is_first : {false, true}) {
    for (const bool ball_turns : {false, true}) {
      for (const bool is_on_edge : {false, true}) {
        TestWorld world;
        btRigidBody& low = is_on_edge ? world.add_model(bar, 0, on_edge)
                                      : world.add_model(slab, 0, {{}, {0, 0, -0.02}});
        btRigidBody& ball = world.add_model(ball_shape, 1, {{}, {0, 0, kRadius}});
        ball.applyGravity();
        const Rolled rolled = roll(low, ball, ball_is_first, ball_turns ? ball : low);
        EXPECT_GT(rolled.carried, 0.5) << is_on_edge << ball_is_first << ball_turns;
        EXPECT_LT(rolled.followed, 0.02) << is_on_edge << ball_is_first << ball_turns;
      }
    }
  }
}

/// A floor that rises by far less in a step than contacts are kept for still lifts the cube.
TEST(KeptContacts, LetAFloorThatRisesSlowlyLiftABody) {
  CubeOnSlab scene;
  scene.cube.setActivationState(DISABLE_DEACTIVATION);
  scene.world.step(100, 1.0 / 200.0);
  const double start = height(scene.cube);
  scene.slab.setCollisionFlags(btCollisionObject::CF_KINEMATIC_OBJECT);
  scene.slab.setActivationState(DISABLE_DEACTIVATION);
  constexpr double kSpeed = 2e-5;  // m/s, a tenth of a micrometer a step
  for (int i = 1; i <= 400; ++i) {
    btTransform pose = scene.slab.getWorldTransform();
    pose.setOrigin(pose.getOrigin() + to_bullet(Vec3{0, 0, kSpeed / 200.0}));
    scene.slab.setWorldTransform(pose);
    scene.world.step(1, 1.0 / 200.0);
    EXPECT_NEAR(height(scene.cube) - start, kSpeed * i / 200.0, 2e-6);
  }
}

}  // namespace
}  // namespace voxshell::bullet::kept_contacts_test
