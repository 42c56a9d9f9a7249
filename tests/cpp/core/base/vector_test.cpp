#include "voxshell/vector.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "support/random.h"
#include "voxshell/bounds.h"

namespace voxshell::vector_test {
namespace {

using test_support::Random;

TEST(Vector, CrossFollowsTheRightHand) {
  EXPECT_EQ(cross(Vec3{1, 0, 0}, Vec3{0, 1, 0}), (Vec3{0, 0, 1}));
  EXPECT_EQ(cross(Vec3{0, 1, 0}, Vec3{0, 0, 1}), (Vec3{1, 0, 0}));
  EXPECT_EQ(cross(Vec3{0, 0, 1}, Vec3{1, 0, 0}), (Vec3{0, 1, 0}));
  EXPECT_EQ(cross(Vec3{2, 3, 5}, Vec3{7, 11, 13}), (Vec3{-16, 9, 1}));
}

TEST(Vector, ArithmeticByCoordinate) {
  const Vec3 a{1, -2, 4};
  const Vec3 b{8, 16, -32};
  EXPECT_EQ(a + b, (Vec3{9, 14, -28}));
  EXPECT_EQ(a - b, (Vec3{-7, -18, 36}));
  EXPECT_EQ(-a, (Vec3{-1, 2, -4}));
  EXPECT_EQ(a * 3.0, (Vec3{3, -6, 12}));
  EXPECT_EQ(3.0 * a, a * 3.0);
  EXPECT_EQ(b / 4.0, (Vec3{2, 4, -8}));
  EXPECT_EQ(dot(a, b), 8 - 32 - 128);
  EXPECT_EQ(squared_length(a), 21);
  EXPECT_EQ(length(Vec3{3, 4, 12}), 13);
  Vec3 sum = a;
  sum += b;
  EXPECT_EQ(sum, a + b);
  for (int axis = 0; axis < 3; ++axis) sum[axis] = 10 * axis;
  EXPECT_EQ(sum, (Vec3{0, 10, 20}));
  EXPECT_EQ(sum[2], 20);
}

TEST(Vector, NormalizedIsUnitLengthOrZero) {
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vec3 v = std::pow(10.0, random.uniform(-15, 15)) * random.direction();
    EXPECT_NEAR(length(normalized(v)), 1.0, 1e-15);
    EXPECT_NEAR(dot(normalized(v), v), length(v), 1e-14 * length(v));
  }
  EXPECT_EQ(normalized(Vec3{}), Vec3{});
}

TEST(Vector, FiniteMeansAllThree) {
  const double infinity = std::numeric_limits<double>::infinity();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(is_finite(Vec3{1, 2, 3}));
  for (const double bad : {infinity, -infinity, nan}) {
    EXPECT_FALSE(is_finite(Vec3{bad, 0, 0}));
    EXPECT_FALSE(is_finite(Vec3{0, bad, 0}));
    EXPECT_FALSE(is_finite(Vec3{0, 0, bad}));
  }
}

TEST(Bounds, GrowAroundPoints) {
  Bounds bounds;
  bounds.extend(Vec3{1, 5, -2});
  EXPECT_EQ(bounds.extents(), Vec3{});
  bounds.extend(Vec3{-3, 6, -1});
  EXPECT_EQ(bounds.lower, (Vec3{-3, 5, -2}));
  EXPECT_EQ(bounds.upper, (Vec3{1, 6, -1}));
  EXPECT_EQ(bounds.center(), (Vec3{-1, 5.5, -1.5}));
  EXPECT_EQ(bounds.longest_axis(), 0);

  Bounds other;
  other.extend(Vec3{0, 0, 40});
  other.extend(bounds);
  EXPECT_EQ(other.lower, (Vec3{-3, 0, -2}));
  EXPECT_EQ(other.upper, (Vec3{1, 6, 40}));
  EXPECT_EQ(other.longest_axis(), 2);
}

TEST(Bounds, SquaredDistanceIsZeroInsideAndToTheNearestFaceEdgeOrCornerOutside) {
  Bounds box;
  box.extend(Vec3{-1, -2, -3});
  box.extend(Vec3{1, 2, 3});
  EXPECT_EQ(squared_distance(box, {0.9, -1.9, 2.9}), 0.0);
  EXPECT_EQ(squared_distance(box, {1, 2, 3}), 0.0);
  EXPECT_EQ(squared_distance(box, {4, 0, 0}), 9.0);
  EXPECT_EQ(squared_distance(box, {-4, -6, 1}), 9.0 + 16.0);
  EXPECT_EQ(squared_distance(box, {3, -4, 5}), 12.0);
}

}  // namespace
}  // namespace voxshell::vector_test
