#include "triangle_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include <BulletCollision/CollisionShapes/btBvhTriangleMeshShape.h>
#include <BulletCollision/CollisionShapes/btTriangleMesh.h>
#include <gtest/gtest.h>

#include "support/models.h"
#include "support/random.h"
#include "voxshell/bullet/convert.h"

namespace voxshell::bullet::triangle_contacts_test {
namespace {

using namespace test_support;
using voxshell::test_support::Random;

struct Corners {
  Vec3 a, b, c;
};

/// Triangles as a shape of Bullet's.
class Mesh {
 public:
  explicit Mesh(const std::vector<Corners>& triangles) {
    for (const auto& [a, b, c] : triangles) {
      data_.addTriangle(to_bullet(a), to_bullet(b), to_bullet(c));
    }
    shape_ = std::make_unique<btBvhTriangleMeshShape>(&data_, true);
  }

  std::vector<Contact> find(const Model& model, const Pose& mesh_from_model, int level,
                            float margin) const {
    TriangleContacts triangles;
    return triangles.find(*shape_, model, mesh_from_model.inverse(), level, margin);
  }
  const btConcaveShape& shape() const { return *shape_; }

 private:
  btTriangleMesh data_;
  std::unique_ptr<btBvhTriangleMeshShape> shape_;
};

/// One triangle in the plane z = 0, far larger than any model.
const Mesh& plane() {
  static const Mesh mesh({Corners{{-3, -3, 0}, {4, -3, 0}, {0, 5, 0}}});
  return mesh;
}

void expect_near(const Vec3f& found, const Vec3& expected, double tolerance) {
  EXPECT_LT(length(static_cast<Vec3>(found) - expected), tolerance)
      << found.x << ", " << found.y << ", " << found.z;
}

TEST(TriangleContacts, AreOneForEachCellThatIsReached) {
  constexpr double kDepth = 0.004;
  const Pose mesh_from_model{{}, {0.3, -0.2, kCubeHalf - kDepth}};
  for (const auto& [level, side] :
       {std::pair(1, 1), std::pair(2, 2), std::pair(4, 8), std::pair(5, 16), std::pair(9, 16)}) {
    SCOPED_TRACE(level);
    const std::vector<Contact> found = plane().find(*cube_model(), mesh_from_model, level, 0.0f);
    // The lowest layer of the cube's cells. Pieces are of the cell that their middle is in.
    ASSERT_EQ(found.size(), static_cast<std::size_t>(side * side));
    const double size = 2 * kCubeHalf / side;
    const auto spacing = static_cast<double>(TriangleContacts::sample_spacing(*cube_model()));
    for (int i = 0; i < side * side; ++i) {
      const Contact& contact = found[static_cast<std::size_t>(i)];
      EXPECT_EQ(contact.id, static_cast<std::uint32_t>(i));
      EXPECT_NEAR(contact.depth, kDepth, side <= 8 ? 1e-5 : 1e-3);
      expect_near(contact.normal, {0, 0, -1}, 1e-6);
      const Vec3 place = static_cast<Vec3>(contact.point) - Vec3{0.3, -0.2, 0.0};
      EXPECT_NEAR(place.x, -kCubeHalf + (i % side + 0.5) * size, 0.5 * size + spacing);
      EXPECT_NEAR(place.y, -kCubeHalf + (i / side + 0.5) * size, 0.5 * size + spacing);
      EXPECT_NEAR(place.z, 0.0, 1e-6);
    }
  }
}

TEST(TriangleContacts, AreWhereThePlaneIsNearestToABall) {
  Random random(1);
  for (int i = 0; i < 20; ++i) {
    const double height = (i % 2 == 0 ? 1.0 : -1.0) * random.uniform(0.08, 0.11);
    const Pose mesh_from_model{random.rotation(), {0.2, 0.1, height}};
    const std::vector<Contact> found = plane().find(*ball_model(), mesh_from_model, 1, 0.02f);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].depth, kBallRadius - std::abs(height), 5e-4);
    expect_near(found[0].point, {0.2, 0.1, 0.0}, 4e-3);
    // Out of the ball, on whichever side of the plane that is.
    expect_near(found[0].normal, {0, 0, height > 0.0 ? -1.0 : 1.0}, 1e-6);
  }
}

TEST(TriangleContacts, OfEdgesAndCornersHaveTheNormalsOfTheField) {
  Random random(2);
  for (int i = 0; i < 20; ++i) {
    const Pose pose = random.pose(0.3);
    const double distance = random.uniform(0.07, 0.095);
    // It points at the ball's center from the side, and lies aslant in the plane beyond.
    const Vec3 tip = pose.transform_point({distance, 0, 0});
    const auto at = [&](double x, double y, double z) { return pose.transform_point({x, y, z}); };
    const Mesh corner({Corners{tip, at(1, 0.3, 0.4), at(1, -0.3, 0.4)}});
    const Mesh edge({Corners{at(distance, 0.6, 0), at(distance, -0.6, 0), at(1, 0, 0.9)}});
    for (const Mesh* mesh : {&corner, &edge}) {
      const auto found = mesh->find(*ball_model(), {random.rotation(), pose.translation}, 1, 0.0f);
      ASSERT_EQ(found.size(), 1u);
      EXPECT_NEAR(found[0].depth, kBallRadius - distance, 1e-3);
      expect_near(found[0].point, tip, mesh == &corner ? 1e-6 : 2e-3);
      expect_near(found[0].normal, pose.rotate({1, 0, 0}), 0.1);
    }
  }
}

/// An edge of a cube cuts into a triangle. The faces beside it are 45 degrees off.
TEST(TriangleContacts, HaveTheNormalOfTheTriangleThatAnEdgeCuts) {
  constexpr double kDepth = 0.005;
  static const auto cube = build_by_tolerance({kCubeHalf, kCubeHalf, kCubeHalf});
  const double s = std::sqrt(0.5);
  const Pose mesh_from_model{{{s, 0, s}, {0, 1, 0}, {-s, 0, s}}, {0, 0, kCubeHalf / s - kDepth}};
  const std::vector<Contact> found = plane().find(*cube, mesh_from_model, 1, 0.0f);
  ASSERT_EQ(found.size(), 1u);
  expect_near(found[0].normal, {0, 0, -1}, 1e-6);
  EXPECT_NEAR(found[0].depth, s * kDepth, 3e-4);
  EXPECT_NEAR(found[0].point.x, 0.0f, 5e-4f);
}

TEST(TriangleContacts, AreFoundUpToTheMargin) {
  constexpr double kGap = 0.003;
  const Pose mesh_from_model{{}, {0, 0, kCubeHalf + kGap}};
  for (const Contact& contact : plane().find(*cube_model(), mesh_from_model, 3, 0.0031f)) {
    EXPECT_NEAR(contact.depth, -kGap, 1e-5);
  }
  EXPECT_EQ(plane().find(*cube_model(), mesh_from_model, 3, 0.0031f).size(), 16u);
  EXPECT_TRUE(plane().find(*cube_model(), mesh_from_model, 3, 0.0029f).empty());
  TriangleContacts triangles;
  const Pose model_from_mesh = mesh_from_model.inverse();
  triangles.gather(plane().shape(), *cube_model(), model_from_mesh, 0.01f);
  EXPECT_NEAR(triangles.distance(*cube_model(), model_from_mesh, 0.01f), kGap, 1e-5);
  EXPECT_EQ(triangles.distance(*cube_model(), model_from_mesh, 0.0029f),
            std::numeric_limits<double>::infinity());
}

/// A ball above a plane. The depth of a cell's place is minus its distance from the ball. If the
/// cells are to touch as planes do, it is minus the height of the ball's surface above the place.
TEST(TriangleContacts, ThatAreApartAreThoseOfPlanes) {
  constexpr double kHeight = 0.11;
  const Pose model_from_mesh = Pose{{}, {0, 0, kHeight}}.inverse();
  TriangleContacts triangles;
  triangles.gather(plane().shape(), *ball_model(), model_from_mesh, 0.05f);
  for (const bool as_planes : {true, false}) {
    const float apart = as_planes ? 0.0f : 1.0f;
    const std::vector<Contact> found =
        triangles.find(*ball_model(), model_from_mesh, 3, 0.05f, apart);
    ASSERT_EQ(found.size(), 16u);
    double farthest = 0.0;
    for (const Contact& contact : found) {
      const auto place = static_cast<Vec3>(contact.point);
      const double aside = std::hypot(place.x, place.y);
      farthest = std::max(farthest, aside);
      const double surface = std::sqrt(kBallRadius * kBallRadius - aside * aside);
      const double gap = as_planes ? kHeight - surface : std::hypot(aside, kHeight) - kBallRadius;
      EXPECT_NEAR(contact.depth, -gap, 1e-3);
      EXPECT_NEAR(place.z, 0.0, 1e-3);
      expect_near(contact.normal, {0, 0, -1}, 1e-6);
    }
    EXPECT_GT(farthest, 0.04);  // where both differ by several millimeters
  }
}

TEST(TriangleContacts, OfTrianglesWithoutAreaAreThoseOfTheirPlaces) {
  const Pose mesh_from_model{{}, {0, 0, kCubeHalf - 0.004}};
  const Mesh segment({Corners{{-1, 0, 0}, {1, 0, 0}, {1, 0, 0}}});
  const Mesh place({Corners{{0.02, 0.01, 0}, {0.02, 0.01, 0}, {0.02, 0.01, 0}}});
  for (const Mesh* mesh : {&segment, &place}) {
    const auto found = mesh->find(*cube_model(), mesh_from_model, 1, 0.0f);
    ASSERT_EQ(found.size(), 1u);
    EXPECT_NEAR(found[0].depth, 0.004, 1e-5);
    expect_near(found[0].normal, {0, 0, -1}, 1e-4);
    if (mesh == &place) expect_near(found[0].point, {0.02, 0.01, 0}, 1e-6);
  }
}

TEST(TriangleContacts, OfOneLookUpServePosesAMarginAway) {
  constexpr float kMargin = 0.05f;
  const Mesh floor_and_wall({Corners{{-3, -3, 0}, {4, -3, 0}, {0, 5, 0}},
                             Corners{{0.145, -3, -3}, {0.145, 4, -3}, {0.145, 0, 5}}});
  const Pose start{{}, {0, 0, kCubeHalf + 0.04}};
  TriangleContacts triangles;
  triangles.gather(floor_and_wall.shape(), *cube_model(), start.inverse(), kMargin);
  for (const Vec3& way : {Vec3{0.0, 0, 0.005}, Vec3{0.03, 0, -0.025}}) {
    Pose moved = start;
    moved.translation = moved.translation + way;
    const auto found = triangles.find(*cube_model(), moved.inverse(), 3, 0.02f);
    EXPECT_TRUE(found == floor_and_wall.find(*cube_model(), moved, 3, 0.02f));
    EXPECT_EQ(found.empty(), way.x == 0.0);
  }
}

TEST(TriangleContacts, SampleByTheVoxelOrThirtyTwoTimesASide) {
  EXPECT_FLOAT_EQ(TriangleContacts::sample_spacing(*cube_model()), 0.01f);
  const auto fine = build_model(voxshell::test_support::make_box({0.16, 0.1, 0.1}), 0.005);
  EXPECT_FLOAT_EQ(TriangleContacts::sample_spacing(*fine), 0.01f);
}

}  // namespace
}  // namespace voxshell::bullet::triangle_contacts_test
