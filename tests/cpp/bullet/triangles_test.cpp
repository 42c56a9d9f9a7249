#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletCollision/CollisionShapes/btTriangleIndexVertexArray.h>
#include <gtest/gtest.h>

#include "support/deepest_result.h"
#include "support/drop.h"
#include "support/models.h"
#include "support/random.h"
#include "support/slow_triangle_contacts.h"
#include "support/world.h"
#include "triangle_contacts.h"

namespace voxshell::bullet::triangles_test {
namespace {

using namespace test_support;
using voxshell::test_support::Random;

/// A static mesh of Bullet's from a height function over a square of 2 x 2 m, `cells` along a side.
struct Terrain {
  template <class Height>
  Terrain(int cells, Height height_at) {
    const int n = cells + 1;
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        const double x = -1.0 + 2.0 * i / cells;
        const double y = -1.0 + 2.0 * j / cells;
        const double z = height_at(x, y);
        vertices.insert(vertices.end(), {scalar(x), scalar(y), scalar(z)});
        heights.push_back(static_cast<float>(z));
      }
    }
    for (int j = 0; j < cells; ++j) {
      for (int i = 0; i < cells; ++i) {
        const int a = j * n + i;
        indices.insert(indices.end(), {a, a + 1, a + n, a + 1, a + n + 1, a + n});
      }
    }
    array = std::make_unique<btTriangleIndexVertexArray>(
        static_cast<int>(indices.size() / 3), indices.data(), 3 * sizeof(int),
        static_cast<int>(vertices.size() / 3), vertices.data(), 3 * sizeof(btScalar));
  }

  Vec3 corner(std::size_t i) const {
    const auto at = 3 * static_cast<std::size_t>(indices[i]);
    return {static_cast<double>(vertices[at]), static_cast<double>(vertices[at + 1]),
            static_cast<double>(vertices[at + 2])};
  }

  std::vector<btScalar> vertices;
  std::vector<float> heights;
  std::vector<int> indices;
  std::unique_ptr<btTriangleIndexVertexArray> array;
};

double flat(double, double) { return 0.0; }
double waves(double x, double y) { return 0.05 * std::sin(7.0 * x) * std::cos(5.0 * y); }

TEST(Triangles, CarryACubeOnMeshesAndHeightfieldsOfAnySize) {
  for (const int cells : {1, 16}) {
    const Terrain terrain(cells, flat);
    for (const bool heightfield : {false, true}) {
      const auto mode =
          heightfield == (cells == 1) ? ContactMode::kRegular : ContactMode::kSegmented;
      SCOPED_TRACE(std::to_string(cells) + (heightfield ? " heightfield" : " mesh"));
      TestWorld world({.mode = mode});
      btCollisionShape* shape = nullptr;
      if (heightfield) {
        shape = &world.make<btHeightfieldTerrainShape>(cells + 1, cells + 1, terrain.heights.data(),
                                                       btScalar(-1), btScalar(1), 2, false);
        shape->setLocalScaling(to_bullet(Vec3{2.0 / cells, 2.0 / cells, 1.0}));
      } else {
        shape = &world.make<btBvhTriangleMeshShape>(terrain.array.get(), true);
      }
      world.add(*shape, 0).setFriction(1);
      btRigidBody& cube = world.add_model(cube_model(), 1, {{}, {0.1, 0.05, kCubeHalf + 0.02}});
      cube.setFriction(1);
      cube.setActivationState(DISABLE_DEACTIVATION);
      world.step(200);
      EXPECT_NEAR(height(cube), kCubeHalf, 0.0005);
      EXPECT_LT(cube.getLinearVelocity().length(), scalar(0.01));
      EXPECT_LT(cube.getAngularVelocity().length(), scalar(0.05));
    }
  }
}

TEST(Triangles, HaveNoInside) {
  const Terrain terrain(8, flat);
  for (const bool above : {true, false}) {
    TestWorld world({}, {0, 0, above ? -9.81 : 9.81});
    world.add(world.make<btBvhTriangleMeshShape>(terrain.array.get(), true), 0);
    btRigidBody& cube =
        world.add_model(cube_model(), 1, {{}, {0, 0, (above ? 1 : -1) * (kCubeHalf + 0.02)}});
    cube.setActivationState(DISABLE_DEACTIVATION);
    world.step(150);
    EXPECT_NEAR(height(cube), (above ? 1 : -1) * kCubeHalf, 0.0005);
  }
}

TEST(Triangles, AreAsDeepAsTheirDeepestPlaceInTheField) {
  const Terrain terrain(24, waves);
  Random random(5);
  int touching = 0;
  for (int i = 0; i < 40; ++i) {
    Pose pose = random.pose(0.0);
    pose.translation = {random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5), 0.0};
    pose.translation.z = waves(pose.translation.x, pose.translation.y) + random.uniform(0.03, 0.13);
    const auto& model = i % 2 == 0 ? blob_model() : torus_model();

    // A dense sampling of every triangle.
    const Pose model_from_world = pose.inverse();
    double deepest = -1.0;
    for (std::size_t t = 0; t < terrain.indices.size(); t += 3) {
      const Vec3 a = model_from_world.transform_point(terrain.corner(t));
      if (length(a) > 0.4) continue;
      const Vec3 b = model_from_world.transform_point(terrain.corner(t + 1));
      const Vec3 c = model_from_world.transform_point(terrain.corner(t + 2));
      constexpr int kSamples = 24;
      for (int u = 0; u <= kSamples; ++u) {
        for (int v = 0; u + v <= kSamples; ++v) {
          const double s = static_cast<double>(u) / kSamples;
          const double r = static_cast<double>(v) / kSamples;
          const auto place = static_cast<Vec3f>(a + s * (b - a) + r * (c - a));
          deepest = std::max(deepest, -static_cast<double>(model->grid().distance(place)));
        }
      }
    }

    TestWorld world;
    btRigidBody& ground =
        world.add(world.make<btBvhTriangleMeshShape>(terrain.array.get(), true), 0);
    btRigidBody& body = world.add_model(model, 1, pose);
    for (const bool body_first : {true, false}) {
      DeepestResult found;
      found.m_closestDistanceThreshold = scalar(0.01);
      world.world.contactPairTest(body_first ? &body : &ground, body_first ? &ground : &body,
                                  found);
      if (deepest < -0.01) {
        EXPECT_EQ(found.depth, -1.0);
        continue;
      }
      ++touching;
      EXPECT_GT(found.depth, deepest - 1e-4) << "pose " << i;
      EXPECT_LT(found.depth, deepest + 3e-3) << "pose " << i;  // no farther than the samples are
    }
  }
  EXPECT_GT(touching, 30);
}

TEST(Triangles, AreFoundAsByTheSlowWay) {
  Random random(6);
  std::size_t found_count = 0;
  std::size_t sample_count = 0;
  for (const int cells : {1, 7, 60}) {
    const Terrain terrain(cells, cells == 7 ? waves : flat);
    const btBvhTriangleMeshShape mesh(terrain.array.get(), true);
    for (const auto& model : {blob_model(), torus_model()}) {
      TriangleContacts fast;  // one for all, as in a world
      for (int i = 0; i < 12; ++i) {
        const Pose model_from_mesh =
            Pose{random.rotation(), random.in_box({-0.5, -0.5, -0.14}, {0.5, 0.5, 0.14})}.inverse();
        const int level = 1 + i % 6;
        const float margin = i % 3 == 0 ? 0.0002f : i % 3 == 1 ? 0.01f : 0.15f;
        SlowTriangleContacts slow;
        const std::vector<Contact> expected =
            slow.find(mesh, *model, model_from_mesh, level, margin);
        const std::vector<Contact>& found = fast.find(mesh, *model, model_from_mesh, level, margin);
        ASSERT_EQ(found.size(), expected.size());
        for (std::size_t k = 0; k < found.size(); ++k) {
          EXPECT_EQ(std::memcmp(&found[k], &expected[k], sizeof(Contact)), 0)
              << cells << " cells, pose " << i << ", contact " << k;
        }
        found_count += found.size();
        sample_count += slow.sample_count;
      }
    }
  }
  EXPECT_GT(found_count, 500u);
  EXPECT_GT(sample_count, 20'000u);
}

TEST(Triangles, AreAsFarAsTheNearestThatAreFound) {
  Random random(9);
  int near = 0;
  for (const int cells : {1, 40}) {
    const Terrain terrain(cells, waves);
    const btBvhTriangleMeshShape mesh(terrain.array.get(), true);
    TriangleContacts triangles;
    for (int i = 0; i < 30; ++i) {
      const Pose model_from_mesh =
          Pose{random.rotation(), random.in_box({-0.5, -0.5, -0.3}, {0.5, 0.5, 0.3})}.inverse();
      constexpr float kMargin = 0.15f;
      triangles.gather(mesh, *blob_model(), model_from_mesh, kMargin);
      const double distance = triangles.distance(*blob_model(), model_from_mesh, kMargin);
      const std::vector<Contact> found = triangles.find(*blob_model(), model_from_mesh, 5, kMargin);
      if (found.empty()) {
        EXPECT_EQ(distance, std::numeric_limits<double>::infinity());
        continue;
      }
      ++near;
      const float deepest = std::ranges::max_element(found, {}, &Contact::depth)->depth;
      EXPECT_NEAR(distance, -static_cast<double>(deepest), 1e-3) << "pose " << i;
    }
  }
  EXPECT_GT(near, 20);
}

TEST(Triangles, StopABodyThatTheyAreMuchThinnerThanAStepOf) {
  const Terrain terrain(8, flat);
  Random random(10);
  for (const double speed : {5.0, 50.0}) {
    for (const double tilt : {0.0, 1.0}) {
      for (int i = 0; i < 6; ++i) {
        TestWorld world({}, {0, 0, 0});
        world.add(world.make<btBvhTriangleMeshShape>(terrain.array.get(), true), 0)
            .setFriction(scalar(0.5));
        const Vec3 way{std::sin(tilt), 0, -std::cos(tilt)};
        Pose pose = random.pose(0.3);
        pose.translation = Vec3{-0.4, pose.translation.y, 0} - random.uniform(0.5, 1.2) * way;
        btRigidBody& body = world.add_model(blob_model(), 1, pose);
        body.setFriction(scalar(0.5));
        body.setLinearVelocity(to_bullet(speed * way));
        ASSERT_GT(lowest_over(world, body, 60, 0.8), 0.0)
            << speed << " m/s, tilt " << tilt << ", throw " << i;
      }
    }
  }
}

}  // namespace
}  // namespace voxshell::bullet::triangles_test
