#include <cstddef>
#include <optional>

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>
#include <BulletCollision/NarrowPhaseCollision/btRaycastCallback.h>
#include <gtest/gtest.h>

#include "support/models.h"
#include "support/random.h"
#include "support/world.h"

namespace voxshell::bullet::ray_test {
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

/// Bullet's own mesh of a model's triangles.
class BulletMesh {
 public:
  explicit BulletMesh(const TriangleMesh& mesh) {
    for (const Triangle& t : mesh.triangles()) {
      triangles_.addTriangle(to_bullet(mesh.vertices()[t[0]]), to_bullet(mesh.vertices()[t[1]]),
                             to_bullet(mesh.vertices()[t[2]]));
    }
    shape_.emplace(&triangles_, /*useQuantizedAabbCompression=*/true);
  }
  btBvhTriangleMeshShape& shape() { return *shape_; }

 private:
  btTriangleMesh triangles_;
  std::optional<btBvhTriangleMeshShape> shape_;
};

/// Where a box stops that turns while it is swept; 1 where it does not.
btScalar sweep_box(const TestWorld& world, const Pose& from, const Pose& to) {
  const btBoxShape box(to_bullet(Vec3{0.03, 0.02, 0.01}));
  const btTransform start = to_bullet(from);
  const btTransform end = to_bullet(to);
  btCollisionWorld::ClosestConvexResultCallback sweep(start.getOrigin(), end.getOrigin());
  world.world.convexSweepTest(&box, start, end, sweep);
  return sweep.m_closestHitFraction;
}

TEST_P(Rays, RaysAndSweepsStopWhereABulletMeshStopsThem) {
  Random random(12);
  const Pose world_from_body = random.pose(1.0);
  TestWorld of_model;
  of_model.add_model(torus_model(), GetParam(), world_from_body);
  BulletMesh mesh(torus_model()->mesh());
  TestWorld of_mesh;
  of_mesh.add(mesh.shape(), 0, world_from_body);
  of_model.world.updateAabbs();
  int hits = 0;
  int misses = 0;
  for (int i = 0; i < 300; ++i) {
    const auto pose = [&] {
      return world_from_body * Pose{random.rotation(), 0.2 * random.direction()};
    };
    const Pose from = pose();
    const Pose to = i % 50 == 0 ? from : pose();
    const btScalar swept = sweep_box(of_mesh, from, to);
    EXPECT_NEAR(sweep_box(of_model, from, to), swept, 1e-4);
    const btVector3 start = to_bullet(from.translation);
    const btVector3 end = to_bullet(to.translation);
    btCollisionWorld::ClosestRayResultCallback ray(start, end);
    btCollisionWorld::ClosestRayResultCallback expected(start, end);
    of_model.world.rayTest(start, end, ray);
    of_mesh.world.rayTest(start, end, expected);
    EXPECT_NEAR(ray.m_closestHitFraction, expected.m_closestHitFraction, 1e-5);
    (swept < 1 && expected.hasHit() ? hits : misses)++;
  }
  EXPECT_GT(hits, 30);
  EXPECT_GT(misses, 30);
}

TEST(RayTriangles, AreThoseAlongTheRayAndNotAllOfItsBox) {
  struct RayTriangles : btTriangleRaycastCallback {
    using btTriangleRaycastCallback::btTriangleRaycastCallback;
    void processTriangle(btVector3*, int, int) override { ++count; }
    btScalar reportHit(const btVector3&, btScalar fraction, int, int) override { return fraction; }
    std::size_t count = 0;
  };
  struct SweepTriangles : btTriangleConvexcastCallback {
    using btTriangleConvexcastCallback::btTriangleConvexcastCallback;
    void processTriangle(btVector3*, int, int) override { ++count; }
    btScalar reportHit(const btVector3&, const btVector3&, btScalar fraction, int, int) override {
      return fraction;
    }
    std::size_t count = 0;
  };
  Random random(13);
  const Pose body_from_model = random.pose(0.3);
  const ModelShape shape(ball_model(), body_from_model);
  const std::size_t few = ball_model()->mesh().triangles().size() / 20;
  const btVector3 center = to_bullet(body_from_model.translation);
  const btVector3 from = center + btVector3(1, 1, 1);
  const btVector3 to = center - btVector3(1, 1, 1);
  RayTriangles ray(from, to);
  shape.processAllTriangles(&ray, to, from);
  EXPECT_GT(ray.count, 0u);
  EXPECT_LT(ray.count, few);

  const btSphereShape sphere(scalar(0.01));
  const btVector3 half(scalar(0.01), scalar(0.01), scalar(0.01));
  const btTransform world_from_body = to_bullet(random.pose(1.0));
  const btTransform turn = btTransform(to_bullet(random.pose(0.0)).getBasis());
  SweepTriangles sweep(&sphere, world_from_body * btTransform(turn.getBasis(), from),
                       world_from_body * btTransform(turn.getBasis(), to), world_from_body, 0);
  shape.processAllTriangles(&sweep, to - half, from + half);
  EXPECT_GT(sweep.count, 0u);
  EXPECT_LT(sweep.count, few);
}

}  // namespace
}  // namespace voxshell::bullet::ray_test
