#include <algorithm>
#include <map>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "contact_constants.h"
#include "facing_normals.h"
#include "rest_margin.h"
#include "support/models.h"
#include "support/random.h"
#include "support/world.h"
#include "voxshell/manifold.h"

namespace voxshell::bullet::manifolds_test {
namespace {

using namespace test_support;
using voxshell::test_support::Random;

void place(btRigidBody& body, const Pose& pose) { body.setWorldTransform(to_bullet(pose)); }

/// What the core finds for a blob, the shell, on a slab at the origin.
std::vector<Contact> contacts_by_core(const btRigidBody& blob) {
  QueryScratch scratch;
  const auto found = find_contacts(slab_model()->field(), blob_model()->shell(),
                                   from_bullet(blob.getWorldTransform()), {}, scratch);
  return {found.begin(), found.end()};
}

/// Somewhere from touching to 20 mm deep.
Pose random_touch(Random& random) {
  return {random.rotation(),
          {random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1), random.uniform(0.06, 0.12)}};
}

TEST(Manifolds, RegularIsOneManifoldOfFourWithTheDeepestFirst) {
  ASSERT_LT(blob_model()->shell().size(), slab_model()->shell().size());
  Random random(21);
  TestWorld world({.mode = ContactMode::kRegular, .shell = ShellRule::kFewest, .margin = 0});
  world.add_model(slab_model(), 0);
  btRigidBody& blob = world.add_model(blob_model(), 1);
  const auto radius = static_cast<double>(blob_model()->shell().tree().spheres(1)[0].radius);
  const double thinnest = std::min(blob_model()->thickness(), slab_model()->thickness());
  const double deep = kDeepOfMargin * default_rest_margin(radius, thinnest);
  int full = 0;
  for (int i = 0; i < 200; ++i) {
    place(blob, random_touch(random));
    world.world.performDiscreteCollisionDetection();
    auto expected = contacts_by_core(blob);
    Opposition opposition;
    drop_from_behind(expected, blob_model()->shell(), 0.0f, static_cast<float>(deep), opposition);
    const ManifoldPoints chosen = select_manifold(expected);
    const auto points = world.points();
    ASSERT_LE(world.dispatcher.getNumManifolds(), 1);
    ASSERT_EQ(points.size(), chosen.count);
    for (std::size_t k = 0; k < points.size(); ++k) {
      EXPECT_EQ(points[k]->m_index0, static_cast<int>(expected[chosen.indices[k]].id));
      EXPECT_GE(points[k]->getDistance(), points[0]->getDistance());
    }
    full += points.size() == 4;
  }
  EXPECT_GT(full, 50);
}

class Segments : public testing::TestWithParam<int> {};

INSTANTIATE_TEST_SUITE_P(Levels, Segments, testing::Values(1, 2, 3, 4, 6, 12));

TEST_P(Segments, AreThoseOfTheCoreWithOnePointEach) {
  Random random(22);
  TestWorld world({.mode = ContactMode::kSegmented,
                   .shell = ShellRule::kFewest,
                   .level = GetParam(),
                   .margin = 0});
  world.add_model(slab_model(), 0);
  btRigidBody& blob = world.add_model(blob_model(), 1);
  std::vector<std::uint32_t> deepest;
  std::size_t most = 0;
  for (int i = 0; i < 200; ++i) {
    place(blob, random_touch(random));
    world.world.performDiscreteCollisionDetection();
    const auto expected = contacts_by_core(blob);
    select_deepest_per_segment(expected, blob_model()->shell(), GetParam(), deepest);
    most = std::max(most, deepest.size());

    auto& pairs = world.broadphase.getOverlappingPairCache()->getOverlappingPairArray();
    btManifoldArray manifolds;
    if (pairs.size() == 1 && pairs[0].m_algorithm != nullptr) {
      pairs[0].m_algorithm->getAllContactManifolds(manifolds);
    }
    ASSERT_EQ(manifolds.size(), static_cast<int>(deepest.size()));
    for (int m = 0; m < manifolds.size(); ++m) {
      ASSERT_EQ(manifolds[m]->getNumContacts(), 1);
      const Contact& contact = expected[deepest[static_cast<std::size_t>(m)]];
      EXPECT_EQ(manifolds[m]->getContactPoint(0).m_index0, static_cast<int>(contact.id));
      EXPECT_NEAR(manifolds[m]->getContactPoint(0).getDistance(), -contact.depth, 1e-7);
    }
    EXPECT_EQ(world.points().size(), deepest.size());  // none in manifolds kept for later
  }
  EXPECT_EQ(most == 1, GetParam() == 1);
}

// Deeper levels do not exist; shifting by them would overflow.
TEST(Manifolds, LevelsBeyondTheTreesAreTheLast) {
  std::size_t counts[2];
  for (const int level : {12, 40}) {
    TestWorld world({.mode = ContactMode::kSegmented, .level = level});
    world.add_model(slab_model(), 0);
    world.add_model(blob_model(), 1, {{}, {0, 0, 0.07}});
    world.world.performDiscreteCollisionDetection();
    counts[level == 40] = world.points().size();
  }
  EXPECT_GT(counts[0], 4u);
  EXPECT_EQ(counts[0], counts[1]);
}

class Release : public testing::TestWithParam<ContactMode> {};

INSTANTIATE_TEST_SUITE_P(Modes, Release,
                         testing::Values(ContactMode::kRegular, ContactMode::kSegmented));

TEST_P(Release, WhenTheBodiesPart) {
  TestWorld world({.mode = GetParam()});
  world.add_model(slab_model(), 0);
  btRigidBody& blob = world.add_model(blob_model(), 1, {{}, {0, 0, 0.08}});
  for (int i = 0; i < 3; ++i) {
    place(blob, {{}, {0, 0, 0.08}});
    world.world.performDiscreteCollisionDetection();
    EXPECT_FALSE(world.points().empty());
    place(blob, {{}, {0, 0, 0.13}});  // apart, though their bounds overlap
    world.world.performDiscreteCollisionDetection();
    EXPECT_TRUE(world.points().empty());
    EXPECT_EQ(world.dispatcher.getNumManifolds(), 0);
  }
}

TEST_P(Release, WhenABodyIsRemovedInContact) {
  for (const bool remove_static : {true, false}) {
    for (const bool compound : {true, false}) {
      TestWorld world({.mode = GetParam()});
      btRigidBody& slab = world.add_model(slab_model(), 0);
      btCollisionShape* shape = &world.make<ModelShape>(blob_model());
      if (compound) {
        auto& whole = world.make<btCompoundShape>();
        whole.addChildShape(btTransform::getIdentity(), shape);
        shape = &whole;
      }
      btRigidBody& blob = world.add(*shape, 1, {{}, {0, 0, 0.08}});
      world.step(3);
      EXPECT_FALSE(world.points().empty());
      world.world.removeRigidBody(remove_static ? &slab : &blob);
      EXPECT_EQ(world.dispatcher.getNumManifolds(), 0);
      world.step(3);
      world.world.addRigidBody(remove_static ? &slab : &blob);
      world.step(3);
      EXPECT_FALSE(world.points().empty());
    }
  }
}

TEST_P(Release, WhenACompoundLosesItsChildInContact) {
  TestWorld world({.mode = GetParam()});
  world.add_model(slab_model(), 0);
  auto& model = world.make<ModelShape>(blob_model());
  auto& box = world.make<btBoxShape>(btVector3(scalar(0.01), scalar(0.01), scalar(0.01)));
  auto& compound = world.make<btCompoundShape>();
  compound.addChildShape(btTransform::getIdentity(), &model);
  compound.addChildShape(to_bullet(Pose{{}, {0, 0, 0.3}}), &box);
  world.add(compound, 1, {{}, {0, 0, 0.08}});
  world.step(2);
  EXPECT_FALSE(world.points().empty());
  compound.removeChildShape(&model);
  world.world.performDiscreteCollisionDetection();
  EXPECT_TRUE(world.points().empty());
}

// In the order that Bullet's own examples use: bodies, world, solver, broadphase, dispatcher,
// configuration.
TEST_P(Release, WhenTheWorldEndsInContact) {
  auto configuration =
      std::make_unique<CollisionConfiguration>(ContactSettings{.mode = GetParam()});
  auto dispatcher = std::make_unique<btCollisionDispatcher>(configuration.get());
  auto broadphase = std::make_unique<btDbvtBroadphase>();
  auto world =
      std::make_unique<btCollisionWorld>(dispatcher.get(), broadphase.get(), configuration.get());
  ModelShape shape(blob_model());
  std::vector<std::unique_ptr<btCollisionObject>> objects;
  for (int i = 0; i < 6; ++i) {
    objects.push_back(std::make_unique<btCollisionObject>());
    objects.back()->setCollisionShape(&shape);
    objects.back()->setCollisionFlags(0);
    objects.back()->setWorldTransform(to_bullet(Pose{{}, {0.15 * i, 0, 0}}));
    world->addCollisionObject(objects.back().get());
  }
  world->performDiscreteCollisionDetection();
  EXPECT_GE(dispatcher->getNumManifolds(), 5);
  world.reset();
  EXPECT_EQ(dispatcher->getNumManifolds(), 0);
}

}  // namespace
}  // namespace voxshell::bullet::manifolds_test
