#include "neighbor.h"

#include <limits>

#include <gtest/gtest.h>

#include "support/world.h"

namespace voxshell::bullet::neighbor_test {
namespace {

using namespace test_support;

TEST(Neighbor, HasTheFieldOfTheNearestPart) {
  TestWorld world;
  btCompoundShape& compound = world.make<btCompoundShape>();
  btCollisionShape& cube = world.make<btBoxShape>(btVector3(1, 1, 1));
  for (const double x : {-3.0, 3.0}) {
    btTransform there = btTransform::getIdentity();
    there.setOrigin(btVector3(scalar(x), 0, 0));
    compound.addChildShape(there, &cube);
  }
  const btRigidBody& body = world.add(compound, 0, {{}, {0, 0, 1}});
  Neighbor neighbor(body, 0.01);
  ASSERT_TRUE(neighbor.has_field());
  const Vec3 place{5, 0, 1};
  EXPECT_NEAR(neighbor.distance(place), 1.0, 1e-6);
  EXPECT_NEAR(neighbor.nearest(place)->outwards(place).x, 1.0, 1e-6);
  EXPECT_NEAR(neighbor.distance({-5, 0, 1}), 1.0, 1e-6);
}

TEST(Neighbor, OfAHullHasNoField) {
  TestWorld world;
  btConvexHullShape& hull = world.make<btConvexHullShape>();
  for (const double x : {0.0, 1.0}) {
    for (const double y : {0.0, 1.0}) hull.addPoint(btVector3(scalar(x), scalar(y), 0));
  }
  hull.addPoint(btVector3(0, 0, 1));
  Neighbor neighbor(world.add(hull, 0), 0.01);
  EXPECT_FALSE(neighbor.has_field());
  EXPECT_EQ(neighbor.distance({2, 0, 0}), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace voxshell::bullet::neighbor_test
