#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "support/random.h"
#include "voxshell/field.h"

namespace voxshell::analytic_fields_test {
namespace {

using test_support::Random;

enum class Beyond { kExact, kLowerBound };

/// The fields about whose bounds and gradients nothing special must be known.
template <class F>
void expect_bounds_and_gradients_hold(const F& field, double size, Beyond beyond = Beyond::kExact) {
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
    if (here > radius && beyond == Beyond::kExact) {
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

TEST(SphereField, IsTheDistanceToTheCenterLessTheRadius) {
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

TEST(CapsuleField, IsTheDistanceToASegmentLessTheRadius) {
  const CapsuleField pill{2.0, 6.0};
  EXPECT_EQ(pill.distance({0, 0, 0}), -2.0f);
  EXPECT_EQ(pill.distance({0, 0, 4}), -1.0f);
  EXPECT_EQ(pill.distance({0, 0, -5}), 0.0f);
  EXPECT_EQ(pill.distance({3, 4, 2.5f}), 3.0f);
  EXPECT_EQ(pill.distance({0, -3, -7}), 3.0f);
  EXPECT_EQ(pill.gradient({0, -5, 2}), (Vec3f{0, -1, 0}));
  EXPECT_EQ(pill.gradient({0, 0, -4}), (Vec3f{0, 0, -1}));
  EXPECT_EQ(pill.gradient({0, 3, 7}), (Vec3f{0, 0.6f, 0.8f}));
  EXPECT_EQ(pill.reach(), 5.0);
}

TEST(CapsuleField, GradientOnTheAxisPointsAlongX) {
  const CapsuleField pill{2.0, 6.0};
  for (const float z : {-3.0f, -1.0f, 0.0f, 3.0f}) {
    EXPECT_EQ(pill.gradient({0, 0, z}), (Vec3f{1, 0, 0}));
  }
}

TEST(CylinderField, IsTheDistanceToSideEndsAndRims) {
  const CylinderField tin{2.0, 6.0};
  EXPECT_EQ(tin.distance({0, 0, 0}), -2.0f);
  EXPECT_EQ(tin.distance({0, 1, 2.5f}), -0.5f);
  EXPECT_EQ(tin.distance({0, 0, -3}), 0.0f);
  EXPECT_EQ(tin.distance({3, 4, -1}), 3.0f);
  EXPECT_EQ(tin.distance({1, 1, 5}), 2.0f);
  EXPECT_EQ(tin.distance({0, -5, 7}), 5.0f);
  EXPECT_EQ(tin.reach(), std::sqrt(13.0));
}

TEST(CylinderField, GradientPointsOutOfTheNearestFeature) {
  const CylinderField tin{2.0, 6.0};
  EXPECT_EQ(tin.gradient({-1.5f, 0, 0}), (Vec3f{-1, 0, 0}));
  EXPECT_EQ(tin.gradient({0, 0.5f, -2.9f}), (Vec3f{0, 0, -1}));
  EXPECT_EQ(tin.gradient({0, -5, 7}), (Vec3f{0, -0.6f, 0.8f}));
  EXPECT_EQ(tin.gradient({0, 5, -7}), (Vec3f{0, 0.6f, -0.8f}));
  EXPECT_EQ(tin.gradient({0, 1, 2}), (Vec3f{0, 1, 0}));  // a tie
  EXPECT_EQ(tin.gradient({0, 0, 0}), (Vec3f{1, 0, 0}));
}

TEST(ConeField, IsTheDistanceToBaseSlantRimAndApex) {
  const ConeField hat{3.0, 4.0};  // the slant is 5 long
  EXPECT_EQ(hat.distance({0, 0, -2}), 0.0f);
  EXPECT_EQ(hat.distance({1, 0, -4}), -2.0f + 4.0f);
  EXPECT_EQ(hat.distance({0, 0, 2}), 0.0f);
  EXPECT_EQ(hat.distance({0, 0, 5}), 3.0f);
  EXPECT_NEAR(hat.distance({0, 3, -2}), 0.0f, 1e-6f);
  EXPECT_EQ(hat.distance({6, 0, -6}), 5.0f);
  EXPECT_NEAR(hat.distance({1.5f + 0.8f * 2, 0, 0.6f * 2}), 2.0f, 1e-6f);
  EXPECT_EQ(hat.distance({0, 0, -1.75f}), -0.25f);
  EXPECT_NEAR(hat.distance({0, 0, 1}), -0.6f, 1e-6f);
  EXPECT_NEAR(hat.distance({0, 0, -0.5f}), -1.5f, 1e-6f);  // the center of the inscribed ball
  EXPECT_EQ(hat.reach(), std::sqrt(13.0));
}

TEST(ConeField, GradientPointsOutOfTheNearestFeature) {
  const ConeField hat{3.0, 4.0};
  EXPECT_EQ(hat.gradient({0, 0, 5}), (Vec3f{0, 0, 1}));
  EXPECT_EQ(hat.gradient({1, 0, -4}), (Vec3f{0, 0, -1}));
  EXPECT_EQ(hat.gradient({1, 0, -1.9f}), (Vec3f{0, 0, -1}));
  EXPECT_EQ(hat.gradient({0, -6, -6}), (Vec3f{0, -0.6f, -0.8f}));
  const Vec3f slant = hat.gradient({0, 1.5f, 0});
  EXPECT_NEAR(slant.y, 0.8f, 1e-6f);
  EXPECT_NEAR(slant.z, 0.6f, 1e-6f);
  const Vec3f axis = hat.gradient({0, 0, 1});
  EXPECT_NEAR(axis.x, 0.8f, 1e-6f);
  EXPECT_NEAR(axis.z, 0.6f, 1e-6f);
}

struct Point2 {
  double r, z;
};

double distance_to_segment(const Point2& p, const Point2& a, const Point2& b) {
  const double along = ((p.r - a.r) * (b.r - a.r) + (p.z - a.z) * (b.z - a.z)) /
                       ((b.r - a.r) * (b.r - a.r) + (b.z - a.z) * (b.z - a.z));
  const double t = std::clamp(along, 0.0, 1.0);
  return std::hypot(p.r - a.r - t * (b.r - a.r), p.z - a.z - t * (b.z - a.z));
}

/// To a convex polygon, counter-clockwise; negative inside.
double distance_to_polygon(const Point2& p, const std::vector<Point2>& corners) {
  double nearest = std::numeric_limits<double>::infinity();
  bool inside = true;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Point2& a = corners[i];
    const Point2& b = corners[(i + 1) % corners.size()];
    nearest = std::min(nearest, distance_to_segment(p, a, b));
    inside &= (b.r - a.r) * (p.z - a.z) - (b.z - a.z) * (p.r - a.r) > 0.0;
  }
  return inside ? -nearest : nearest;
}

template <class F, class Expected>
void expect_solid_of_revolution(const F& field, const Expected& expected) {
  Random random(25);
  int inside = 0;
  for (int i = 0; i < 50'000; ++i) {
    const Vec3 p = random.in_cube(1.0);
    const double true_distance = expected({std::hypot(p.x, p.y), p.z});
    EXPECT_NEAR(field.distance(static_cast<Vec3f>(p)), true_distance, 3e-7);
    inside += true_distance < 0.0;
  }
  EXPECT_GT(inside, 500);
}

TEST(SolidsOfRevolution, AgreeWithTheirProfilesInFloat64) {
  expect_solid_of_revolution(CapsuleField{0.3, 0.9}, [](const Point2& p) {
    return distance_to_segment(p, {0, -0.45}, {0, 0.45}) - 0.3;
  });
  expect_solid_of_revolution(CylinderField{0.3, 0.9}, [](const Point2& p) {
    return distance_to_polygon(p, {{-0.3, -0.45}, {0.3, -0.45}, {0.3, 0.45}, {-0.3, 0.45}});
  });
  for (const auto& [radius, height] : {std::pair{0.3, 0.9}, std::pair{0.9, 0.3}}) {
    expect_solid_of_revolution(
        ConeField{radius, height}, [radius = radius, height = height](const Point2& p) {
          return distance_to_polygon(
              p, {{-radius, -height / 2}, {radius, -height / 2}, {0, height / 2}});
        });
  }
}

TEST(SolidsOfRevolution, BoundsAndGradientsHold) {
  expect_bounds_and_gradients_hold(CapsuleField{0.3, 1.0}, 1.0);
  expect_bounds_and_gradients_hold(CapsuleField{0.0003, 0.001}, 0.001);
  expect_bounds_and_gradients_hold(CylinderField{0.3, 1.0}, 1.0);
  expect_bounds_and_gradients_hold(CylinderField{0.8, 0.001}, 1.0);  // a disc
  expect_bounds_and_gradients_hold(ConeField{0.5, 1.0}, 1.0);
  expect_bounds_and_gradients_hold(ConeField{0.01, 1.0}, 1.0);  // a needle
  expect_bounds_and_gradients_hold(ConeField{0.9, 0.01}, 1.0);  // a plate
}

ConvexField make_convex(const test_support::Soup& soup) {
  auto field = ConvexField::create(soup.mesh());
  if (!field) std::abort();
  return *std::move(field);
}

TEST(ConvexField, BoundsAndGradientsHold) {
  expect_bounds_and_gradients_hold(make_convex(test_support::make_box({0.5, 0.25, 1.0})), 1.0,
                                   Beyond::kLowerBound);
  expect_bounds_and_gradients_hold(make_convex(test_support::make_icosphere(0.7, 1)), 1.0,
                                   Beyond::kLowerBound);
}

TEST(AnalyticFields, AreLipschitzInside) {
  Random random(24);
  const std::vector<Field> fields{PlaneField{random.direction(), 0.1},
                                  SphereField{1.0},
                                  BoxField{{0.5, 1.0, 1.5}},
                                  CapsuleField{0.5, 1.0},
                                  CylinderField{0.5, 1.5},
                                  ConeField{1.0, 2.0},
                                  make_convex(test_support::make_icosphere(1.0, 1))};
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

TEST(AnalyticFields, GiveNoNumberForPlacesThatAreNone) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Field> fields{PlaneField{{0.6, 0, 0.8}, 0.1},
                                  SphereField{1.0},
                                  BoxField{{0.5, 1.0, 1.5}},
                                  CapsuleField{0.5, 1.0},
                                  CylinderField{0.5, 1.5},
                                  ConeField{1.0, 2.0},
                                  make_convex(test_support::make_icosphere(1.0, 1))};
  for (const Field& field : fields) {
    std::visit(
        [&](const auto& f) {
          for (const Vec3f& p : {Vec3f{nan, 0, 0}, Vec3f{0, nan, 0}, Vec3f{0, 0, nan}}) {
            EXPECT_TRUE(std::isnan(f.distance(p))) << "field " << field.index();
            EXPECT_TRUE(std::isnan(f.lower_bound(p, 0.1f))) << "field " << field.index();
          }
        },
        field);
  }
}

TEST(AnalyticFields, AnswerFarAwayWithoutTrouble) {
  const float infinity = std::numeric_limits<float>::infinity();
  const std::vector<Field> fields{PlaneField{{0.6, 0, 0.8}, 0.1}, SphereField{1.0},
                                  BoxField{{0.5, 1.0, 1.5}},      CapsuleField{0.5, 1.0},
                                  CylinderField{0.5, 1.5},        ConeField{1.0, 2.0}};
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
}  // namespace voxshell::analytic_fields_test
