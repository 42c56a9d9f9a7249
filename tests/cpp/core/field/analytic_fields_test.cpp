#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/random.h"
#include "voxshell/box_field.h"
#include "voxshell/field.h"
#include "voxshell/plane_field.h"
#include "voxshell/sphere_field.h"

namespace voxshell {
namespace {

using test_support::Random;

/// The fields about whose bounds and gradients nothing special must be known.
template <class F>
void expect_bounds_and_gradients_hold(const F& field, double size) {
  Random random(20);
  const auto rounding = static_cast<float>(1e-6 * size);
  int steps_checked = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 p = random.in_cube(2.0 * size);
    const auto pf = static_cast<Vec3f>(p);
    const float here = field.distance(pf);

    const Vec3f gradient = field.gradient(pf);
    EXPECT_NEAR(length(gradient), 1.0f, 1e-6f);
    // Going outwards by t the distance grows by t, unless the nearest feature changes.
    const auto t = static_cast<float>(0.01 * size);
    const float there = field.distance(pf + t * gradient);
    EXPECT_LE(there, here + t + rounding);
    if (here > 0.0f) {
      EXPECT_NEAR(there, here + t, rounding);
      ++steps_checked;
    }

    const auto radius = static_cast<float>(random.uniform(0.0, size));
    const float bound = field.lower_bound(pf, radius);
    for (int k = 0; k < 10; ++k) {
      const double within = k < 5 ? 1.0 : random.unit();
      const auto q =
          static_cast<Vec3f>(p + (within * static_cast<double>(radius)) * random.direction());
      EXPECT_GE(field.distance(q), bound - rounding);
    }
    // The worst point of a ball lies against the gradient: the bound is tight in the open.
    if (here > radius) {
      EXPECT_NEAR(field.distance(pf - radius * gradient), bound, 4 * rounding);
    }
  }
  EXPECT_GT(steps_checked, 5000);
}

TEST(PlaneField, IsTheHeightAboveThePlane) {
  const PlaneField floor{{0, 0, 1}, 0.5};
  EXPECT_EQ(floor.distance({7, -8, 2}), 1.5f);
  EXPECT_EQ(floor.distance({7, -8, 0.5f}), 0.0f);
  EXPECT_EQ(floor.distance({7, -8, -1}), -1.5f);
  EXPECT_EQ(floor.gradient({7, -8, -1}), (Vec3f{0, 0, 1}));
  EXPECT_EQ(floor.reach(), 0.5);
  EXPECT_EQ((PlaneField{{0, 0, 1}, -0.5}.reach()), 0.5);
}

TEST(PlaneField, AgreesWithFloat64InEveryDirection) {
  Random random(21);
  for (int i = 0; i < 10'000; ++i) {
    const PlaneField plane{random.direction(), random.uniform(-3, 3)};
    const Vec3 p = random.in_cube(3);
    EXPECT_NEAR(plane.distance(static_cast<Vec3f>(p)), dot(plane.normal, p) - plane.offset, 3e-6);
  }
}

TEST(PlaneField, BoundsAndGradientsHold) {
  expect_bounds_and_gradients_hold(PlaneField{Random(22).direction(), 0.3}, 1.0);
}

TEST(SphereField, IsTheDistanceToTheCentreLessTheRadius) {
  const SphereField ball{2.0};
  EXPECT_EQ(ball.distance({0, 0, 0}), -2.0f);
  EXPECT_EQ(ball.distance({0, 3, 4}), 3.0f);
  EXPECT_EQ(ball.distance({0, 0, -2}), 0.0f);
  EXPECT_EQ(ball.gradient({0, -5, 0}), (Vec3f{0, -1, 0}));
  EXPECT_EQ(ball.gradient({0, 0, 0}), (Vec3f{0, 0, 1}));
  EXPECT_EQ(ball.reach(), 2.0);
}

TEST(SphereField, BoundsAndGradientsHold) {
  expect_bounds_and_gradients_hold(SphereField{0.7}, 1.0);
  expect_bounds_and_gradients_hold(SphereField{0.0007}, 0.001);
}

TEST(BoxField, IsTheDistanceToFacesEdgesAndCorners) {
  const BoxField box{{1, 2, 3}};
  EXPECT_EQ(box.distance({0, 0, 0}), -1.0f);
  EXPECT_EQ(box.distance({0, 1.75f, 0}), -0.25f);
  EXPECT_EQ(box.distance({0.5f, 1.75f, -2.875f}), -0.125f);
  EXPECT_EQ(box.distance({1, 0, 0}), 0.0f);
  EXPECT_EQ(box.distance({1, 2, 3}), 0.0f);
  EXPECT_EQ(box.distance({4, 1, -2}), 3.0f);
  EXPECT_EQ(box.distance({4, -6, 2}), 5.0f);
  EXPECT_EQ(box.distance({-3, 6, -7}), 6.0f);
  EXPECT_EQ(box.reach(), std::sqrt(14.0));
}

TEST(BoxField, GradientPointsOutOfTheNearestFeature) {
  const BoxField box{{1, 2, 3}};
  EXPECT_EQ(box.gradient({-0.9f, 0, 0}), (Vec3f{-1, 0, 0}));
  EXPECT_EQ(box.gradient({0, 1.9f, 0}), (Vec3f{0, 1, 0}));
  EXPECT_EQ(box.gradient({0, 0, -2.9f}), (Vec3f{0, 0, -1}));
  EXPECT_EQ(box.gradient({4, 0.5f, 0}), (Vec3f{1, 0, 0}));
  EXPECT_EQ(box.gradient({4, -6, 0}), (Vec3f{0.6f, -0.8f, 0}));
  const Vec3f corner = box.gradient({-3, 4, -5});
  const auto third = static_cast<float>(1.0 / std::sqrt(3.0));
  EXPECT_NEAR(corner.x, -third, 1e-7f);
  EXPECT_NEAR(corner.y, third, 1e-7f);
  EXPECT_NEAR(corner.z, -third, 1e-7f);
}

TEST(BoxField, GradientWhereFacesTieTakesTheFirstAxis) {
  const BoxField cube{{1, 1, 1}};
  EXPECT_EQ(cube.gradient({0, 0, 0}), (Vec3f{1, 0, 0}));
  EXPECT_EQ(cube.gradient({-0.5f, 0.5f, 0.5f}), (Vec3f{-1, 0, 0}));
  EXPECT_EQ(cube.gradient({0, -0.5f, 0.5f}), (Vec3f{0, -1, 0}));
  EXPECT_EQ(cube.gradient({1, 1, 1}), (Vec3f{1, 0, 0}));  // on the surface
}

TEST(BoxField, AgreesWithNearestPointByClamping) {
  Random random(23);
  const BoxField box{{0.3, 0.1, 0.7}};
  const Vec3& h = box.half_extents;
  int inside = 0;
  for (int i = 0; i < 50'000; ++i) {
    const Vec3 p = random.in_cube(1.0);
    const Vec3 nearest{std::clamp(p.x, -h.x, h.x), std::clamp(p.y, -h.y, h.y),
                       std::clamp(p.z, -h.z, h.z)};
    double expected = length(p - nearest);
    if (expected == 0.0) {
      ++inside;
      expected = -std::min({h.x - std::abs(p.x), h.y - std::abs(p.y), h.z - std::abs(p.z)});
    }
    EXPECT_NEAR(box.distance(static_cast<Vec3f>(p)), expected, 3e-7);
  }
  EXPECT_GT(inside, 500);
}

TEST(BoxField, BoundsAndGradientsHold) {
  expect_bounds_and_gradients_hold(BoxField{{0.5, 0.25, 1.0}}, 1.0);
  expect_bounds_and_gradients_hold(BoxField{{0.5, 0.25, 0.001}}, 1.0);  // a plate
}

TEST(AnalyticFields, AreLipschitzInside) {
  Random random(24);
  const std::vector<Field> fields{PlaneField{random.direction(), 0.1}, SphereField{1.0},
                                  BoxField{{0.5, 1.0, 1.5}}};
  for (const Field& field : fields) {
    std::visit(
        [&](const auto& f) {
          for (int i = 0; i < 20'000; ++i) {
            const auto p = static_cast<Vec3f>(random.in_cube(1.5));
            const auto q = static_cast<Vec3f>(random.in_cube(1.5));
            EXPECT_LE(std::abs(f.distance(p) - f.distance(q)), length(p - q) + 1e-6f);
          }
        },
        field);
  }
}

TEST(AnalyticFields, AnswerFarAwayWithoutTrouble) {
  const float infinity = std::numeric_limits<float>::infinity();
  const std::vector<Field> fields{PlaneField{{0.6, 0, 0.8}, 0.1}, SphereField{1.0},
                                  BoxField{{0.5, 1.0, 1.5}}};
  for (const Field& field : fields) {
    std::visit(
        [&](const auto& f) {
          for (const float far : {1e6f, 1e15f, 1e30f, std::numeric_limits<float>::max()}) {
            for (const Vec3f& p : {Vec3f{far, 0, far}, Vec3f{0, far / 2, far}}) {
              EXPECT_GT(f.distance(p), 0.6f * std::min(far, 1e18f));
              EXPECT_FALSE(std::isnan(f.lower_bound(p, 1.0f)));
            }
          }
          EXPECT_EQ(f.distance({infinity, 0, infinity}), infinity);
        },
        field);
  }
}

}  // namespace
}  // namespace voxshell
