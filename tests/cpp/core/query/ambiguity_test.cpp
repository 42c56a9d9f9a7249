#include "voxshell/ambiguity.h"

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "voxshell/model.h"

namespace voxshell {
namespace {

using namespace test_support;

/// The contact of a place in the field, in a frame of its own.
Contact contact_at(const Field& field, const Pose& field_from_shell, const Vec3& place) {
  const Pose shell_from_field = field_from_shell.inverse();
  const auto at = static_cast<Vec3f>(place);
  return std::visit(
      [&](const auto& typed) {
        const auto normal = normalized(static_cast<Vec3>(typed.gradient(at)));
        return Contact{0, -typed.distance(at),
                       static_cast<Vec3f>(shell_from_field.transform_point(place)),
                       static_cast<Vec3f>(shell_from_field.rotate(normal))};
      },
      field);
}

bool is_ambiguous_at(const Field& field, const Vec3& place) {
  const Pose field_from_shell{{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}, {0.3, -0.2, 0.1}};
  return is_ambiguous(contact_at(field, field_from_shell, place), field, field_from_shell);
}

constexpr double kHalf = 0.0005;  // of a plate's thickness, metres

void expect_ambiguous_in_the_middle(const Field& plate) {
  for (const double depth : {0.0, 0.01, 0.3, 0.6, 0.85, 0.95, 0.99, 1.0}) {
    for (const double side : {-1.0, 1.0}) {
      const Vec3 place{0.02, -0.03, side * (1.0 - depth) * kHalf};
      EXPECT_EQ(is_ambiguous_at(plate, place), depth > 0.9) << depth << " on side " << side;
    }
  }
}

TEST(Ambiguity, IsInTheMiddleOfAWall) {
  expect_ambiguous_in_the_middle(BoxField{{0.1, 0.1, kHalf}});
}

TEST(Ambiguity, IsInTheMiddleOfAModelOfAWall) {
  auto plate = Model::build(make_box({0.1, 0.1, kHalf}).mesh(), {.tolerance = 1e-5, .threads = 1});
  ASSERT_TRUE(plate);
  expect_ambiguous_in_the_middle((*plate)->field());
}

TEST(Ambiguity, IsAtTheMiddleOfABallAndNowhereInAPlane) {
  const Field ball = SphereField{0.1};
  EXPECT_TRUE(is_ambiguous_at(ball, {0.004, 0.003, 0.0}));
  EXPECT_FALSE(is_ambiguous_at(ball, {0.012, 0.016, 0.0}));
  EXPECT_FALSE(is_ambiguous_at(PlaneField{}, {0.0, 0.0, -5.0}));
}

// Two faces are as near there, but meet at 90 degrees: depth does not depend on the choice.
TEST(Ambiguity, IsNotAlongASquareEdge) {
  const Field box = BoxField{{0.1, 0.1, 0.1}};
  for (const double depth : {1e-7, 1e-4, 0.01}) {
    EXPECT_FALSE(is_ambiguous_at(box, {0.1 - depth, 0.02, 0.1 - depth})) << depth;
  }
}

TEST(Ambiguity, IsNotOutside) {
  EXPECT_FALSE(is_ambiguous_at(BoxField{{0.1, 0.1, kHalf}}, {0.0, 0.0, 0.001}));
}

}  // namespace
}  // namespace voxshell
