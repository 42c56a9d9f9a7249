#include "posed_pair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <gtest/gtest.h>

#include "contact_constants.h"
#include "support/models.h"
#include "support/random.h"
#include "support/two_bodies.h"
#include "wrap_object.h"

namespace voxshell::bullet::posed_pair_test {
namespace {

using namespace test_support;
using voxshell::test_support::Random;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTolerance = 2e-6;  // of single precision, meters

/// A shape at a pose as one side of a pair.
struct Placed {
  explicit Placed(const btCollisionShape& shape, const Pose& world_from_body = {},
                  const Hull* hull = nullptr)
      : world_from_object(to_bullet(world_from_body)),
        wrap(nullptr, &shape, &object, world_from_object, -1, -1),
        side(wrap, hull) {}

  /// Of the field at a place of the world, meters.
  double distance_at(const Vec3& world) const {
    const Vec3 place = side.world_from_geometry().inverse().transform_point(world);
    return std::visit(
        [&](const auto& field) {
          return static_cast<double>(field.distance(static_cast<Vec3f>(place)));
        },
        *side.participant().field);
  }

  btCollisionObject object;
  btTransform world_from_object;
  btCollisionObjectWrapper wrap;
  Side side;
};

TEST(CollisionMethod, IsThatOfTheShapesType) {
  const std::vector<std::pair<int, CollisionMethod>> methods{
      {FAST_CONCAVE_MESH_PROXYTYPE, CollisionMethod::kModel},
      {STATIC_PLANE_PROXYTYPE, CollisionMethod::kField},
      {CONE_SHAPE_PROXYTYPE, CollisionMethod::kField},
      {CONVEX_HULL_SHAPE_PROXYTYPE, CollisionMethod::kHull},
      {TETRAHEDRAL_SHAPE_PROXYTYPE, CollisionMethod::kHull},
      {TERRAIN_SHAPE_PROXYTYPE, CollisionMethod::kTriangles},
      {SCALED_TRIANGLE_MESH_SHAPE_PROXYTYPE, CollisionMethod::kTriangles},
      {MULTI_SPHERE_SHAPE_PROXYTYPE, CollisionMethod::kConvex},
      {MINKOWSKI_SUM_SHAPE_PROXYTYPE, CollisionMethod::kConvex},
      {COMPOUND_SHAPE_PROXYTYPE, CollisionMethod::kCompound},
      {EMPTY_SHAPE_PROXYTYPE, CollisionMethod::kNever},
      {SOFTBODY_SHAPE_PROXYTYPE, CollisionMethod::kUnserved}};
  for (const auto& [type, method] : methods) EXPECT_EQ(collision_method_of(type), method) << type;
  // A compound of GImpact's has the type of its meshes, and passes on no triangles.
  EXPECT_EQ(collision_method_of(GIMPACT_SHAPE_PROXYTYPE), CollisionMethod::kTriangles);
  EXPECT_EQ(collision_method_of(btGImpactCompoundShape()), CollisionMethod::kUnserved);
}

/// A place of a shape's own frame that is `distance` away from its surface.
struct Known {
  Vec3 place;
  double distance;
};

void expect_distances(const btCollisionShape& shape, const std::vector<Known>& known) {
  const Pose world_from_body = Random(4).pose(1.0);
  const Placed placed(shape, world_from_body);
  for (const Known& at : known) {
    EXPECT_NEAR(placed.distance_at(world_from_body.transform_point(at.place)), at.distance,
                kTolerance)
        << shape.getName() << " at " << at.place.x << ", " << at.place.y << ", " << at.place.z;
  }
}

TEST(Side, HasTheDistancesOfAPlaneABoxAndABall) {
  expect_distances(btStaticPlaneShape(btVector3(scalar(0.6), 0, scalar(0.8)), scalar(0.2)),
                   {{{0.6, 5, 0.8}, 0.8}, {{0, -3, 0}, -0.2}});
  expect_distances(
      btBoxShape(to_bullet(Vec3{0.1, 0.2, 0.3})),
      {{{0.4, 0, 0}, 0.3}, {{0, 0.1, 0.2}, -0.1}, {{0.2, 0.3, -0.4}, std::sqrt(0.03)}});
  expect_distances(btSphereShape(scalar(0.2)), {{{0, 0.3, -0.4}, 0.3}, {{}, -0.2}});
}

/// From the axis of revolution, and from a direction across it.
Vec3 along(int axis, double on_axis, double aside) {
  Vec3 place;
  place[axis] = on_axis;
  place[(axis + 1) % 3] = aside;
  return place;
}

TEST(Side, HasTheDistancesOfRoundShapesAboutEachAxis) {
  constexpr double kRadius = 0.1;
  constexpr double kHalf = 0.2;  // between the centers of the balls, the bases, the base and apex
  const btScalar r = scalar(kRadius);
  const btScalar h = scalar(kHalf);
  const btCapsuleShapeX capsule_x(r, 2 * h);
  const btCapsuleShape capsule_y(r, 2 * h);
  const btCapsuleShapeZ capsule_z(r, 2 * h);
  const btCylinderShapeX cylinder_x({h, r, r});
  const btCylinderShape cylinder_y({r, h, r});
  const btCylinderShapeZ cylinder_z({r, r, h});
  const btConeShapeX cone_x(r, 2 * h);
  const btConeShape cone_y(r, 2 * h);
  const btConeShapeZ cone_z(r, 2 * h);
  const std::array<const btCollisionShape*, 3> capsules{&capsule_x, &capsule_y, &capsule_z};
  const std::array<const btCollisionShape*, 3> cylinders{&cylinder_x, &cylinder_y, &cylinder_z};
  const std::array<const btCollisionShape*, 3> cones{&cone_x, &cone_y, &cone_z};
  // From a cone's slant: its normal leans by radius over height.
  const double slant = kRadius / std::hypot(1.0, kRadius / (2 * kHalf));
  for (int axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<std::size_t>(axis);
    expect_distances(
        *capsules[i],
        {{along(axis, 0.5, 0), 0.2}, {along(axis, -0.1, 0.3), 0.2}, {along(axis, -0.5, 0.4), 0.4}});
    expect_distances(
        *cylinders[i],
        {{along(axis, 0.5, 0), 0.3}, {along(axis, 0.1, 0.3), 0.2}, {along(axis, -0.5, 0.5), 0.5}});
    expect_distances(*cones[i], {{along(axis, 0.5, 0), 0.3},
                                 {along(axis, -0.5, 0), 0.3},
                                 {along(axis, 0.2, 0.1), slant},
                                 {along(axis, -0.5, 0.5), 0.5}});
    // Bullet's own algorithms add the margin to a cone, and to none of the others.
    EXPECT_EQ(Placed(*cones[i]).side.thickness(), static_cast<double>(cone_x.getMargin()));
    EXPECT_EQ(Placed(*cylinders[i]).side.thickness(), 0.0);
  }
}

TEST(Side, KnowsWhatItIsThinnestAtAndWhatIsTooSmallToSee) {
  const btBoxShape box(to_bullet(Vec3{0.1, 0.2, 0.3}));
  const double around = 2.0 * std::sqrt(0.14);
  EXPECT_NEAR(Placed(box).side.thinnest(), 0.2, kTolerance);
  EXPECT_NEAR(Placed(box).side.detail(),
              std::min(kDetailOfInnerDiameter * 0.2, kDetailOfSize * around), kTolerance);
  const btBoxShape plate(to_bullet(Vec3{0.01, 0.2, 0.3}));
  EXPECT_NEAR(Placed(plate).side.detail(), kDetailOfInnerDiameter * 0.02, kTolerance);
  const btStaticPlaneShape plane(btVector3(0, 0, 1), 0);
  EXPECT_EQ(Placed(plane).side.thinnest(), kInfinity);

  const ModelShape cube(cube_model());
  EXPECT_NEAR(Placed(cube).side.detail(), kDetailOfSize * 2 * kCubeHalf, kTolerance);
  const ModelShape sheet(build_model(voxshell::test_support::make_box({0.3, 0.3, 0.005}), 0.005));
  EXPECT_NEAR(Placed(sheet).side.detail(), kDetailOfThickness * 0.01, 1e-4);

  // A corner of a cube at the origin, whose middle is not: a margin makes it thicker all around.
  btConvexHullShape corner;
  for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{0.4, 0, 0}, Vec3{0, 0.4, 0}, Vec3{0, 0, 0.4}}) {
    corner.addPoint(to_bullet(p));
  }
  corner.setMargin(scalar(0.02));
  const auto hull = Hull::create(Hull::points_of(corner));
  ASSERT_TRUE(hull);
  const Placed placed(corner, {}, &*hull);
  EXPECT_LT(length(placed.side.middle() - Vec3{0.1, 0.1, 0.1}), 1e-5);
  EXPECT_NEAR(placed.side.thinnest(), 2.0 * (0.1 / std::sqrt(3.0) + 0.02), 1e-5);
}

TEST(Side, PutsAModelWhereItsShapeSays) {
  Random random(5);
  const Pose body_from_model = random.pose(0.5);
  const Pose world_from_body = random.pose(2.0);
  const ModelShape shape(ball_model(), body_from_model);
  const Placed placed(shape, world_from_body);
  const Vec3 center = world_from_body.transform_point(body_from_model.translation);
  EXPECT_LT(length(placed.side.world_from_geometry().translation - center), kTolerance);
  EXPECT_LT(length(placed.side.bounding_ball().center - center), 1e-4);
  EXPECT_NEAR(placed.side.bounding_ball().radius, kBallRadius, 1e-3);
  EXPECT_NEAR(placed.distance_at(center + 0.2 * random.direction()), 0.2 - kBallRadius, 1e-3);
}

TEST(Side, HasTheKeyOfItsGeometryAlone) {
  const btBoxShape box(btVector3(1, 2, 3));
  const btBoxShape same(btVector3(1, 2, 3));
  const btBoxShape other(btVector3(1, 2, 4));
  const Pose elsewhere{{}, {1, 2, 3}};
  EXPECT_EQ(Placed(box).side.key(), Placed(same, elsewhere).side.key());
  EXPECT_NE(Placed(box).side.key(), Placed(other).side.key());
  // Of the same dimensions, but another kind.
  const btCapsuleShape capsule(1, 2);
  const btCylinderShape cylinder(btVector3(1, 1, 1));
  EXPECT_NE(Placed(capsule).side.key(), Placed(cylinder).side.key());
  const ModelShape cube(cube_model());
  const ModelShape cube_again(cube_model());
  const ModelShape ball(ball_model());
  EXPECT_EQ(Placed(cube).side.key(), Placed(cube_again).side.key());
  EXPECT_NE(Placed(cube).side.key(), Placed(ball).side.key());
  const btConvexHullShape any_hull;
  const std::vector<Vec3> corners{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const auto hull = Hull::create(corners);
  const auto other_hull = Hull::create(corners);
  ASSERT_TRUE(hull && other_hull);
  EXPECT_EQ(Placed(any_hull, {}, &*hull).side.key(),
            Placed(any_hull, elsewhere, &*hull).side.key());
  EXPECT_NE(Placed(any_hull, {}, &*hull).side.key(), Placed(any_hull, {}, &*other_hull).side.key());
}

TEST(PosedPair, HasAContactOnBothSurfacesInEitherOrder) {
  const Pose scene = Random(6).pose(1.0);
  const Vec3 up = scene.rotate({0, 0, 1});
  for (const double gap : {0.004, -0.004}) {
    TestWorld world;
    const Pose at = scene * Pose{{}, {0, 0, kBallRadius + gap}};
    const btRigidBody& ball = world.add_model(ball_model(), 1, at);
    const btRigidBody& plane =
        world.add(world.make<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0, scene);
    for (const bool ball_first : {true, false}) {
      const TwoBodies bodies(ball_first ? ball : plane, ball_first ? plane : ball);
      ASSERT_EQ(bodies.pair.shell_is_a, ball_first);
      const std::vector<Contact> near = bodies.near(0.02);
      ASSERT_FALSE(near.empty());
      for (const Contact& contact : near) {
        const WorldContact found = bodies.pair.to_world(contact);
        const Vec3& on_ball = ball_first ? found.point_a : found.point_b;
        const Vec3& on_plane = ball_first ? found.point_b : found.point_a;
        EXPECT_LT(length(found.normal - (ball_first ? up : -up)), kTolerance);
        EXPECT_NEAR(dot(on_plane - scene.translation, up), 0.0, kTolerance);
        EXPECT_NEAR(found.depth, -dot(on_ball - scene.translation, up), kTolerance);
        EXPECT_LT(length(on_ball - on_plane + found.depth * up), kTolerance);
        EXPECT_NEAR(length(on_ball - at.translation), kBallRadius, 1e-3);
      }
    }
  }
}

/// A cube stands over a ground that Bullet's margin makes higher: where both end, its bottom is
/// above the ground's own surface, and below the one that counts.
TEST(PosedPair, CountsTheMarginsOfBulletsShapes) {
  constexpr double kMargin = 0.01;
  constexpr double kGap = 0.004;
  TestWorld world;
  const btRigidBody& cube = world.add_model(cube_model(), 1, {{}, {0, 0, kCubeHalf + kGap}});
  auto& block = world.make<btConvexHullShape>();
  for (int corner = 0; corner < 8; ++corner) {
    block.addPoint(
        to_bullet(Vec3{corner & 1 ? 0.3 : -0.3, corner & 2 ? 0.3 : -0.3, corner & 4 ? 0.0 : -0.2}));
  }
  const auto hull = Hull::create(Hull::points_of(block));
  ASSERT_TRUE(hull);
  btTriangleMesh triangles;
  triangles.addTriangle({-2, -2, 0}, {2, -2, 0}, {0, 3, 0});
  auto& mesh = world.make<btBvhTriangleMeshShape>(&triangles, true);
  for (btCollisionShape* shape :
       {static_cast<btCollisionShape*>(&block), static_cast<btCollisionShape*>(&mesh)}) {
    shape->setMargin(scalar(kMargin));
    const btRigidBody& ground = world.add(*shape, 0);
    const btCollisionObjectWrapper of_cube = wrap_object(cube);
    const btCollisionObjectWrapper of_ground = wrap_object(ground);
    const PosedPair pair(of_cube, of_ground, &*hull, ShellRule::kAutomatic);
    const bool has_triangles = shape == &mesh;
    ASSERT_EQ(pair.has_triangles(), has_triangles);
    // In the frame of the cube, or of the mesh, which is the shell; of a normal that is too long.
    const Contact contact =
        has_triangles ? Contact{0, static_cast<float>(-kGap), {0, 0, 0}, {0, 0, -1.001f}}
                      : Contact{0, static_cast<float>(-kGap), {0, 0, -0.1f}, {0, 0, 1.001f}};
    const WorldContact found = pair.to_world(contact);
    EXPECT_NEAR(found.depth, kMargin - kGap, kTolerance);
    EXPECT_LT(length(found.point_a - Vec3{0, 0, kGap}), kTolerance);
    EXPECT_LT(length(found.point_b - Vec3{0, 0, kMargin}), kTolerance);
    EXPECT_LT(length(found.normal - Vec3{0, 0, 1}), 1e-12);
  }
}

TEST(PosedPair, TakesTheModelWithFewerPointsForTheShellUntilItIsEnclosed) {
  static const auto fine_ball = build_model(voxshell::test_support::make_icosphere(0.02, 3), 0.001);
  ASSERT_GT(fine_ball->shell().size(), cube_model()->shell().size());
  for (const bool is_inside : {true, false}) {
    for (const bool ball_first : {true, false}) {
      TestWorld world;
      const btRigidBody& cube = world.add_model(cube_model(), 1);
      const btRigidBody& ball =
          world.add_model(fine_ball, 1, {{}, {is_inside ? 0.05 : 0.15, 0, 0}});
      TwoBodies bodies(ball_first ? ball : cube, ball_first ? cube : ball, ShellRule::kFewest);
      EXPECT_FALSE(bodies.pair.asks_both);
      EXPECT_EQ(bodies.pair.shell_side().model(), cube_model().get());
      EXPECT_EQ(bodies.pair.swap_roles_if_enclosed(), is_inside);
      EXPECT_EQ(bodies.pair.shell_side().model(), is_inside ? fine_ball.get() : cube_model().get());
    }
  }
}

}  // namespace
}  // namespace voxshell::bullet::posed_pair_test
