#include "hull.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <variant>
#include <vector>

#include <BulletCollision/CollisionShapes/btConvexPointCloudShape.h>
#include <BulletCollision/CollisionShapes/btConvexTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTetrahedronShape.h>
#include <gtest/gtest.h>

#include "support/deepest_result.h"
#include "support/drop.h"
#include "support/models.h"
#include "support/random.h"
#include "support/world.h"

namespace voxshell::bullet::hull_test {
namespace {

using namespace test_support;
using voxshell::test_support::make_box;
using voxshell::test_support::moved;
using voxshell::test_support::Random;

constexpr double kThinMargin = 0.001;

btConvexHullShape& make_hull(TestWorld& world, const std::vector<Vec3>& points, double margin) {
  auto& hull = world.make<btConvexHullShape>();
  for (const Vec3& p : points) hull.addPoint(to_bullet(p), false);
  hull.recalcLocalAabb();
  hull.setMargin(scalar(margin));
  return hull;
}

std::vector<Vec3> box_points(const Vec3& half) { return make_box(half).vertices; }

/// Corners on an ellipsoid: no two faces alike.
std::vector<Vec3> pebble_points() {
  Random random(42);
  std::vector<Vec3> points;
  for (int i = 0; i < 42; ++i) {
    const Vec3 p = random.direction();
    points.push_back({0.1 * p.x, 0.08 * p.y, 0.05 * p.z});
  }
  return points;
}

/// The deepest contact of a pair, as a contact test finds it.
struct Deepest : btCollisionWorld::ContactResultCallback {
  btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper*, int, int,
                           const btCollisionObjectWrapper*, int, int) override {
    const double depth_here = -static_cast<double>(point.getDistance());
    if (depth_here > depth) {
      depth = depth_here;
      normal = from_bullet(point.m_normalWorldOnB);
    }
    return 0;
  }
  double depth = -1.0;
  Vec3 normal{};
};

Deepest deepest_of(TestWorld& world, btRigidBody& a, btRigidBody& b, double threshold = 0.0) {
  Deepest found;
  found.m_closestDistanceThreshold = scalar(threshold);
  world.world.contactPairTest(&a, &b, found);
  return found;
}

TEST(Hull, OfABoxMeetsAModelAsTheBoxDoes) {
  Random random(5);
  const Vec3 half{0.05, 0.08, 0.03};
  int touching = 0;
  for (int i = 0; i < 300; ++i) {
    const Pose pose{random.rotation(), 0.13 * random.direction()};
    Deepest found[2];
    for (const bool as_hull : {false, true}) {
      TestWorld world;
      btRigidBody& model = world.add_model(blob_model(), 0);
      btCollisionShape& shape =
          as_hull ? static_cast<btCollisionShape&>(make_hull(world, box_points(half), 0.0))
                  : world.make<btBoxShape>(to_bullet(half));
      found[as_hull] = deepest_of(world, model, world.add(shape, 1, pose));
    }
    EXPECT_NEAR(found[1].depth, found[0].depth, 1e-5) << i;
    if (found[0].depth < 1e-4) continue;
    ++touching;
    EXPECT_LT(length(found[1].normal - found[0].normal), 1e-3) << i;
  }
  EXPECT_GT(touching, 100);
  EXPECT_LT(touching, 300);
}

/// Each of the shapes that are hulls, of a tetrahedron or of a box.
std::vector<btCollisionShape*> hull_shapes(TestWorld& world) {
  static const std::vector<btVector3> cloud = [] {
    std::vector<btVector3> points;
    for (const Vec3& p : box_points({0.02, 0.02, 0.02})) points.push_back(to_bullet(p));
    return points;
  }();
  static const auto mesh = [] {
    auto triangles = std::make_unique<btTriangleMesh>();
    const auto box = make_box({0.02, 0.02, 0.02});
    for (const auto& [a, b, c] : box.triangles) {
      triangles->addTriangle(to_bullet(box.vertices[a]), to_bullet(box.vertices[b]),
                             to_bullet(box.vertices[c]));
    }
    return triangles;
  }();
  const int count = static_cast<int>(cloud.size());
  return {&make_hull(world, box_points({0.02, 0.02, 0.02}), 0.04),
          &world.make<btConvexPointCloudShape>(const_cast<btVector3*>(cloud.data()), count,
                                               btVector3(1, 1, 1)),
          &world.make<btConvexTriangleMeshShape>(mesh.get()),
          &world.make<btBU_Simplex1to4>(cloud[0], cloud[1], cloud[2], cloud[4])};
}

TEST(Hull, WhollyInsideAModelIsPushedOut) {
  for (std::size_t i = 0; i < 4; ++i) {
    TestWorld world({}, {0, 0, 0});
    btCollisionShape& shape = *hull_shapes(world)[i];
    shape.setMargin(scalar(kThinMargin));
    btRigidBody& cube = world.add_model(cube_model(), 0);
    btRigidBody& body = world.add(shape, 1, {{}, {0.01, 0.0, 0.06}});
    EXPECT_GT(deepest_of(world, cube, body).depth, 0.04) << shape.getName();
    world.step(400);
    EXPECT_GT(height(body), kCubeHalf) << shape.getName();
  }
}

TEST(Hull, HasItsLocalScaling) {
  TestWorld world;
  btRigidBody& slab = world.add_model(slab_model(), 0);
  auto& hull = make_hull(world, box_points({0.05, 0.05, 0.05}), 0.0);
  hull.setLocalScaling(btVector3(1, 1, 2));
  btRigidBody& body = world.add(hull, 1, {{}, {0, 0, 0.097}});
  EXPECT_NEAR(deepest_of(world, slab, body).depth, 0.003, 1e-5);
}

TEST(Hull, GrowsWithItsShape) {
  TestWorld world({}, {0, 0, 0});
  world.add_model(slab_model(), 0);
  auto& hull = make_hull(world, box_points({0.05, 0.05, 0.05}), kThinMargin);
  world.add(hull, 1, {{}, {0, 0, 0.049 + kThinMargin}});
  const auto depth = [&] {
    world.world.performDiscreteCollisionDetection();
    return test_support::deepest_of(world);
  };
  EXPECT_NEAR(depth(), 0.001, 1e-5);
  hull.addPoint(to_bullet(Vec3{0, 0, -0.06}));
  EXPECT_NEAR(depth(), 0.011, 1e-4);
  hull.setLocalScaling(btVector3(1, 1, scalar(1.1)));
  EXPECT_NEAR(depth(), 0.017, 1e-4);
}

// Planes of the faces alone would meet beyond an edge or a corner, at 1.4 and 1.7 margins.
TEST(Hull, IsRoundedOffByItsMargin) {
  constexpr double kMargin = 0.04;
  constexpr double kHalf = 0.05;
  constexpr double kQuarter = std::numbers::pi / 4.0;
  const auto turned = [](const Vec3& axis, double angle) {
    const btQuaternion q(to_bullet(axis), scalar(angle));
    return from_bullet(btTransform(q)).rotation;
  };
  const double to_corner = std::acos(1.0 / std::sqrt(3.0));
  struct Case {
    Matrix3 rotation;
    double lowest;  ///< below the middle
  };
  const Case cases[] = {
      {turned({1, 0, 0}, kQuarter), std::sqrt(2.0) * kHalf},
      {turned(normalized(Vec3{1, -1, 0}), to_corner), std::sqrt(3.0) * kHalf},
      {turned(normalized(Vec3{1, 1, 0}), to_corner), std::sqrt(3.0) * kHalf},
  };
  for (const Case& tested : cases) {
    TestWorld world;
    btRigidBody& slab = world.add_model(slab_model(), 0);
    auto& hull = make_hull(world, box_points({kHalf, kHalf, kHalf}), kMargin);
    btRigidBody& body =
        world.add(hull, 1, {tested.rotation, {0.003, 0.004, tested.lowest + kMargin - 0.002}});
    EXPECT_NEAR(deepest_of(world, slab, body).depth, 0.002, 1e-4);
    body.setWorldTransform(
        to_bullet(Pose{tested.rotation, {0.003, 0.004, tested.lowest + kMargin + 0.002}}));
    EXPECT_EQ(deepest_of(world, slab, body).depth, -1.0);
  }
}

TEST(Hull, StandsOffByLittleMoreThanItsMarginAtSharpCorners) {
  const std::vector<Vec3> needle{
      {0, 0, 0.2}, {0.01, 0, -0.2}, {-0.01, 0.01, -0.2}, {-0.01, -0.01, -0.2}};
  const std::vector<Vec3> wedge{{-0.1, 0, 0},     {0.1, 0, 0},        {-0.1, 0.1, 0.01},
                                {0.1, 0.1, 0.01}, {-0.1, 0.1, -0.01}, {0.1, 0.1, -0.01}};
  constexpr double kMargin = 0.04;
  Random random(8);
  for (const auto& points : {box_points({0.1, 0.05, 0.01}), pebble_points(), needle, wedge}) {
    const auto hull = Hull::create(points);
    ASSERT_TRUE(hull);
    const auto& field = std::get<ConvexField>(hull->field());
    for (int i = 0; i < 10'000; ++i) {
      const Vec3 outwards = random.direction();
      const Vec3 corner =
          *std::ranges::max_element(points, {}, [&](const Vec3& p) { return dot(p, outwards); });
      const auto there = static_cast<Vec3f>(corner + kMargin * outwards);
      EXPECT_LE(field.distance(there), kMargin + 4e-5);  // 1e-4 of the needle
      EXPECT_GT(field.distance(there), kMargin / 1.25);
    }
  }
}

TEST(Hull, ThatIsFlatOrHasTooManyFacesIsBulletsOwn) {
  EXPECT_FALSE(Hull::create({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.5, 0.5, 0}}));
  EXPECT_FALSE(Hull::create({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_FALSE(Hull::create({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, std::nan("")}}));
  EXPECT_FALSE(Hull::create(std::vector<Vec3>(8)));
  EXPECT_FALSE(Hull::create({}));
  Random random(3);
  std::vector<Vec3> many;
  while (many.size() < ConvexField::kMostFaces) many.push_back(random.direction());
  EXPECT_FALSE(Hull::create(many));
  many.resize(ConvexField::kMostFaces / 4);
  EXPECT_TRUE(Hull::create(many));

  TestWorld world;
  world.add_model(slab_model(), 0);
  std::vector<Vec3> corners = box_points({0.1, 0.1, 0.0});
  btRigidBody& plate = world.add(make_hull(world, corners, 0.01), 1, {{}, {0, 0, 0.05}});
  world.step(400);
  EXPECT_NEAR(height(plate), 0.01, 0.002);
}

TEST(Hulls, AreBuiltOnceForEqualPoints) {
  TestWorld world;
  Hulls hulls;
  auto& hull = make_hull(world, box_points({0.1, 0.1, 0.1}), 0.0);
  const auto first = hulls.of(hull);
  ASSERT_TRUE(first);
  EXPECT_EQ(hulls.of(make_hull(world, box_points({0.1, 0.1, 0.1}), 0.01)), first);
  hull.addPoint(btVector3(0, 0, scalar(0.2)));
  const auto second = hulls.of(hull);
  ASSERT_TRUE(second);
  EXPECT_NE(second, first);
  EXPECT_EQ(second->points().size(), 9u);
  // What nobody uses is forgotten, what somebody does is not.
  for (int i = 1; i < 2000; ++i) hulls.of(make_hull(world, box_points({0.1, 0.1, 1e-3 * i}), 0.0));
  EXPECT_EQ(hulls.of(hull), second);
}

/// 5 cm thick, its top at z = 0.
std::shared_ptr<const Model> thin_slab() {
  static const auto slab = build_model(moved(make_box({0.5, 0.5, 0.025}), {0, 0, -0.025}), 0.01);
  return slab;
}

// A step of 50 m/s at 60 Hz is 83 cm; the small one fits between the slab's points.
TEST(Hull, ThrownAtAThinModelStaysOnItsSide) {
  std::vector<Vec3> small = pebble_points();
  for (Vec3& p : small) p = 0.1 * p;
  Random random(6);
  for (const double speed : {2.0, 5.0, 50.0}) {
    for (const auto& points : {box_points({0.05, 0.05, 0.05}), pebble_points(), small,
                               box_points({0.005, 0.005, 0.005})}) {
      for (int i = 0; i < 12; ++i) {
        TestWorld world;
        world.add_model(thin_slab(), 0).setFriction(1);
        Pose pose = random.pose(0.0);
        pose.translation = {random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2),
                            random.uniform(0.3, 1.0)};
        btRigidBody& body = world.add(make_hull(world, points, kThinMargin), 1, pose);
        body.setFriction(1);
        body.setLinearVelocity(btVector3(0, 0, scalar(-speed)));
        ASSERT_GT(lowest_over(world, body, 60, 0.45), 0.0) << speed << " m/s, throw " << i;
      }
    }
  }
}

struct Placements {
  int calm = 0;     ///< lie still after 20 s
  int falling = 0;  ///< turn by more than 0.1 rad/s within the next 5 s, and sink
  int turning = 0;  ///< turn as fast, and do not sink
};

/// Of a hull in placements that are spread over a millimeter.
Placements count_calm(const std::vector<Vec3>& points, double margin, int placements = 10) {
  Placements count;
  for (int placement = 0; placement < placements; ++placement) {
    TestWorld world;
    world.add_model(slab_model(), 0).setFriction(1);
    btRigidBody& body =
        world.add(make_hull(world, points, margin), 1,
                  {{}, {0.013 + 1e-3 * placement / placements, 0.007, 0.15 + margin}});
    body.setFriction(scalar(0.8));
    body.setDamping(0, scalar(0.05));
    body.setActivationState(DISABLE_DEACTIVATION);
    world.step(4000);
    const btVector3 start = place_of(body);
    const double from = height(body);
    double fastest_turn = 0.0;
    for (int i = 0; i < 1000; ++i) {
      world.step(1);
      fastest_turn = std::max(fastest_turn, turn_of(body));
    }
    const double drift = static_cast<double>((place_of(body) - start).length());
    if (fastest_turn < 0.002 && drift < (kIsDouble ? 1e-4 : 2e-3)) ++count.calm;
    if (!(fastest_turn < 0.1)) ++(height(body) < from - 1e-4 ? count.falling : count.turning);
  }
  return count;
}

// With edges rounded by 4 cm, the pebble is a smooth belly: where it comes to stand on an edge,
// rolling friction holds it there, and it moves on in jerks of up to 0.05 rad/s. The box may rock
// by rounding errors of single precision.
TEST(Hull, RestsOnAModel) {
  const auto expect = [](const Placements& found, int least_calm, int most_falling = 0) {
    EXPECT_GE(found.calm, least_calm);
    EXPECT_EQ(found.turning, 0);
    EXPECT_LE(found.falling, most_falling);
  };
  const auto box = box_points({0.1, 0.05, 0.05});
  expect(count_calm(box, kThinMargin), 10);
  if (kIsDouble) {
    expect(count_calm(pebble_points(), kThinMargin), 10);
  } else {
    // Which of them depends on the last bits; of a hundred, 87 to 90 lie still.
    expect(count_calm(pebble_points(), kThinMargin, 50), 40);
  }
  expect(count_calm(box, 0.04), kIsDouble ? 10 : 7);
  // Which of them depends on the last bits; of a hundred, 78 to 82 lie still. In single precision
  // some stand on an edge for more than 20 s, and fall: 10 of 600.
  expect(count_calm(pebble_points(), 0.04, 50), 35, kIsDouble ? 0 : 3);
}

TEST(Hull, ReboundsAsRestitutionSays) {
  constexpr double kHalf = 0.05;
  for (const double restitution : {0.9, 0.5}) {
    for (int phase = 0; phase < 5; ++phase) {
      TestWorld world;
      world.add_model(slab_model(), 0).setRestitution(1);
      const double drop = 0.5 + 0.0031 * phase;
      const double touching = kHalf + kThinMargin;
      btRigidBody& body =
          world.add(make_hull(world, box_points({kHalf, kHalf, kHalf}), kThinMargin), 1,
                    {{}, {0, 0, touching + drop}});
      body.setRestitution(scalar(restitution));
      bool rises = false;
      double top = touching;
      for (int i = 0; i < 800; ++i) {
        world.step(1, 1.0 / 500.0);
        rises = rises || body.getLinearVelocity().z() > scalar(0.02);
        if (rises && body.getLinearVelocity().z() < 0) break;
        if (rises) top = std::max(top, height(body));
      }
      const double squared = restitution * restitution;
      EXPECT_NEAR((top - touching) / drop, squared, 0.02 * squared) << phase;
    }
  }
}

}  // namespace
}  // namespace voxshell::bullet::hull_test
