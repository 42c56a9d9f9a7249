#include "voxshell/pose.h"

#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "support/random.h"

namespace voxshell::pose_test {
namespace {

using test_support::Random;

std::array<double, 16> to_matrix(const Pose& pose) {
  const auto& [x, y, z] = pose.rotation;
  const Vec3& t = pose.translation;
  return {x.x, x.y, x.z, t.x, y.x, y.y, y.z, t.y, z.x, z.y, z.z, t.z, 0, 0, 0, 1};
}

void expect_near(const Vec3& a, const Vec3& b, double tolerance) {
  EXPECT_LE(length(a - b), tolerance) << "(" << a.x << ", " << a.y << ", " << a.z << ") and ("
                                      << b.x << ", " << b.y << ", " << b.z << ")";
}

void expect_refused(const std::array<double, 16>& matrix, const std::string& reason) {
  const auto pose = Pose::from_matrix(matrix);
  ASSERT_FALSE(pose) << "accepted, but expected: " << reason;
  EXPECT_EQ(pose.error().code, ErrorCode::kInvalidPose);
  EXPECT_NE(pose.error().message.find(reason), std::string::npos) << pose.error().message;
}

TEST(Pose, DefaultIsIdentity) {
  const Pose identity{};
  expect_near(identity.transform_point({1, 2, 3}), {1, 2, 3}, 0.0);
  expect_near((identity * identity.inverse()).transform_point({1, 2, 3}), {1, 2, 3}, 0.0);
}

TEST(Pose, FromMatrixReadsRowsAndTheLastColumn) {
  // A quarter turn about z takes x to y.
  const auto pose = Pose::from_matrix({0, -1, 0, 10, 1, 0, 0, 20, 0, 0, 1, 30, 0, 0, 0, 1});
  ASSERT_TRUE(pose);
  expect_near(pose->transform_point({1, 0, 0}), {10, 21, 30}, 0.0);
  expect_near(pose->transform_point({0, 1, 0}), {9, 20, 30}, 0.0);
  expect_near(pose->rotate({1, 0, 0}), {0, 1, 0}, 0.0);
}

TEST(Pose, InverseUndoesOnBothSides) {
  Random random(2);
  for (int i = 0; i < 1000; ++i) {
    const Pose pose = random.pose(10.0);
    const Vec3 p = random.in_cube(5.0);
    expect_near(pose.inverse().transform_point(pose.transform_point(p)), p, 1e-13);
    expect_near(pose.transform_point(pose.inverse().transform_point(p)), p, 1e-13);
    expect_near((pose * pose.inverse()).transform_point(p), p, 1e-13);
  }
}

TEST(Pose, ProductAppliesTheRightOneFirst) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const Pose a_from_b = random.pose(3.0);
    const Pose b_from_c = random.pose(3.0);
    const Pose c_from_d = random.pose(3.0);
    const Vec3 p = random.in_cube(5.0);
    const Vec3 expected =
        a_from_b.transform_point(b_from_c.transform_point(c_from_d.transform_point(p)));
    expect_near((a_from_b * b_from_c * c_from_d).transform_point(p), expected, 1e-13);
    expect_near((a_from_b * (b_from_c * c_from_d)).transform_point(p), expected, 1e-13);
    expect_near((a_from_b * b_from_c).inverse().transform_point(p),
                (b_from_c.inverse() * a_from_b.inverse()).transform_point(p), 1e-13);
    expect_near((a_from_b * b_from_c).rotate(p), a_from_b.rotate(b_from_c.rotate(p)), 1e-13);
  }
}

TEST(Pose, MatrixProductIsRowTimesColumn) {
  const Matrix3 a{{1, 2, 3}, {4, 5, 6}, {7, 8, 10}};
  const Matrix3 b{{2, 0, 1}, {-1, 3, 5}, {4, 1, -2}};
  const Matrix3 c = a * b;
  EXPECT_EQ(c.row_x, (Vec3{12, 9, 5}));
  EXPECT_EQ(c.row_y, (Vec3{27, 21, 17}));
  EXPECT_EQ(c.row_z, (Vec3{46, 34, 27}));
  EXPECT_EQ(a.transposed().row_x, (Vec3{1, 4, 7}));
  EXPECT_EQ(a.transposed().row_z, (Vec3{3, 6, 10}));
}

TEST(Pose, FromMatrixTakesEveryRigidTransform) {
  Random random(4);
  for (int i = 0; i < 1000; ++i) {
    const Pose pose = random.pose(1e6);
    const auto read = Pose::from_matrix(to_matrix(pose));
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(to_matrix(*read), to_matrix(pose));
  }
}

TEST(Pose, RefusesWhatIsNotFiniteInAnyEntry) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
        -std::numeric_limits<double>::infinity()}) {
    for (std::size_t entry = 0; entry < 16; ++entry) {
      auto matrix = to_matrix(Pose{});
      matrix[entry] = bad;
      expect_refused(matrix, "not finite");
    }
  }
}

TEST(Pose, RefusesPlacesBeyondWhatFloat32CanSquare) {
  for (const std::size_t entry : {3u, 7u, 11u}) {
    auto matrix = to_matrix(Pose{});
    matrix[entry] = -0.9e15;
    EXPECT_TRUE(Pose::from_matrix(matrix));
    matrix[entry] = -1.1e15;
    expect_refused(matrix, "1e+15");
    matrix[entry] = 1e308;
    expect_refused(matrix, "1e+15");
  }
}

TEST(Pose, RefusesScaleShearAndRotationsThatAreNotOrthonormal) {
  for (std::size_t entry : {0u, 5u, 10u}) {
    auto matrix = to_matrix(Pose{});
    matrix[entry] = 1.001;
    expect_refused(matrix, "not orthonormal (error 0.002, at most");
    matrix[entry] = 0.0;
    expect_refused(matrix, "orthonormal");
  }
  for (std::size_t entry : {1u, 2u, 4u, 6u, 8u, 9u}) {
    auto matrix = to_matrix(Pose{});
    matrix[entry] = 1e-3;
    expect_refused(matrix, "not orthonormal (error 0.001, at most");
  }
  auto huge = to_matrix(Pose{});
  huge[0] = 1e200;  // its square is infinite
  expect_refused(huge, "orthonormal");
}

TEST(Pose, ToleratesRoundingOfTheRotationUpToAMillionth) {
  auto matrix = to_matrix(Pose{});
  matrix[1] = 0.9e-6;
  EXPECT_TRUE(Pose::from_matrix(matrix));
  matrix[1] = 1.1e-6;
  expect_refused(matrix, "scale the mesh, not the pose");

  Random random(5);
  for (int i = 0; i < 100; ++i) {
    auto single = to_matrix(random.pose(1.0));
    for (double& entry : single) entry = static_cast<double>(static_cast<float>(entry));
    EXPECT_TRUE(Pose::from_matrix(single));
  }
}

TEST(Pose, RefusesMirrors) {
  for (std::size_t entry : {0u, 5u, 10u}) {
    auto matrix = to_matrix(Pose{});
    matrix[entry] = -1.0;
    expect_refused(matrix, "mirror");
  }
  expect_refused({0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, "determinant -1");
}

TEST(Pose, RefusesAnotherLastRowAsOfATransposedMatrix) {
  expect_refused({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 3, 4, 5, 1}, "row-major");
  expect_refused({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2},
                 "must be 0, 0, 0, 1, and is off by 1;");
  expect_refused({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0}, "last row");
}

}  // namespace
}  // namespace voxshell::pose_test
