#include <algorithm>
#include <array>
#include <functional>
#include <vector>

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btHeightfieldTerrainShape.h>
#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <gtest/gtest.h>

#include "support/deepest_result.h"
#include "support/drop.h"
#include "support/models.h"
#include "support/world.h"

namespace voxshell::bullet::other_shapes_test {
namespace {

using namespace test_support;
using voxshell::test_support::make_box;

/// A convex shape of Bullet without an algorithm of the adapter's, and its half height along z.
struct Convex {
  const char* name;
  double half_height;
  bool lies_flat;  ///< needs nothing that keeps it from turning
  std::function<btCollisionShape&(TestWorld&)> make;
};

btConvexHullShape& make_hull(TestWorld& world) {
  auto& hull = world.make<btConvexHullShape>();
  for (const Vec3& v : make_box({0.05, 0.05, 0.05}).vertices) hull.addPoint(to_bullet(v));
  hull.setMargin(scalar(0.001));
  return hull;
}

const std::vector<Convex>& convexes() {
  static const std::vector<Convex> all{
      {"Capsule", 0.1, false,
       [](TestWorld& w) -> btCollisionShape& {
         return w.make<btCapsuleShapeZ>(scalar(0.05), scalar(0.1));
       }},
      {"LyingCapsule", 0.05, false,
       [](TestWorld& w) -> btCollisionShape& {
         return w.make<btCapsuleShapeX>(scalar(0.05), scalar(0.1));
       }},
      {"Cylinder", 0.05, false,
       [](TestWorld& w) -> btCollisionShape& {
         return w.make<btCylinderShapeZ>(to_bullet(Vec3{0.06, 0.06, 0.05}));
       }},
      {"Cone", 0.05, true,
       [](TestWorld& w) -> btCollisionShape& {
         auto& cone = w.make<btConeShapeZ>(scalar(0.06), scalar(0.1));
         cone.setMargin(scalar(0.001));  // Bullet's cones, and hulls, are thicker by their margin
         return cone;
       }},
      {"Hull", 0.05, true, [](TestWorld& w) -> btCollisionShape& { return make_hull(w); }},
      {"MultiSphere", 0.05, false,
       [](TestWorld& w) -> btCollisionShape& {
         const btVector3 centers[] = {to_bullet(Vec3{-0.05, 0, 0}), to_bullet(Vec3{0.05, 0, 0})};
         const btScalar radii[] = {scalar(0.05), scalar(0.05)};
         return w.make<btMultiSphereShape>(centers, radii, 2);
       }},
  };
  return all;
}

class OtherConvex : public testing::TestWithParam<std::size_t> {};

INSTANTIATE_TEST_SUITE_P(Shapes, OtherConvex, testing::Range<std::size_t>(0, 6),
                         [](const auto& tested) { return convexes()[tested.param].name; });

TEST_P(OtherConvex, LandsAndRestsOnAModel) {
  const Convex& convex = convexes()[GetParam()];
  for (const bool model_first : {true, false}) {
    TestWorld world;
    if (model_first) world.add_model(slab_model(), 0).setFriction(1);
    btRigidBody& body =
        world.add(convex.make(world), 1, {{}, {0.02, 0.01, convex.half_height + 0.05}});
    if (!model_first) world.add_model(slab_model(), 0).setFriction(1);
    body.setFriction(1);
    if (!convex.lies_flat) body.setAngularFactor(0);
    body.setActivationState(DISABLE_DEACTIVATION);
    world.step(400);
    EXPECT_NEAR(height(body), convex.half_height, 0.003) << convex.name;
    const btVector3 place = place_of(body);
    double fastest_turn = 0.0;
    for (int i = 0; i < 400; ++i) {
      world.step(1);
      fastest_turn = std::max(fastest_turn, turn_of(body));
    }
    EXPECT_LT(fastest_turn, 0.01) << convex.name;
    EXPECT_LT((place_of(body) - place).length(), scalar(5e-4)) << convex.name;
  }
}

TEST_P(OtherConvex, CarriesAModel) {
  const Convex& convex = convexes()[GetParam()];
  TestWorld world;
  world.add(convex.make(world), 0, {{}, {0, 0, -convex.half_height}});
  btRigidBody& cube = world.add_model(cube_model(), 1, {{}, {0, 0, kCubeHalf + 0.02}});
  cube.setAngularFactor(0);
  cube.setActivationState(DISABLE_DEACTIVATION);
  world.step(400);
  EXPECT_NEAR(height(cube), kCubeHalf, 0.003) << convex.name;
}

TEST_P(OtherConvex, AnswersContactTests) {
  const Convex& convex = convexes()[GetParam()];
  for (const double gap : {-0.002, 0.005}) {
    TestWorld world;
    btRigidBody& slab = world.add_model(slab_model(), 0);
    btRigidBody& body = world.add(convex.make(world), 1, {{}, {0, 0, convex.half_height + gap}});
    for (const double threshold : {0.0, 0.01}) {
      for (const bool swap : {false, true}) {
        DeepestResult found;
        found.m_closestDistanceThreshold = scalar(threshold);
        world.world.contactPairTest(swap ? &body : &slab, swap ? &slab : &body, found);
        EXPECT_EQ(found.count > 0, gap < 0 || threshold > gap) << convex.name << gap;
        EXPECT_EQ(world.dispatcher.getNumManifolds(), 0);
      }
    }
  }
}

TEST(OtherConcave, GImpactInTheSameWorldCollidesAndLeavesModelPairsAlone) {
  const Soup soup = make_box({0.05, 0.05, 0.05});
  std::vector<btScalar> vertices;
  std::vector<int> indices;
  for (const Vec3& v : soup.vertices) {
    vertices.insert(vertices.end(), {scalar(v.x), scalar(v.y), scalar(v.z)});
  }
  for (const Triangle& t : soup.triangles) {
    for (const std::uint32_t index : t) indices.push_back(static_cast<int>(index));
  }
  btTriangleIndexVertexArray array(static_cast<int>(soup.triangles.size()), indices.data(),
                                   3 * sizeof(int), static_cast<int>(soup.vertices.size()),
                                   vertices.data(), 3 * sizeof(btScalar));
  TestWorld world;
  btGImpactCollisionAlgorithm::registerAlgorithm(&world.dispatcher);
  auto& mesh = world.make<btGImpactMeshShape>(&array);
  mesh.setMargin(scalar(0.001));
  mesh.updateBound();
  world.add_model(slab_model(), 0);
  btRigidBody& gimpact = world.add(mesh, 1, {{}, {0.2, 0, 0.08}});
  btRigidBody& ball = world.add_model(ball_model(), 1, {{}, {-0.15, 0, 0.12}});
  gimpact.setActivationState(DISABLE_DEACTIVATION);
  world.step(200);
  EXPECT_NEAR(height(ball), kBallRadius, 0.001);
  EXPECT_NEAR(height(gimpact), 0.05, 0.005);
}

}  // namespace
}  // namespace voxshell::bullet::other_shapes_test
