#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/random.h"
#include "voxshell/bullet/model_shape.h"

namespace voxshell::bullet::principal_frame_test {
namespace {

using voxshell::test_support::make_blob;
using voxshell::test_support::make_box;
using voxshell::test_support::make_corner_tetrahedron;
using voxshell::test_support::make_icosphere;
using voxshell::test_support::make_l_shape;
using voxshell::test_support::make_torus;
using voxshell::test_support::Random;
using voxshell::test_support::Soup;
using voxshell::test_support::transformed;

/// Right-handed, orthonormal, ascending moments, and the tensor diagonal in it.
void expect_principal(const BodyFrame& frame, const MassProperties& mass) {
  const Matrix3& m = frame.model_from_body.rotation;
  const Matrix3 unit = m * m.transposed();
  for (int i = 0; i < 3; ++i) {
    const Vec3 row = i == 0 ? unit.row_x : i == 1 ? unit.row_y : unit.row_z;
    for (int j = 0; j < 3; ++j) EXPECT_NEAR(row[j], i == j ? 1.0 : 0.0, 1e-12);
  }
  EXPECT_NEAR(dot(cross(m.row_x, m.row_y), m.row_z), 1.0, 1e-12);
  const Vec3 i = frame.principal_inertia;
  EXPECT_LE(i.x, i.y);
  EXPECT_LE(i.y, i.z);
  const Matrix3 d = m.transposed() * mass.inertia * m;
  const double scale = std::max(i.z, std::numeric_limits<double>::min());
  EXPECT_NEAR(d.row_x.x / scale, i.x / scale, 1e-12);
  EXPECT_NEAR(d.row_y.y / scale, i.y / scale, 1e-12);
  EXPECT_NEAR(d.row_z.z / scale, i.z / scale, 1e-12);
  EXPECT_NEAR(d.row_x.y / scale, 0.0, 1e-12);
  EXPECT_NEAR(d.row_x.z / scale, 0.0, 1e-12);
  EXPECT_NEAR(d.row_y.z / scale, 0.0, 1e-12);
  EXPECT_EQ(frame.model_from_body.translation, mass.center_of_mass);
}

TEST(PrincipalFrame, OfTurnedAndShiftedBodies) {
  Random random(5);
  const Soup soups[] = {
      make_box({0.3, 0.2, 0.1}),     make_box({0.2, 0.2, 0.1}), make_box({0.1, 0.1, 0.1}),
      make_icosphere(0.2, 2),        make_l_shape(0.1),         make_corner_tetrahedron(0.2),
      make_torus(0.2, 0.05, 24, 12), make_blob(0.1, 2)};
  for (const Soup& soup : soups) {
    for (int i = 0; i < 50; ++i) {
      const MassProperties mass =
          compute_solid_mass_properties(transformed(soup, random.pose(1.0)).mesh());
      expect_principal(compute_principal_frame(mass), mass);
    }
  }
}

TEST(PrincipalFrame, FindsTheMomentsAndCenterOfABox) {
  Random random(6);
  for (int i = 0; i < 50; ++i) {
    const Pose pose = random.pose(1.0);
    const MassProperties mass =
        compute_solid_mass_properties(transformed(make_box({0.3, 0.2, 0.1}), pose).mesh())
            .with_mass(2.0);
    const BodyFrame frame = compute_principal_frame(mass);
    EXPECT_NEAR(frame.principal_inertia.x, 2.0 / 3 * (0.04 + 0.01), 1e-12);
    EXPECT_NEAR(frame.principal_inertia.y, 2.0 / 3 * (0.09 + 0.01), 1e-12);
    EXPECT_NEAR(frame.principal_inertia.z, 2.0 / 3 * (0.09 + 0.04), 1e-12);
    EXPECT_LT(length(frame.model_from_body.translation - pose.translation), 1e-12);
  }
}

TEST(PrincipalFrame, OfTensorsByHand) {
  const Matrix3 tensors[] = {
      {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
      {{2, 1, 0}, {1, 2, 0}, {0, 0, 3}},                     // twice 3
      {{2, 0.5, 0.5}, {0.5, 2, 0.5}, {0.5, 0.5, 2}},         // twice 1.5
      {{3, 1e-13, 0}, {1e-13, 3, 1e-13}, {0, 1e-13, 3}},     // all but equal
      {{1e-9, 1e-12, 0}, {1e-12, 2e-9, 0}, {0, 0, 2.5e-9}},  // a pebble
      {{5e8, 1e8, 2e8}, {1e8, 6e8, 1e7}, {2e8, 1e7, 7e8}},   // a ship
      {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}},
  };
  for (const Matrix3& tensor : tensors) {
    const MassProperties mass{1.0, {0.1, 0.2, 0.3}, tensor};
    expect_principal(compute_principal_frame(mass), mass);
  }
}

}  // namespace
}  // namespace voxshell::bullet::principal_frame_test
