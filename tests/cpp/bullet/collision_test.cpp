#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include <LinearMath/btPoolAllocator.h>
#include <gtest/gtest.h>

#include "support/touching_pair.h"

namespace voxshell::bullet::collision_test {
namespace {

using namespace test_support;

constexpr double kDepth = 0.004;

// Rounding of btScalar at a meter or two; grids and shells are float32.
constexpr double kTolerance = 3e-6;

class Collision : public testing::TestWithParam<Partner> {};

INSTANTIATE_TEST_SUITE_P(With, Collision, testing::ValuesIn(kAllPartners),
                         [](const auto& tested) { return to_string(tested.param); });

void expect_near(const Vec3& a, const Vec3& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

void expect_contacts_as_by_hand(TouchingPair& pair, const PairCase& c, int max_points) {
  pair.world.world.performDiscreteCollisionDetection();
  double deepest = 0.0;
  int points = 0;
  for (int m = 0; m < pair.world.dispatcher.getNumManifolds(); ++m) {
    const btPersistentManifold& manifold = *pair.world.dispatcher.getManifoldByIndexInternal(m);
    ASSERT_LE(manifold.getNumContacts(), max_points);
    const auto* body0 = manifold.getBody0();
    const auto* body1 = manifold.getBody1();
    ASSERT_TRUE((body0 == pair.cube && body1 == pair.partner) ||
                (body1 == pair.cube && body0 == pair.partner));
    const Vec3 toward_body0 = body0 == pair.cube ? pair.up : -pair.up;
    for (int i = 0; i < manifold.getNumContacts(); ++i) {
      ++points;
      const btManifoldPoint& point = manifold.getContactPoint(i);
      const auto distance = static_cast<double>(point.getDistance());
      const Vec3 normal = from_bullet(point.m_normalWorldOnB);
      const Vec3 on_0 = from_bullet(point.getPositionWorldOnA());
      const Vec3 on_1 = from_bullet(point.getPositionWorldOnB());
      EXPECT_NEAR(length(normal), 1.0, 1e-5);
      EXPECT_GT(dot(normal, toward_body0), 0.95);
      EXPECT_LE(distance, 0.0);
      deepest = std::max(deepest, -distance);
      expect_near(on_0 - on_1, distance * normal, kTolerance);
      expect_near(from_bullet(body0->getWorldTransform() * point.m_localPointA), on_0, kTolerance);
      expect_near(from_bullet(body1->getWorldTransform() * point.m_localPointB), on_1, kTolerance);
    }
  }
  ASSERT_GT(points, 0);
  // A sphere's deepest place lies between the points, which are 10 mm apart.
  const double off_the_top = c.partner == Partner::kSphere ? 0.01 * 0.01 / (2 * 0.3) : 0.0;
  EXPECT_LE(deepest, kDepth + 1e-5);
  EXPECT_GE(deepest, kDepth - 1e-5 - off_the_top);
}

TEST_P(Collision, SegmentedContactsAreAsByHand) {
  for (const PairCase& c : all_pair_cases(GetParam())) {
    SCOPED_TRACE(to_string(c));
    TouchingPair pair(c, kDepth,
                      {.mode = ContactMode::kSegmented, .shell = ShellRule::kFewest, .margin = 0});
    expect_contacts_as_by_hand(pair, c, 1);
  }
}

TEST_P(Collision, RegularContactsAreAsByHand) {
  for (const PairCase& c : all_pair_cases(GetParam())) {
    SCOPED_TRACE(to_string(c));
    TouchingPair pair(c, kDepth,
                      {.mode = ContactMode::kRegular, .shell = ShellRule::kFewest, .margin = 0});
    expect_contacts_as_by_hand(pair, c, 4);
  }
}

TEST_P(Collision, ApartNothingTouches) {
  for (const PairCase& c : all_pair_cases(GetParam())) {
    SCOPED_TRACE(to_string(c));
    TouchingPair pair(c, -0.002, {});
    pair.world.world.performDiscreteCollisionDetection();
    EXPECT_TRUE(pair.world.points().empty());
  }
}

TEST_P(Collision, WithinTheMarginAndAtRestThereIsContact) {
  for (const PairCase& c : all_pair_cases(GetParam())) {
    SCOPED_TRACE(to_string(c));
    TouchingPair pair(c, -0.002, {.margin = 0.003});
    pair.world.world.performDiscreteCollisionDetection();
    ASSERT_FALSE(pair.world.points().empty());
    for (const btManifoldPoint* point : pair.world.points()) {
      EXPECT_GT(point->getDistance(), scalar(0.0019));
      EXPECT_LT(point->getDistance(), scalar(0.0031));
    }
  }
}

// It would rebound before it touches. What does not rebound is stopped at the surface.
TEST_P(Collision, WithinTheMarginAFastApproachOfWhatReboundsIsNoContactYet) {
  for (const PairCase& c : all_pair_cases(GetParam())) {
    SCOPED_TRACE(to_string(c));
    TouchingPair pair(c, -0.002,
                      {.shell = ShellRule::kFewest,
                       .margin = 0.003,
                       .ccd_motion_threshold = std::numeric_limits<double>::infinity()});
    pair.world.world.getDispatchInfo().m_timeStep = scalar(0.005);
    // Of 0.6 m/s, 3 mm a step: the limit. Whichever body moves, the other comes to rest relative.
    btRigidBody& moving = c.cube_mass > 0 ? *pair.cube : *pair.partner;
    const Vec3 closing = &moving == pair.cube ? -pair.up : pair.up;
    moving.setLinearVelocity(to_bullet(0.59 * closing));
    pair.world.world.performDiscreteCollisionDetection();
    EXPECT_FALSE(pair.world.points().empty());
    moving.setLinearVelocity(to_bullet(0.61 * closing));
    pair.world.world.performDiscreteCollisionDetection();
    EXPECT_FALSE(pair.world.points().empty());
    for (btRigidBody* body : {pair.cube, pair.partner}) body->setRestitution(1);
    pair.world.world.performDiscreteCollisionDetection();
    if (c.partner == Partner::kSphere) continue;  // its normals, and thus speeds, differ
    EXPECT_TRUE(pair.world.points().empty());
  }
}

// Bullet's compounds refresh their children's manifolds before the children look: points that
// slid by more than the breaking threshold went, and the solver started cold every step.
TEST_P(Collision, ImpulsesOutliveSliding) {
  for (const PairCase& c : all_pair_cases(GetParam())) {
    SCOPED_TRACE(to_string(c));
    TouchingPair pair(c, kDepth, {});
    auto& world = pair.world;
    world.world.performDiscreteCollisionDetection();
    int contacts = 0;
    for (int m = 0; m < world.dispatcher.getNumManifolds(); ++m) {
      btPersistentManifold& manifold = *world.dispatcher.getManifoldByIndexInternal(m);
      for (int i = 0; i < manifold.getNumContacts(); ++i) {
        manifold.getContactPoint(i).m_appliedImpulse = 5;
        ++contacts;
      }
    }
    ASSERT_GT(contacts, 0);
    const Vec3 sideways = normalized(cross(pair.up, Vec3{1, 0, 0}));
    btTransform moved = pair.cube->getWorldTransform();
    moved.setOrigin(moved.getOrigin() + to_bullet(2e-5 * sideways));
    pair.cube->setWorldTransform(moved);
    world.world.performDiscreteCollisionDetection();
    const auto after = world.points();
    const auto warm = std::count_if(after.begin(), after.end(), [](const btManifoldPoint* point) {
      return point->m_appliedImpulse == btScalar(5);
    });
    EXPECT_GE(2 * warm, contacts);
  }
}

TEST_P(Collision, TheDefaultMarginHolds) {
  for (const PairCase& c : all_pair_cases(GetParam())) {
    SCOPED_TRACE(to_string(c));
    TouchingPair pair(c, -0.0001);
    pair.world.world.performDiscreteCollisionDetection();
    EXPECT_FALSE(pair.world.points().empty());
  }
}

TEST(CollisionConfiguration, NamesAnAlgorithmForEveryPairInBothTables) {
  CollisionConfiguration configuration;
  for (int a = 0; a < MAX_BROADPHASE_COLLISION_TYPES; ++a) {
    for (int b = 0; b < MAX_BROADPHASE_COLLISION_TYPES; ++b) {
      EXPECT_NE(configuration.getCollisionAlgorithmCreateFunc(a, b), nullptr);
      EXPECT_NE(configuration.getClosestPointsAlgorithmCreateFunc(a, b), nullptr);
    }
  }
}

TEST(CollisionConfiguration, LeavesBulletsOwnPairsAlone) {
  TestWorld world;
  auto& box = world.make<btBoxShape>(btVector3(1, 1, 1));
  world.add(box, 0);
  btRigidBody& upper = world.add(box, 1, {{}, {0, 0, 2.5}});
  world.step(400);
  EXPECT_NEAR(height(upper), 2.0, 0.01);
}

TEST(CollisionConfiguration, MakesRoomInAPoolOfTheCallers) {
  btDefaultCollisionConstructionInfo info;
  info.m_customCollisionAlgorithmMaxElementSize = 8;
  CollisionConfiguration configuration({}, info);
  btCollisionDispatcher dispatcher(&configuration);
  btDbvtBroadphase broadphase;
  btCollisionWorld world(&dispatcher, &broadphase, &configuration);
  ModelShape shape(cube_model());
  btCollisionObject a;
  btCollisionObject b;
  for (btCollisionObject* object : {&a, &b}) {
    object->setCollisionShape(&shape);
    object->setWorldTransform(btTransform::getIdentity());
    object->setCollisionFlags(0);
    world.addCollisionObject(object);
  }
  b.getWorldTransform().setOrigin(to_bullet(Vec3{0.15, 0, 0}));
  world.performDiscreteCollisionDetection();
  EXPECT_GT(dispatcher.getNumManifolds(), 0);
  world.removeCollisionObject(&a);
  world.removeCollisionObject(&b);
}

TEST(CollisionConfiguration, RefusesAPoolThatAnAlgorithmWouldOverrun) {
  btPoolAllocator small(128, 16);
  btDefaultCollisionConstructionInfo info;
  info.m_collisionAlgorithmPool = &small;
  try {
    CollisionConfiguration configuration({}, info);
    FAIL() << "took a pool of elements that are too small";
  } catch (const std::logic_error& error) {
    EXPECT_NE(std::string(error.what()).find("128 bytes"), std::string::npos) << error.what();
  }
  btPoolAllocator large(4096, 16);
  info.m_collisionAlgorithmPool = &large;
  CollisionConfiguration configuration({}, info);
  EXPECT_EQ(configuration.getCollisionAlgorithmPool(), &large);
}

}  // namespace
}  // namespace voxshell::bullet::collision_test
