#include "voxshell/ambiguity.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <variant>

#include <gtest/gtest.h>

#include "base/text.h"
#include "support/meshes.h"
#include "support/random.h"
#include "voxshell/model.h"

namespace voxshell::ambiguity_test {
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

constexpr double kHalf = 0.0005;  // of a plate's thickness, meters

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

// Deep inside, samples round off the ridge where two faces are equally near. A contact that is not
// marked there leads to the surface, by the normal of a face.
TEST(Ambiguity, IsWhereTheNormalLeadsBesideTheSurface) {
  const double half = 0.02;
  auto cube = Model::build(make_box({half, half, half}).mesh(), {.tolerance = 2e-5, .threads = 1});
  ASSERT_TRUE(cube);
  const Field& field = (*cube)->field();
  const double voxel_size = std::get<GridField>(field).voxel_size();
  Random random(41);
  std::size_t marked = 0;
  std::size_t wrong = 0;
  constexpr std::size_t kPlaces = 4'000;
  for (std::size_t i = 0; i < kPlaces; ++i) {
    const double depth = random.uniform(2.0 * voxel_size, 0.5 * half);
    const double beside = random.uniform(-2.0, 2.0) * voxel_size;
    const Vec3 place{half - depth, half - depth - beside, random.uniform(-0.3, 0.3) * half};
    const Contact contact = contact_at(field, Pose{}, place);
    const Vec3 reached =
        place + static_cast<double>(contact.depth) * static_cast<Vec3>(contact.normal);
    const double off = std::abs(std::max(reached.x, reached.y) - half);
    const auto normal = static_cast<Vec3>(contact.normal);
    const bool is_wrong =
        off > 0.3 * voxel_size || std::max(normal.x, normal.y) < 0.98;  // 11 degrees
    wrong += is_wrong ? 1 : 0;
    if (is_ambiguous(contact, field, Pose{})) {
      ++marked;
    } else {
      EXPECT_FALSE(is_wrong) << format_point(place) << " reaches " << format_point(reached);
    }
  }
  EXPECT_GT(wrong, kPlaces / 20) << "the test asks for nothing";
  EXPECT_LT(marked, kPlaces / 2);
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
}  // namespace voxshell::ambiguity_test
