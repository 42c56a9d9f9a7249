#include "voxshell/mass_properties.h"

#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "support/random.h"

namespace voxshell::mass_properties_test {
namespace {

using namespace test_support;

void expect_near(const Vec3& a, const Vec3& b, double tolerance) {
  EXPECT_LE(length(a - b), tolerance) << "(" << a.x << ", " << a.y << ", " << a.z << ") and ("
                                      << b.x << ", " << b.y << ", " << b.z << ")";
}

void expect_near(const Matrix3& a, const Matrix3& b, double tolerance) {
  expect_near(a.row_x, b.row_x, tolerance);
  expect_near(a.row_y, b.row_y, tolerance);
  expect_near(a.row_z, b.row_z, tolerance);
}

Matrix3 diagonal(double x, double y, double z) { return {{x, 0, 0}, {0, y, 0}, {0, 0, z}}; }

using Compute = std::function<MassProperties(const TriangleMesh&)>;

TEST(SolidMassProperties, OfABox) {
  const double a = 0.2;
  const double b = 0.4;
  const double c = 0.6;
  const MassProperties box = compute_solid_mass_properties(make_box({a / 2, b / 2, c / 2}).mesh());
  EXPECT_EQ(box.mass, 1.0);
  expect_near(box.center_of_mass, {}, 1e-16);
  expect_near(box.inertia,
              diagonal((b * b + c * c) / 12, (a * a + c * c) / 12, (a * a + b * b) / 12), 1e-16);
}

TEST(SolidMassProperties, OfACubesCorner) {
  // Density 6 on the simplex of unit legs: mean x is 1/4, of x^2 1/10 and of x y 1/20.
  const MassProperties corner = compute_solid_mass_properties(make_corner_tetrahedron(1).mesh());
  expect_near(corner.center_of_mass, {0.25, 0.25, 0.25}, 1e-15);
  const double about_axis = 2.0 * (0.1 - 0.0625);
  const double product = 0.05 - 0.0625;
  expect_near(corner.inertia,
              Matrix3{{about_axis, -product, -product},
                      {-product, about_axis, -product},
                      {-product, -product, about_axis}},
              1e-15);
}

TEST(SolidMassProperties, OfAnLShapeByItsThreeCubes) {
  const double s = 0.1;
  const MassProperties l_shape = compute_solid_mass_properties(make_l_shape(s).mesh());
  const Vec3 center{5 * s / 6, 5 * s / 6, s / 2};
  expect_near(l_shape.center_of_mass, center, 1e-16);
  Matrix3 expected = diagonal(s * s / 6, s * s / 6, s * s / 6);
  for (const Vec3& cube :
       {Vec3{s / 2, s / 2, s / 2}, Vec3{3 * s / 2, s / 2, s / 2}, Vec3{s / 2, 3 * s / 2, s / 2}}) {
    const Vec3 d = cube - center;
    expected.row_x += Vec3{d.y * d.y, -d.x * d.y, 0} / 3.0;
    expected.row_y += Vec3{-d.x * d.y, d.x * d.x, 0} / 3.0;
    expected.row_z += Vec3{0, 0, d.x * d.x + d.y * d.y} / 3.0;
  }
  expect_near(l_shape.inertia, expected, 1e-16);
}

TEST(SolidMassProperties, OfSpheresApproachTheBallAsTheyAreRefined) {
  const double radius = 0.3;
  const double ball = 0.4 * radius * radius;
  double last_error = 1.0;
  for (int subdivisions = 1; subdivisions <= 4; ++subdivisions) {
    const MassProperties sphere =
        compute_solid_mass_properties(make_icosphere(radius, subdivisions).mesh());
    expect_near(sphere.center_of_mass, {}, 1e-15);
    const double error = ball - sphere.inertia.row_x.x;
    EXPECT_GT(error, 0.0);
    EXPECT_LT(error, last_error / 3.0);
    last_error = error;
    expect_near(sphere.inertia, diagonal(ball, ball, ball), 2.0 * error);
  }
  EXPECT_LT(last_error, 0.01 * ball);
}

TEST(SolidMassProperties, OfAHollowBoxSubtractsTheCavity) {
  const TriangleMesh hollow =
      together(make_box({0.5, 0.5, 0.5}), inverted(make_box({0.25, 0.25, 0.25}))).mesh();
  const double volume = 1.0 - 0.125;
  const double about_axis = (1.0 / 6.0 - 0.125 * 0.25 / 6.0) / volume;
  expect_near(compute_solid_mass_properties(hollow).inertia,
              diagonal(about_axis, about_axis, about_axis), 1e-15);
}

TEST(SurfaceMassProperties, OfABoxByItsSixPlates) {
  const double a = 0.2;
  const double b = 0.4;
  const double c = 0.6;
  const MassProperties box =
      compute_surface_mass_properties(make_box({a / 2, b / 2, c / 2}).mesh());
  // Mean squares of the coordinates over the pairs of plates.
  const double area_x = 2 * b * c;
  const double area_y = 2 * c * a;
  const double area_z = 2 * a * b;
  const double area = area_x + area_y + area_z;
  const double xx = (area_x * a * a / 4 + (area_y + area_z) * a * a / 12) / area;
  const double yy = (area_y * b * b / 4 + (area_z + area_x) * b * b / 12) / area;
  const double zz = (area_z * c * c / 4 + (area_x + area_y) * c * c / 12) / area;
  EXPECT_EQ(box.mass, 1.0);
  expect_near(box.center_of_mass, {}, 1e-16);
  expect_near(box.inertia, diagonal(yy + zz, zz + xx, xx + yy), 1e-16);
}

TEST(SurfaceMassProperties, OfACubesCornerByItsFourFaces) {
  const MassProperties corner = compute_surface_mass_properties(make_corner_tetrahedron(1).mesh());
  // Three legs' faces of area 1/2 (two of which hold a coordinate's mean of 1/3), and the slanted
  // one of sqrt(3)/2.
  const double slanted = std::sqrt(3.0) / 2.0;
  const double area = 1.5 + slanted;
  const double mean = (2 * 0.5 / 3.0 + slanted / 3.0) / area;
  const double square = (2 * 0.5 / 6.0 + slanted / 6.0) / area;
  const double product = (0.5 / 12.0 + slanted / 12.0) / area;
  expect_near(corner.center_of_mass, {mean, mean, mean}, 1e-15);
  const double about_axis = 2 * (square - mean * mean);
  const double off = -(product - mean * mean);
  expect_near(corner.inertia,
              Matrix3{{about_axis, off, off}, {off, about_axis, off}, {off, off, about_axis}},
              1e-15);
}

TEST(SurfaceMassProperties, OfSpheresApproachTheShellAsTheyAreRefined) {
  const double shell = 2.0 / 3.0;
  const MassProperties sphere = compute_surface_mass_properties(make_icosphere(1, 4).mesh());
  expect_near(sphere.inertia, diagonal(shell, shell, shell), 0.01);
  EXPECT_LT(sphere.inertia.row_x.x, shell);
}

TEST(SurfaceMassProperties, DoNotDependOnTheOrientationOfTriangles) {
  Soup soup = make_blob(1, 2);
  const MassProperties before = compute_surface_mass_properties(soup.mesh());
  for (std::size_t i = 0; i < soup.triangles.size(); i += 3) {
    std::swap(soup.triangles[i][0], soup.triangles[i][1]);
  }
  expect_near(compute_surface_mass_properties(soup.mesh()).inertia, before.inertia, 1e-15);
}

TEST(MassProperties, FollowEveryRigidMotion) {
  Random random(10);
  const Soup soup = make_blob(0.2, 2);
  for (const Compute& compute :
       {Compute(compute_solid_mass_properties), Compute(compute_surface_mass_properties)}) {
    const MassProperties still = compute(soup.mesh());
    for (int i = 0; i < 50; ++i) {
      const Pose pose = random.pose(1.0);
      const MassProperties properties = compute(transformed(soup, pose).mesh());
      expect_near(properties.center_of_mass, pose.transform_point(still.center_of_mass), 1e-14);
      expect_near(properties.inertia, pose.rotation * still.inertia * pose.rotation.transposed(),
                  1e-15);
    }
  }
}

TEST(MassProperties, KeepTheirDigitsFarFromTheOrigin) {
  const Soup soup = make_box({0.1, 0.2, 0.3});
  for (const Compute& compute :
       {Compute(compute_solid_mass_properties), Compute(compute_surface_mass_properties)}) {
    const MassProperties near = compute(soup.mesh());
    const MassProperties far = compute(moved(soup, {1000, -2000, 3000}).mesh());
    expect_near(far.center_of_mass, {1000, -2000, 3000}, 1e-11);
    expect_near(far.inertia, near.inertia, 1e-12);
  }
}

TEST(MassProperties, GrowWithTheSquareOfTheSize) {
  const Soup soup = make_blob(0.2, 2);
  for (const Compute& compute :
       {Compute(compute_solid_mass_properties), Compute(compute_surface_mass_properties)}) {
    const MassProperties small = compute(soup.mesh());
    const MassProperties large = compute(scaled(soup, 10.0).mesh());
    expect_near(large.inertia.row_x, small.inertia.row_x * 100.0, 1e-14);
    expect_near(large.inertia.row_z, small.inertia.row_z * 100.0, 1e-14);
  }
}

TEST(MassProperties, OfAnotherMassScaleTheInertiaAndKeepTheCenter) {
  const MassProperties one = compute_solid_mass_properties(make_l_shape(0.1).mesh());
  const MassProperties many = one.with_mass(3.0).with_mass(2.5);
  EXPECT_EQ(many.mass, 2.5);
  EXPECT_EQ(many.center_of_mass, one.center_of_mass);
  expect_near(many.inertia.row_x, one.inertia.row_x * 2.5, 1e-17);
  expect_near(many.inertia.row_y, one.inertia.row_y * 2.5, 1e-17);
  expect_near(many.inertia.row_z, one.inertia.row_z * 2.5, 1e-17);
}

TEST(MassProperties, HaveATensorThatSomeBodyCanHave) {
  for (const Soup& soup : {make_blob(0.2, 2), make_torus(0.2, 0.05, 24, 12), make_l_shape(0.1),
                           make_wedge(1, 0.01, 0.1), make_spike(0.1, 1)}) {
    for (const Compute& compute :
         {Compute(compute_solid_mass_properties), Compute(compute_surface_mass_properties)}) {
      const Matrix3 i = compute(soup.mesh()).inertia;
      EXPECT_EQ(i.row_x.y, i.row_y.x);
      EXPECT_EQ(i.row_x.z, i.row_z.x);
      EXPECT_EQ(i.row_y.z, i.row_z.y);
      // The second moments (half the trace less the tensor) are positive definite.
      const double half_trace = (i.row_x.x + i.row_y.y + i.row_z.z) / 2;
      const Vec3 x{half_trace - i.row_x.x, -i.row_x.y, -i.row_x.z};
      const Vec3 y{-i.row_y.x, half_trace - i.row_y.y, -i.row_y.z};
      const Vec3 z{-i.row_z.x, -i.row_z.y, half_trace - i.row_z.z};
      EXPECT_GT(x.x, 0.0);
      EXPECT_GT(x.x * y.y - x.y * y.x, 0.0);
      EXPECT_GT(dot(x, cross(y, z)), 0.0);
    }
  }
}

}  // namespace
}  // namespace voxshell::mass_properties_test
