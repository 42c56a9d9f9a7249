#include "voxshell/bullet/model_shape.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/random.h"
#include "support/world.h"

namespace voxshell::bullet::model_shape_test {
namespace {

using namespace test_support;
using voxshell::test_support::make_box;
using voxshell::test_support::Random;

// A shape whose id equals Bullet's SDF type is cast to Bullet's SDF class and crashes.
TEST(ModelShape, IsConcaveButOfNoTypeThatBulletCasts) {
  const ModelShape shape(cube_model());
  EXPECT_NE(shape.getShapeType(), SDF_SHAPE_PROXYTYPE);
  EXPECT_NE(shape.getShapeType(), CUSTOM_CONCAVE_SHAPE_TYPE);
  EXPECT_EQ(shape.getShapeType(), FAST_CONCAVE_MESH_PROXYTYPE);
  EXPECT_TRUE(shape.isConcave());
  EXPECT_FALSE(shape.isConvex());
  EXPECT_FALSE(shape.isCompound());
  EXPECT_FALSE(shape.isInfinite());
}

TEST(ModelShape, BoundsEncloseTheVerticesWhereverTheBodyIs) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Pose body_from_model = random.pose(0.5);
    const Pose world_from_body = random.pose(2.0);
    const ModelShape shape(blob_model(), body_from_model);
    btVector3 lower;
    btVector3 upper;
    shape.getAabb(to_bullet(world_from_body), lower, upper);
    const Pose world_from_model = world_from_body * body_from_model;
    for (const Vec3& v : blob_model()->mesh().vertices()) {
      const Vec3 p = world_from_model.transform_point(v);
      for (int axis = 0; axis < 3; ++axis) {
        ASSERT_GE(p[axis], static_cast<double>(lower[axis]) - 5e-7);
        ASSERT_LE(p[axis], static_cast<double>(upper[axis]) + 5e-7);
      }
    }
  }
}

TEST(ModelShape, BoundsOfABoxAreTight) {
  static const auto model = build_model(make_box({0.1, 0.06, 0.03}), 0.01);
  Random random(2);
  for (int i = 0; i < 200; ++i) {
    const Pose body_from_model = random.pose(0.5);
    const Pose world_from_body = random.pose(2.0);
    const ModelShape shape(model, body_from_model);
    btVector3 lower;
    btVector3 upper;
    shape.getAabb(to_bullet(world_from_body), lower, upper);
    Bounds exact;
    for (const Vec3& v : model->mesh().vertices()) {
      exact.extend((world_from_body * body_from_model).transform_point(v));
    }
    // The slack is the default contact margin, a thousandth of the diameter.
    const double slack = 2.5e-4;
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(static_cast<double>(lower[axis]), exact.lower[axis], slack);
      EXPECT_NEAR(static_cast<double>(upper[axis]), exact.upper[axis], slack);
    }
  }
}

TEST(ModelShape, BoundsOfRoundBodiesAreNoLargerThanTheirSpheres) {
  Random random(5);
  for (const auto& model : {ball_model(), torus_model()}) {
    double radius = 0.0;
    for (const Vec3& v : model->mesh().vertices()) radius = std::max(radius, length(v));
    for (int i = 0; i < 200; ++i) {
      const Pose body_from_model = random.pose(0.5);
      const Pose world_from_model = random.pose(2.0) * body_from_model;
      const ModelShape shape(model, body_from_model);
      btVector3 lower;
      btVector3 upper;
      shape.getAabb(to_bullet(world_from_model * body_from_model.inverse()), lower, upper);
      Bounds exact;
      for (const Vec3& v : model->mesh().vertices()) {
        exact.extend(world_from_model.transform_point(v));
      }
      for (int axis = 0; axis < 3; ++axis) {
        const auto low = static_cast<double>(lower[axis]);
        const auto high = static_cast<double>(upper[axis]);
        ASSERT_LE(low, exact.lower[axis] + 5e-7);
        ASSERT_GE(high, exact.upper[axis] - 5e-7);
        ASSERT_LT(high - low, 2.02 * radius);
      }
    }
  }
}

TEST(ModelShape, SetMarginGrowsTheBounds) {
  ModelShape shape(cube_model());
  btVector3 lower;
  btVector3 upper;
  btVector3 wider_lower;
  btVector3 wider_upper;
  shape.getAabb(btTransform::getIdentity(), lower, upper);
  shape.setMargin(scalar(0.01));
  shape.getAabb(btTransform::getIdentity(), wider_lower, wider_upper);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(lower[axis] - wider_lower[axis], 0.01, 1e-6);
    EXPECT_NEAR(wider_upper[axis] - upper[axis], 0.01, 1e-6);
  }
}

TEST(ModelShape, InertiaOfABoxIsTheClosedForm) {
  const Vec3 h{0.1, 0.06, 0.03};
  const ModelShape shape(build_model(make_box(h), 0.01));
  btVector3 inertia;
  shape.calculateLocalInertia(scalar(3), inertia);
  EXPECT_NEAR(inertia.x(), 3.0 / 3 * (h.y * h.y + h.z * h.z), 1e-7);
  EXPECT_NEAR(inertia.y(), 3.0 / 3 * (h.x * h.x + h.z * h.z), 1e-7);
  EXPECT_NEAR(inertia.z(), 3.0 / 3 * (h.x * h.x + h.y * h.y), 1e-7);
}

TEST(ModelShape, InertiaIsThatOfTheBodysAxes) {
  const Vec3 h{0.1, 0.06, 0.03};
  const Pose turned{{{0, -1, 0}, {1, 0, 0}, {0, 0, 1}}, {5, 6, 7}};  // x and y change places
  const ModelShape shape(build_model(make_box(h), 0.01), turned);
  btVector3 inertia;
  shape.calculateLocalInertia(scalar(3), inertia);
  EXPECT_NEAR(inertia.x(), h.x * h.x + h.z * h.z, 1e-7);
  EXPECT_NEAR(inertia.y(), h.y * h.y + h.z * h.z, 1e-7);
}

TEST(ModelShape, RefusesToBeScaledOrSerialized) {
  ModelShape shape(cube_model());
  shape.setLocalScaling(btVector3(1, 1, 1));
  EXPECT_THROW(shape.setLocalScaling(btVector3(2, 2, 2)), std::logic_error);
  EXPECT_EQ(shape.getLocalScaling(), btVector3(1, 1, 1));
  EXPECT_THROW(static_cast<void>(shape.calculateSerializeBufferSize()), std::logic_error);
  btCompoundShape compound;
  compound.addChildShape(btTransform::getIdentity(), &shape);
  EXPECT_THROW(compound.setLocalScaling(btVector3(2, 2, 2)), std::logic_error);
}

class Triangles : public btTriangleCallback {
 public:
  void processTriangle(btVector3* corners, int part, int index) override {
    EXPECT_EQ(part, 0);
    indices.insert(index);
    const btVector3 up = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    outwards = outwards && up.dot(corners[0] - center) > 0;
    ++calls;
  }

  btVector3 center{0, 0, 0};
  std::set<int> indices;
  int calls = 0;
  bool outwards = true;
};

TEST(ModelShape, PassesEachTriangleOnceFacingOutwards) {
  const Pose body_from_model = Random(3).pose(0.5);
  const ModelShape shape(ball_model(), body_from_model);
  const int count = static_cast<int>(ball_model()->mesh().triangles().size());
  for (const double reach : {1.0, 1e18}) {
    Triangles all;
    all.center = to_bullet(body_from_model.translation);
    shape.processAllTriangles(&all, to_bullet(Vec3{-reach, -reach, -reach}),
                              to_bullet(Vec3{reach, reach, reach}));
    EXPECT_EQ(all.calls, count);
    EXPECT_EQ(static_cast<int>(all.indices.size()), count);
    EXPECT_TRUE(all.outwards);
  }
}

TEST(ModelShape, PassesNoFewerTrianglesThanTouchTheBox) {
  Random random(4);
  const TriangleMesh& mesh = ball_model()->mesh();
  std::size_t passed = 0;
  std::size_t wanted = 0;
  for (int i = 0; i < 50; ++i) {
    const Pose body_from_model = random.pose(0.5);
    const ModelShape shape(ball_model(), body_from_model);
    const Vec3 center = body_from_model.translation + kBallRadius * random.direction();
    const Vec3 half{0.02, 0.02, 0.02};
    Triangles some;
    shape.processAllTriangles(&some, to_bullet(center - half), to_bullet(center + half));
    passed += some.indices.size();
    for (std::size_t t = 0; t < mesh.triangles().size(); ++t) {
      const auto corners = mesh.corners(t);
      const Vec3 middle =
          body_from_model.transform_point((1.0 / 3.0) * (corners[0] + corners[1] + corners[2]));
      const auto within = [&](int axis) {
        return std::abs(middle[axis] - center[axis]) < half[axis];
      };
      if (!within(0) || !within(1) || !within(2)) continue;
      ++wanted;
      EXPECT_TRUE(some.indices.contains(static_cast<int>(t)));
    }
  }
  EXPECT_GT(wanted, 100u);
  EXPECT_LT(passed, 50 * mesh.triangles().size() / 4);  // it does select
}

TEST(ModelShape, ABoxBesideItTouchesNoTriangle) {
  const ModelShape shape(ball_model());
  Triangles none;
  shape.processAllTriangles(&none, btVector3(1, 1, 1), btVector3(2, 2, 2));
  EXPECT_EQ(none.calls, 0);
}

}  // namespace
}  // namespace voxshell::bullet::model_shape_test
