#include <gtest/gtest.h>

#include "support/models.h"
#include "support/random.h"
#include "support/world.h"

namespace voxshell::bullet {
namespace {

using namespace test_support;
using voxshell::test_support::Random;

class Rays : public testing::TestWithParam<double> {};

INSTANTIATE_TEST_SUITE_P(Mass, Rays, testing::Values(0.0, 1.0), [](const auto& tested) {
  return tested.param > 0 ? "Dynamic" : "Static";
});

TEST_P(Rays, MeetABoxWhereTheyShould) {
  Random random(11);
  const Pose body_from_model = random.pose(0.3);
  const Pose world_from_body = random.pose(1.0);
  const Pose world_from_model = world_from_body * body_from_model;
  TestWorld world;
  btRigidBody& body =
      world.add(world.make<ModelShape>(cube_model(), body_from_model), GetParam(), world_from_body);
  world.world.updateAabbs();
  for (int i = 0; i < 100; ++i) {
    const double x = random.uniform(-0.09, 0.09);
    const double y = random.uniform(-0.09, 0.09);
    const Vec3 from = world_from_model.transform_point({x, y, 1.0});
    const Vec3 to = world_from_model.transform_point({x, y, -1.0});
    btCollisionWorld::ClosestRayResultCallback ray(to_bullet(from), to_bullet(to));
    world.world.rayTest(to_bullet(from), to_bullet(to), ray);
    ASSERT_TRUE(ray.hasHit());
    EXPECT_EQ(ray.m_collisionObject, &body);
    EXPECT_NEAR(ray.m_closestHitFraction, 0.45, 2e-5);
    const Vec3 up = world_from_model.rotate({0, 0, 1});
    EXPECT_GT(dot(from_bullet(ray.m_hitNormalWorld), up), 0.999);
  }
}

TEST_P(Rays, PassBesideABallAndBeyondTheirEnd) {
  Random random(12);
  TestWorld world;
  const Pose pose = random.pose(1.0);
  world.add_model(ball_model(), GetParam(), pose);
  world.world.updateAabbs();
  int hits = 0;
  int misses = 0;
  for (int i = 0; i < 400; ++i) {
    const Vec3 direction = random.direction();
    const Vec3 beside = normalized(cross(direction, random.direction()));
    const double offset = random.uniform(0.0, 0.2);
    const Vec3 middle = pose.translation + offset * beside;
    const Vec3 from = middle - direction;
    const Vec3 to = middle + direction;
    btCollisionWorld::ClosestRayResultCallback ray(to_bullet(from), to_bullet(to));
    world.world.rayTest(to_bullet(from), to_bullet(to), ray);
    if (offset < 0.098) {
      ++hits;
      ASSERT_TRUE(ray.hasHit());
      const double depth = std::sqrt(kBallRadius * kBallRadius - offset * offset);
      EXPECT_NEAR(length(from_bullet(ray.m_hitPointWorld) - from), 1.0 - depth, 3e-3);
    } else if (offset > 0.1001) {
      ++misses;
      EXPECT_FALSE(ray.hasHit());
    }
    const Vec3 too_short = middle - 0.11 * direction;
    btCollisionWorld::ClosestRayResultCallback short_ray(to_bullet(from), to_bullet(too_short));
    world.world.rayTest(to_bullet(from), to_bullet(too_short), short_ray);
    EXPECT_FALSE(short_ray.hasHit());
  }
  EXPECT_GT(hits, 100);
  EXPECT_GT(misses, 100);
}

TEST_P(Rays, MeetAModelInACompound) {
  TestWorld world;
  auto& compound = world.make<btCompoundShape>();
  compound.addChildShape(to_bullet(Pose{{}, {0, 0, 0.5}}), &world.make<ModelShape>(cube_model()));
  world.add(compound, GetParam(), {{}, {0.3, 0, 0}});
  world.world.updateAabbs();
  const btVector3 from(scalar(0.32), scalar(0.01), 2);
  const btVector3 to(scalar(0.32), scalar(0.01), 0);
  btCollisionWorld::ClosestRayResultCallback ray(from, to);
  world.world.rayTest(from, to, ray);
  ASSERT_TRUE(ray.hasHit());
  EXPECT_NEAR(ray.m_hitPointWorld.z(), 0.6, 1e-5);
}

TEST_P(Rays, ASweptSphereStopsAtTheSurface) {
  TestWorld world;
  world.add_model(cube_model(), GetParam());
  world.world.updateAabbs();
  btSphereShape sphere(scalar(0.05));
  const btTransform from = to_bullet(Pose{{}, {0.02, 0.01, 1.15}});
  const btTransform to = to_bullet(Pose{{}, {0.02, 0.01, -0.85}});
  btCollisionWorld::ClosestConvexResultCallback sweep(from.getOrigin(), to.getOrigin());
  world.world.convexSweepTest(&sphere, from, to, sweep);
  ASSERT_TRUE(sweep.hasHit());
  EXPECT_NEAR(sweep.m_closestHitFraction, 0.5, 2e-3);
}

}  // namespace
}  // namespace voxshell::bullet
