#include "shell/enclosing_sphere.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "support/random.h"

namespace voxshell::enclosing_sphere_test {
namespace {

using test_support::Random;

Sphere enclose(const std::vector<Vec3f>& points) {
  std::vector<std::uint32_t> ids(points.size());
  std::iota(ids.begin(), ids.end(), 0u);
  return compute_enclosing_sphere(points, ids);
}

double distance_between(const Vec3f& a, const Vec3f& b) {
  return length(static_cast<Vec3>(a) - static_cast<Vec3>(b));
}

void expect_encloses(const Sphere& sphere, const std::vector<Vec3f>& points) {
  for (const Vec3f& p : points) {
    ASSERT_LE(distance_between(p, sphere.center), static_cast<double>(sphere.radius));
  }
}

struct Ball {
  Vec3 center;
  double radius;
};

/// The smallest of the balls that have one to four of the points on their boundary and hold all.
/// Shares nothing with the algorithm tested.
double smallest_radius(const std::vector<Vec3f>& points) {
  std::vector<Vec3> p;
  for (const Vec3f& point : points) p.push_back(static_cast<Vec3>(point));
  double extent = 0.0;
  for (const Vec3& a : p) extent = std::max(extent, length(a - p[0]));
  double best = std::numeric_limits<double>::infinity();
  const auto consider = [&](const Vec3& center, double radius) {
    if (!(radius < best) || !is_finite(center)) return;
    for (const Vec3& q : p) {
      if (length(q - center) > radius + 1e-9 * extent) return;
    }
    best = radius;
  };
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i) {
    consider(p[i], 0.0);
    for (std::size_t j = i + 1; j < n; ++j) {
      const Vec3 middle = 0.5 * (p[i] + p[j]);
      consider(middle, length(p[j] - middle));
      for (std::size_t k = j + 1; k < n; ++k) {
        const Vec3 u = p[j] - p[i];
        const Vec3 v = p[k] - p[i];
        const Vec3 w = cross(u, v);
        if (length(w) > 1e-7 * length(u) * length(v)) {
          const Vec3 to_center =
              (squared_length(u) * cross(v, w) + squared_length(v) * cross(w, u)) /
              (2.0 * squared_length(w));
          consider(p[i] + to_center, length(to_center));
        }
        for (std::size_t l = k + 1; l < n; ++l) {
          const Vec3 t = p[l] - p[i];
          const double volume = dot(t, w);
          if (std::abs(volume) <= 1e-7 * length(t) * length(w)) continue;
          const Vec3 to_center = (squared_length(u) * cross(v, t) +
                                  squared_length(v) * cross(t, u) + squared_length(t) * w) /
                                 (2.0 * volume);
          // Cramer's rule, with the sign of dot(t, cross(u, v)).
          consider(p[i] + to_center, length(to_center));
        }
      }
    }
  }
  return best;
}

void expect_minimal(const std::vector<Vec3f>& points) {
  const Sphere sphere = enclose(points);
  expect_encloses(sphere, points);
  const double smallest = smallest_radius(points);
  ASSERT_TRUE(std::isfinite(smallest));
  double reach = 0.0;
  for (const Vec3f& p : points) reach = std::max(reach, length(static_cast<Vec3>(p)));
  // The center is rounded to float32 where it is.
  EXPECT_LE(static_cast<double>(sphere.radius), smallest * (1 + 1e-6) + 1e-7 * reach + 1e-40);
  EXPECT_GE(static_cast<double>(sphere.radius), smallest * (1 - 1e-6));
}

TEST(EnclosingSphere, OfOnePointIsThatPoint) {
  const Sphere sphere = enclose({{1, 2, 3}});
  EXPECT_EQ(sphere.center, (Vec3f{1, 2, 3}));
  EXPECT_LE(sphere.radius, 1e-30f);
}

TEST(EnclosingSphere, OfTwoPointsHasThemAsDiameter) {
  const Sphere sphere = enclose({{1, 2, 3}, {3, 2, 3}});
  EXPECT_EQ(sphere.center, (Vec3f{2, 2, 3}));
  EXPECT_NEAR(sphere.radius, 1.0f, 1e-6f);
}

TEST(EnclosingSphere, OfKnownBodies) {
  const Sphere cube = enclose(
      {{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {2, 2, 0}, {0, 0, 2}, {2, 0, 2}, {0, 2, 2}, {2, 2, 2}});
  EXPECT_LE(distance_between(cube.center, {1, 1, 1}), 1e-7);
  EXPECT_NEAR(cube.radius, std::sqrt(3.0f), 1e-6f);
  // An obtuse triangle's sphere ignores its blunt corner.
  const Sphere obtuse = enclose({{0, 0, 0}, {10, 0, 0}, {5, 1, 0}});
  EXPECT_EQ(obtuse.center, (Vec3f{5, 0, 0}));
  EXPECT_NEAR(obtuse.radius, 5.0f, 1e-6f);
  const Sphere equilateral = enclose({{1, 1, -1}, {1, -1, 1}, {-1, 1, 1}});
  EXPECT_NEAR(equilateral.radius, std::sqrt(8.0f / 3.0f), 1e-6f);
  const Sphere tetrahedron = enclose({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}});
  EXPECT_NEAR(tetrahedron.radius, std::sqrt(3.0f), 1e-6f);
}

TEST(EnclosingSphere, UsesOnlyTheSelectedPoints) {
  const std::vector<Vec3f> points{{100, 0, 0}, {0, 0, 0}, {-50, 7, 7}, {2, 0, 0}};
  const std::vector<std::uint32_t> ids{3, 1};
  const Sphere sphere = compute_enclosing_sphere(points, ids);
  EXPECT_EQ(sphere.center, (Vec3f{1, 0, 0}));
}

TEST(EnclosingSphere, IsTheSmallestOfRandomSets) {
  Random random(50);
  for (int trial = 0; trial < 1500; ++trial) {
    std::vector<Vec3f> points(1 + random.below(9));
    for (Vec3f& p : points) p = static_cast<Vec3f>(random.in_cube(1.0));
    expect_minimal(points);
  }
}

TEST(EnclosingSphere, IsTheSmallestOfSmallIntegers) {
  // Full of repeated, collinear, coplanar, cocircular and cospherical points.
  Random random(51);
  for (int trial = 0; trial < 3000; ++trial) {
    const auto side = 2 + random.below(3);
    std::vector<Vec3f> points(1 + random.below(9));
    for (Vec3f& p : points) {
      p = {static_cast<float>(random.below(side)), static_cast<float>(random.below(side)),
           static_cast<float>(random.below(side))};
    }
    expect_minimal(points);
  }
}

TEST(EnclosingSphere, IsTheSmallestOfCollinearPoints) {
  Random random(52);
  for (int trial = 0; trial < 500; ++trial) {
    const Vec3 direction = random.direction();
    const Vec3 offset = random.in_cube(1.0);
    std::vector<Vec3f> points(2 + random.below(7));
    for (Vec3f& p : points) p = static_cast<Vec3f>(offset + random.uniform(-1, 1) * direction);
    expect_minimal(points);
  }
}

TEST(EnclosingSphere, IsTheSmallestOfCoplanarPoints) {
  Random random(53);
  for (int trial = 0; trial < 500; ++trial) {
    const Matrix3 rotation = random.rotation();
    std::vector<Vec3f> points(3 + random.below(6));
    for (Vec3f& p : points) {
      p = static_cast<Vec3f>(rotation * Vec3{random.uniform(-1, 1), random.uniform(-1, 1), 0.25});
    }
    expect_minimal(points);
  }
}

TEST(EnclosingSphere, IsTheSmallestOfPointsOnACircle) {
  Random random(54);
  for (int trial = 0; trial < 500; ++trial) {
    const Matrix3 rotation = random.rotation();
    // On arcs up to the whole circle; those below half of it have their ends as a diameter.
    const double arc = random.uniform(0.1, 6.28);
    std::vector<Vec3f> points(3 + random.below(6));
    for (Vec3f& p : points) {
      const double angle = arc * random.unit();
      p = static_cast<Vec3f>(rotation * Vec3{std::cos(angle), std::sin(angle), 0.0});
    }
    expect_minimal(points);
  }
}

TEST(EnclosingSphere, IsTheSmallestOfPointsOnASphere) {
  Random random(55);
  for (int trial = 0; trial < 500; ++trial) {
    const Vec3 center = random.in_cube(2.0);
    const double cap = random.uniform(-1.0, 0.9);
    std::vector<Vec3f> points(4 + random.below(5));
    for (Vec3f& p : points) {
      Vec3 direction = random.direction();
      while (direction.z < cap) direction = random.direction();
      p = static_cast<Vec3f>(center + direction);
    }
    expect_minimal(points);
  }
}

TEST(EnclosingSphere, IsTheSmallestOfThinSets) {
  Random random(56);
  for (int trial = 0; trial < 500; ++trial) {
    const double thickness = std::pow(10.0, random.uniform(-9, -1));
    std::vector<Vec3f> points(2 + random.below(7));
    for (Vec3f& p : points) {
      p = static_cast<Vec3f>(random.in_box({-1, -1, -1}, {1, trial % 2 ? 1.0 : thickness, 1.0}));
      p.z = static_cast<float>(thickness * static_cast<double>(p.z));
    }
    expect_minimal(points);
  }
}

TEST(EnclosingSphere, IsTheSmallestOfFlatTrianglesAndTetrahedra) {
  // Hardly acute: the ball hangs on a point that adds little height to the others.
  Random random(57);
  for (int trial = 0; trial < 2000; ++trial) {
    const double bend = std::pow(10.0, random.uniform(-6, -0.5));
    std::vector<Vec3f> points{{-1, 0, 0}, {1, 0, 0}};
    for (int i = 0; i < 3; ++i) {
      const double angle = random.uniform(-bend, bend);
      const double reach = 1.0 + random.uniform(-bend, bend) * bend;
      points.push_back(
          static_cast<Vec3f>((i % 2 == 0 ? reach : -reach) *
                             Vec3{std::cos(angle), std::sin(angle), random.uniform(-bend, bend)}));
    }
    expect_minimal(points);
  }
}

TEST(EnclosingSphere, IsTheSmallestFarFromTheOriginAndAtAnySize) {
  Random random(57);
  for (int trial = 0; trial < 500; ++trial) {
    const double size = std::pow(10.0, random.uniform(-8, 8));
    const Vec3 offset = (100.0 * size * random.unit()) * random.direction();
    std::vector<Vec3f> points(2 + random.below(7));
    for (Vec3f& p : points) p = static_cast<Vec3f>(offset + random.in_cube(size));
    expect_minimal(points);
  }
}

TEST(EnclosingSphere, RepeatedPointsChangeNothing) {
  Random random(58);
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<Vec3f> points(1 + random.below(7));
    for (Vec3f& p : points) p = static_cast<Vec3f>(random.in_cube(1.0));
    const Sphere once = enclose(points);
    std::vector<Vec3f> repeated;
    for (int copy = 0; copy < 5; ++copy) {
      repeated.insert(repeated.end(), points.begin(), points.end());
    }
    const Sphere often = enclose(repeated);
    expect_encloses(often, repeated);
    EXPECT_NEAR(often.radius, once.radius, 2e-7f);
  }
}

/// Large sets, in orders that are bad for algorithms that take points as they come. A run that
/// does not end in time is stopped by the test's own limit.
TEST(EnclosingSphere, OfManyPointsOnASphere) {
  Random random(59);
  std::vector<Vec3f> points(20'000);
  for (Vec3f& p : points) p = static_cast<Vec3f>(Vec3{1, 2, 3} + random.direction());
  const Sphere sphere = enclose(points);
  expect_encloses(sphere, points);
  EXPECT_NEAR(sphere.radius, 1.0f, 1e-6f);
  EXPECT_LE(distance_between(sphere.center, {1, 2, 3}), 1e-5);
}

TEST(EnclosingSphere, OfManyPointsOnACircle) {
  std::vector<Vec3f> points;
  for (int i = 0; i < 20'000; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 20'000;
    points.push_back(static_cast<Vec3f>(Vec3{std::cos(angle), std::sin(angle), 0.5}));
  }
  const Sphere sphere = enclose(points);
  expect_encloses(sphere, points);
  EXPECT_NEAR(sphere.radius, 1.0f, 1e-6f);
}

TEST(EnclosingSphere, OfALattice) {
  std::vector<Vec3f> points;
  for (int i = 0; i < 27; ++i) {
    for (int j = 0; j < 27; ++j) {
      for (int k = 0; k < 27; ++k) {
        points.push_back({static_cast<float>(i), static_cast<float>(j), static_cast<float>(k)});
      }
    }
  }
  const Sphere sphere = enclose(points);
  expect_encloses(sphere, points);
  EXPECT_LE(distance_between(sphere.center, {13, 13, 13}), 1e-5);
  EXPECT_NEAR(sphere.radius, 13.0f * std::sqrt(3.0f), 1e-4f);
}

TEST(EnclosingSphere, OfALongRodSortedAlongItsLength) {
  Random random(60);
  std::vector<Vec3f> points;
  for (int i = 0; i < 200'000; ++i) {
    points.push_back(
        static_cast<Vec3f>(Vec3{1e-4 * i, random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1)}));
  }
  const Sphere sphere = enclose(points);
  expect_encloses(sphere, points);
  EXPECT_NEAR(sphere.radius, 10.0f, 1e-3f);
}

TEST(EnclosingSphere, OfASpiralThatWidens) {
  std::vector<Vec3f> points;
  for (int i = 0; i < 200'000; ++i) {
    const double turn = 2.4 * i;  // the golden angle: each point is beyond all before it
    const double height = 0.3 * i * std::sin(0.1 * i);
    points.push_back(static_cast<Vec3f>(Vec3{i * std::cos(turn), i * std::sin(turn), height}));
  }
  const Sphere sphere = enclose(points);
  expect_encloses(sphere, points);
  EXPECT_LE(sphere.radius, 1.05f * 209'000.0f);
  EXPECT_GE(sphere.radius, 199'000.0f);
}

}  // namespace
}  // namespace voxshell::enclosing_sphere_test
