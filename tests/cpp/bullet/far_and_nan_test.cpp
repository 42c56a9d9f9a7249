#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/world.h"
#include "wrap_object.h"

namespace voxshell::bullet::far_and_nan_test {
namespace {

using namespace test_support;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

TEST(FarAndNan, ABodyTeleportedFarAwayAndBackCollidesAgain) {
  TestWorld world;
  world.add_model(slab_model(), 0);
  btRigidBody& ball = world.add_model(ball_model(), 1, {{}, {0, 0, 0.1}});
  ball.setActivationState(DISABLE_DEACTIVATION);
  world.step(20);
  const btTransform home = ball.getWorldTransform();
  for (const double far : {1e3, 1e6}) {
    ball.setWorldTransform(to_bullet(Pose{{}, {far, -far, far}}));
    world.step(5);
    EXPECT_TRUE(world.points().empty());
    EXPECT_EQ(world.dispatcher.getNumManifolds(), 0);
    ball.setWorldTransform(home);
    ball.setLinearVelocity(btVector3(0, 0, 0));
    world.step(20);
    EXPECT_FALSE(world.points().empty());
    EXPECT_NEAR(height(ball), 0.1, 0.002);
  }
}

// Straight to the algorithm: the broadphase would mostly keep such bodies from it.
TEST(FarAndNan, TheNarrowPhaseSurvivesAnyTransform) {
  struct Ignore : btCollisionWorld::ContactResultCallback {
    btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper*, int, int,
                             const btCollisionObjectWrapper*, int, int) override {
      not_finite += !std::isfinite(point.getDistance());
      return 0;
    }
    int not_finite = 0;
  };
  TestWorld world;
  btRigidBody* partners[] = {
      &world.add_model(slab_model(), 0),
      &world.add(world.make<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0),
      &world.add(world.make<btBoxShape>(btVector3(1, 1, 1)), 0),
      &world.add(world.make<btSphereShape>(btScalar(1)), 0)};
  btRigidBody& blob = world.add_model(blob_model(), 1, {{}, {0, 0, 100}});
  const Vec3 places[] = {{kNan, 0, 0},     {kNan, kNan, kNan}, {kInf, 0, 0},
                         {0, -kInf, kInf}, {1e30, 0, 0},       {0, 0, -1e18}};
  const Matrix3 turns[] = {{},
                           {{kNan, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                           {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}},
                           {{1e30, 0, 0}, {0, 1e30, 0}, {0, 0, 1e30}}};
  for (const Vec3& place : places) {
    for (const Matrix3& turn : turns) {
      for (btRigidBody* partner : partners) {
        blob.setWorldTransform(to_bullet(Pose{turn, place}));
        for (const double threshold : {0.0, 1.0}) {
          Ignore ignore;
          ignore.m_closestDistanceThreshold = scalar(threshold);
          world.world.contactPairTest(&blob, partner, ignore);
          world.world.contactPairTest(partner, &blob, ignore);
          EXPECT_EQ(ignore.not_finite, 0);
        }
        btCollisionObjectWrapper wrap0 = wrap_object(blob);
        btCollisionObjectWrapper wrap1 = wrap_object(*partner);
        btManifoldResult result(&wrap0, &wrap1);
        btCollisionAlgorithm* algorithm =
            world.dispatcher.findAlgorithm(&wrap0, &wrap1, nullptr, BT_CONTACT_POINT_ALGORITHMS);
        algorithm->processCollision(&wrap0, &wrap1, world.world.getDispatchInfo(), &result);
        algorithm->processCollision(&wrap0, &wrap1, world.world.getDispatchInfo(), &result);
        for (const btManifoldPoint* point : world.points()) {
          EXPECT_TRUE(std::isfinite(point->getDistance()));
        }
        algorithm->~btCollisionAlgorithm();
        world.dispatcher.freeCollisionAlgorithm(algorithm);
      }
    }
  }
  blob.setWorldTransform(btTransform::getIdentity());
}

TEST(FarAndNan, PointsFoundBeforeTheFirstStepAreFinite) {
  for (const double gap : {-1e-3, 0.0, 5e-5, 1e-4}) {
    TestWorld world;
    world.add_model(slab_model(), 0).setRestitution(1);
    btRigidBody& cube = world.add_model(cube_model(), 1, {{}, {0, 0, kCubeHalf + gap}});
    cube.setRestitution(scalar(0.5));
    cube.setLinearVelocity(btVector3(0, 0, -1));
    world.world.performDiscreteCollisionDetection();
    EXPECT_FALSE(world.points().empty());
    for (const btManifoldPoint* point : world.points()) {
      EXPECT_EQ(point->m_combinedRestitution, scalar(0.5)) << gap;
      EXPECT_TRUE(std::isfinite(point->m_appliedImpulse)) << gap;
    }
  }
}

TEST(FarAndNan, ABodyThatBecomesNanIsPutOutOfTheSimulation) {
  TestWorld world;
  world.add_model(slab_model(), 0);
  btRigidBody& bad = world.add_model(ball_model(), 1, {{}, {0, 0, 0.1}});
  btRigidBody& good = world.add_model(cube_model(), 1, {{}, {0.2, 0, 0.11}});
  good.setActivationState(DISABLE_DEACTIVATION);
  world.step(10);
  bad.setWorldTransform(to_bullet(Pose{{}, {kNan, kNan, kNan}}));
  world.step(200);
  EXPECT_NEAR(height(good), 0.1, 0.002);
}

}  // namespace
}  // namespace voxshell::bullet::far_and_nan_test
