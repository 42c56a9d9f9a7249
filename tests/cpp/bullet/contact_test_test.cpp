#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "support/touching_pair.h"

namespace voxshell::bullet::contact_test_test {
namespace {

using namespace test_support;

/// One reported point, as seen from the object that was asked about first.
struct Reported {
  double distance;
  Vec3 normal_toward_first;
  int part0;
  int part1;
};

class Collector : public btCollisionWorld::ContactResultCallback {
 public:
  Collector(const btCollisionObject* first, double threshold) : first_(first) {
    m_closestDistanceThreshold = scalar(threshold);
  }

  btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper* wrap0, int part0,
                           int, const btCollisionObjectWrapper* wrap1, int part1, int) override {
    EXPECT_NE(wrap0->getCollisionObject(), wrap1->getCollisionObject());
    const bool in_order = wrap0->getCollisionObject() == first_;
    const Vec3 normal = from_bullet(point.m_normalWorldOnB);
    reported.push_back(
        {static_cast<double>(point.getDistance()), in_order ? normal : -normal, part0, part1});
    const Vec3 on_0 =
        from_bullet(wrap0->getCollisionObject()->getWorldTransform() * point.m_localPointA);
    EXPECT_LT(length(on_0 - from_bullet(point.getPositionWorldOnA())), 3e-6);
    const Vec3 on_1 =
        from_bullet(wrap1->getCollisionObject()->getWorldTransform() * point.m_localPointB);
    EXPECT_LT(length(on_1 - from_bullet(point.getPositionWorldOnB())), 3e-6);
    return 0;
  }

  double smallest_distance() const {
    double smallest = 1e9;
    for (const Reported& r : reported) smallest = std::min(smallest, r.distance);
    return smallest;
  }

  std::vector<Reported> reported;

 private:
  const btCollisionObject* first_;
};

class ContactTest : public testing::TestWithParam<Partner> {};

INSTANTIATE_TEST_SUITE_P(With, ContactTest, testing::ValuesIn(kAllPartners),
                         [](const auto& tested) { return to_string(tested.param); });

void expect_agreement(TouchingPair& pair, const Collector& collector,
                      const btCollisionObject* first, double distance) {
  ASSERT_FALSE(collector.reported.empty());
  EXPECT_LE(collector.reported.size(), 4u);
  const Vec3 toward_first = first == pair.cube ? pair.up : -pair.up;
  // A sphere's normals fan out with the threshold.
  for (const Reported& r : collector.reported) {
    EXPECT_GT(dot(r.normal_toward_first, toward_first), 0.9);
  }
  EXPECT_GE(collector.smallest_distance(), distance - 1e-5);
  EXPECT_LE(collector.smallest_distance(), distance + 2e-4);
}

TEST_P(ContactTest, OfAPairFindsPenetrationWithAndWithoutAThreshold) {
  for (const PairCase& c : all_pair_cases(GetParam())) {
    SCOPED_TRACE(to_string(c));
    TouchingPair pair(c, 0.004, {.shell = ShellRule::kFewest});
    for (const double threshold : {0.0, 0.002, 0.02}) {
      for (const bool cube_asks : {true, false}) {
        btRigidBody* first = cube_asks ? pair.cube : pair.partner;
        btRigidBody* second = cube_asks ? pair.partner : pair.cube;
        Collector collector(first, threshold);
        pair.world.world.contactPairTest(first, second, collector);
        expect_agreement(pair, collector, first, -0.004);
        EXPECT_EQ(pair.world.dispatcher.getNumManifolds(), 0);
      }
    }
  }
}

TEST_P(ContactTest, OfAPairFindsSeparationUpToTheThreshold) {
  for (const PairCase& c : all_pair_cases(GetParam())) {
    SCOPED_TRACE(to_string(c));
    TouchingPair pair(c, -0.005, {.shell = ShellRule::kFewest});
    for (const bool cube_asks : {true, false}) {
      btRigidBody* first = cube_asks ? pair.cube : pair.partner;
      btRigidBody* second = cube_asks ? pair.partner : pair.cube;
      Collector near(first, 0.007);
      pair.world.world.contactPairTest(first, second, near);
      expect_agreement(pair, near, first, 0.005);
      Collector nearer(first, 0.004);
      pair.world.world.contactPairTest(first, second, nearer);
      EXPECT_TRUE(nearer.reported.empty());
      Collector touching(first, 0.0);
      pair.world.world.contactPairTest(first, second, touching);
      EXPECT_TRUE(touching.reported.empty());
      EXPECT_EQ(pair.world.dispatcher.getNumManifolds(), 0);
    }
  }
}

TEST_P(ContactTest, OfTheWorldAgreesWithTheSimulation) {
  for (const PairCase& c : all_pair_cases(GetParam())) {
    SCOPED_TRACE(to_string(c));
    TouchingPair pair(c, 0.004, {.shell = ShellRule::kFewest});
    for (btRigidBody* first : {pair.cube, pair.partner}) {
      Collector collector(first, 0.0);
      pair.world.world.contactTest(first, collector);
      expect_agreement(pair, collector, first, -0.004);
    }
    pair.world.world.performDiscreteCollisionDetection();
    double deepest = 0.0;
    for (const btManifoldPoint* point : pair.world.points()) {
      deepest = std::min(deepest, static_cast<double>(point->getDistance()));
    }
    const int manifolds = pair.world.dispatcher.getNumManifolds();
    const auto points = pair.world.points().size();
    Collector again(pair.cube, 0.0);
    pair.world.world.contactTest(pair.cube, again);
    EXPECT_NEAR(again.smallest_distance(), deepest, 1e-6);
    EXPECT_EQ(pair.world.dispatcher.getNumManifolds(), manifolds);
    EXPECT_EQ(pair.world.points().size(), points);
  }
}

TEST(ContactTest, WorksOnObjectsThatAreInNoWorld) {
  TestWorld world;
  ModelShape shape(ball_model());
  btCollisionObject a;
  btCollisionObject b;
  a.setCollisionShape(&shape);
  b.setCollisionShape(&shape);
  a.setWorldTransform(btTransform::getIdentity());
  b.setWorldTransform(to_bullet(Pose{{}, {0, 0, 2 * kBallRadius + 0.01}}));
  Collector collector(&a, 0.02);
  world.world.contactPairTest(&a, &b, collector);
  ASSERT_FALSE(collector.reported.empty());
  EXPECT_NEAR(collector.smallest_distance(), 0.01, 3e-4);
}

}  // namespace
}  // namespace voxshell::bullet::contact_test_test
