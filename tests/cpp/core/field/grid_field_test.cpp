#include "voxshell/grid_field.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "simd/grid_sampling.h"
#include "support/brute_force.h"
#include "support/closest_point_tree.h"
#include "support/grid_bricks.h"
#include "support/grid_fields.h"
#include "support/meshes.h"
#include "support/random.h"

namespace voxshell::grid_field_test {
namespace {

using namespace test_support;

bool is_on_brick_face(const GridField& field, const Vec3& p) {
  const double edge = simd::kBrickCells * field.voxel_size();
  for (int axis = 0; axis < 3; ++axis) {
    const double bricks = (p[axis] - field.origin()[axis]) / edge;
    if (std::abs(bricks - std::round(bricks)) < 0.01) return true;
  }
  return false;
}

TEST(GridField, ShapeCoversTheMeshAndItsPadding) {
  const TriangleMesh mesh = make_box({0.5, 0.25, 1.0}).mesh();
  for (const double padding : {0.0, 0.05, 0.33}) {
    const GridField field = build(mesh, 0.1, padding);
    const double kept = std::max(padding, 0.8);
    const Bounds bounds = grid_bounds(field);
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(bounds.lower[axis], mesh.bounds().lower[axis] - kept, 1e-12);
      EXPECT_GE(bounds.upper[axis], mesh.bounds().upper[axis] + kept - 1e-12);
      EXPECT_LT(bounds.upper[axis], mesh.bounds().upper[axis] + kept + 0.8);
    }
    const GridFieldData& data = field.data();
    EXPECT_EQ(data.entries.size(),
              static_cast<std::size_t>(data.bricks[0] * data.bricks[1] * data.bricks[2]));
    EXPECT_EQ(field.nbytes(),
              4 * data.entries.size() + 2 * data.samples.size() + 4 * data.planes.size());
    EXPECT_EQ(field.surface_bounds().lower, mesh.bounds().lower);
    EXPECT_EQ(field.surface_bounds().upper, mesh.bounds().upper);
    EXPECT_EQ(field.voxel_size(), 0.1);
  }
}

TEST(GridField, NodesHoldTheSignedDistance) {
  Random random(71);
  for (const auto& [name, mesh, voxel_size] : bodies()) {
    const GridField field = build(mesh, voxel_size, 2 * voxel_size);
    int inside = 0;
    const std::size_t bricks = field.data().entries.size();
    for (std::size_t brick = 0; brick < bricks; ++brick) {
      const double rounding = std::ldexp(voxel_size / 512, entry_of(field, brick).exponent);
      visit_nodes(
          field, brick,
          [&, &name = name, &mesh = mesh, voxel_size = voxel_size](const Vec3& p, double value) {
            if (random.below(bricks / 8) != 0) return;
            const double expected = signed_distance_to_mesh(p, mesh);
            inside += expected < 0.0;
            // On the surface itself either sign will do.
            ASSERT_NEAR(value, expected, rounding + 1e-3 * voxel_size) << name;
            if (cell_size_of(field, brick) == 1.0 && !is_on_brick_face(field, p)) {
              ASSERT_NEAR(distance_at(field, p), expected, rounding + 1e-3 * voxel_size) << name;
            }
          });
    }
    EXPECT_GT(inside, 5) << name;
  }
}

TEST(GridField, EveryNodeOfABoxIsExactToHalfAQuantum) {
  // All coordinates are multiples of 1/16: nodes lie on faces, edges and corners.
  const TriangleMesh mesh = make_box({0.5, 0.25, 0.75}).mesh();
  const double h = 0.0625;
  const GridField field = build(mesh, h, 0.25);
  const Vec3 half{0.5, 0.25, 0.75};
  for (std::size_t brick = 0; brick < field.data().entries.size(); ++brick) {
    visit_nodes(field, brick, [&](const Vec3& p, double value) {
      const Vec3 q{std::abs(p.x) - half.x, std::abs(p.y) - half.y, std::abs(p.z) - half.z};
      const double outside =
          length(Vec3{std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)});
      const double expected = outside + std::min(std::max({q.x, q.y, q.z}), 0.0);
      ASSERT_NEAR(value, expected, h / 512 + 1e-6 * h) << p.x << " " << p.y << " " << p.z;
      if (!is_on_brick_face(field, p)) {
        ASSERT_NEAR(distance_at(field, p), value, 1e-6);
      }
    });
  }
}

/// Puts a vertex on an edge of one of its two triangles, and a triangle without area between them.
/// Half of the vertices go a little off the edge, which makes a needle or a fold of it.
void insert_needle(Soup& soup, Random& random) {
  const std::size_t chosen = random.below(soup.triangles.size());
  const std::size_t side = random.below(3);
  const std::uint32_t a = soup.triangles[chosen][side];
  const std::uint32_t b = soup.triangles[chosen][(side + 1) % 3];
  const std::uint32_t c = soup.triangles[chosen][(side + 2) % 3];
  const auto m = static_cast<std::uint32_t>(soup.vertices.size());
  const double off = random.below(2) == 0 ? 0.0 : 1e-12;
  const Vec3 on_edge =
      soup.vertices[a] + random.uniform(0.1, 0.9) * (soup.vertices[b] - soup.vertices[a]);
  soup.vertices.push_back(on_edge + random.in_cube(off));
  soup.triangles[chosen] = {a, m, c};
  soup.triangles.push_back({m, b, c});
  soup.triangles.push_back({a, b, m});
}

TEST(GridField, NeedlesAndTrianglesWithoutAreaDoNotShow) {
  Random random(81);
  for (int trial = 0; trial < 60; ++trial) {
    Soup soup = make_box({0.5, 0.25, 0.75});
    if (trial % 3 == 1) soup = make_l_shape(0.5);
    if (trial % 3 == 2) soup = transformed(soup, random.pose(0.3));
    const TriangleMesh plain = soup.mesh();
    for (int i = 0; i < 12; ++i) insert_needle(soup, random);
    const auto field = GridField::build(soup.mesh(), {.voxel_size = 0.12});
    ASSERT_TRUE(field) << field.error().message;
    const GridField expected = build(plain, 0.12);
    ASSERT_EQ(field->shape(), expected.shape());
    std::size_t compared = 0;
    for (std::size_t brick = 0; brick < expected.data().entries.size(); ++brick) {
      std::vector<double> plain_nodes;
      std::vector<double> nodes;
      visit_nodes(expected, brick, [&](const Vec3&, double d) { plain_nodes.push_back(d); });
      visit_nodes(*field, brick, [&](const Vec3&, double d) { nodes.push_back(d); });
      if (nodes.size() != plain_nodes.size()) continue;
      ++compared;
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        ASSERT_NEAR(std::abs(nodes[i]), std::abs(plain_nodes[i]), 0.12 / 200);
        if (std::abs(nodes[i]) > 0.12 / 200) {
          ASSERT_EQ(nodes[i] < 0.0, plain_nodes[i] < 0.0);
        }
      }
    }
    EXPECT_GT(compared, expected.data().entries.size() / 2);
  }
}

TEST(GridField, ErrorInsideTheGridIsWithinTheInterpolationError) {
  Random random(72);
  for (const auto& [name, mesh, voxel_size] : bodies()) {
    const GridField field = build(mesh, voxel_size, 2 * voxel_size);
    EXPECT_GE(field.interpolation_error(), std::sqrt(3.0) / 2.0 * voxel_size);
    EXPECT_LE(field.interpolation_error(), 0.875 * voxel_size);
    const Bounds bounds = grid_bounds(field);
    double worst = 0.0;
    for (int i = 0; i < 3000; ++i) {
      const Vec3 p = point_in(random, bounds);
      const double error = std::abs(distance_at(field, p) - signed_distance_to_mesh(p, mesh));
      worst = std::max(worst, error / cell_size_of(field, brick_at(field, p)));
    }
    EXPECT_LE(worst, field.interpolation_error() + 1e-6) << name;
    EXPECT_GT(worst, 0.05 * voxel_size) << name;  // or the sampling missed where it is hard
  }
}

TEST(GridField, RidgesOfDepthAreCutByAboutAVoxel) {
  Random random(85);
  const auto turned = [&](const Soup& soup) { return transformed(soup, random.pose(0.3)).mesh(); };
  const std::vector<Body> all{{"box", turned(make_box({0.5, 0.4, 0.3})), 0.005},
                              {"blob", turned(make_blob(0.5, 3)), 0.005},
                              {"torus", turned(make_torus(0.5, 0.2, 40, 30)), 0.004}};
  for (const auto& [name, mesh, voxel_size] : all) {
    const GridField field = build(mesh, voxel_size);
    const ClosestPointTree closest(mesh);
    int deep = 0;
    double worst = 0.0;
    while (deep < 8000) {
      const Vec3 p = point_in(random, mesh.bounds());
      if (distance_at(field, p) > -10.0 * voxel_size) continue;
      ++deep;
      const double depth = std::sqrt(closest.find_closest(p).squared_distance);
      worst = std::max(worst, std::abs(distance_at(field, p) + depth));
    }
    EXPECT_LE(worst, 1.25 * voxel_size) << name;
  }
}

TEST(GridField, ErrorBoundIsReachedByASpeckInTheMiddleOfACell) {
  const TriangleMesh speck = make_icosphere(1e-3, 1).mesh();
  const GridField field = build(speck, 1.0, 8.499);  // the speck is in the middle of a cell
  const double error = distance_at(field, {}) - signed_distance_to_mesh({}, speck);
  EXPECT_LE(error, field.interpolation_error());
  EXPECT_GE(error, 0.99 * field.interpolation_error());
}

TEST(GridField, OutsideTheGridIsNeverBelowWhatItsBorderAllows) {
  Random random(73);
  for (const auto& [name, mesh, voxel_size] : bodies()) {
    const GridField field = build(mesh, voxel_size);
    const Bounds bounds = grid_bounds(field);
    int outside = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 p = point_in(random, grown(bounds, i % 2 == 0 ? 0.1 : 3.0));
      if (is_in(bounds, static_cast<Vec3f>(p))) continue;
      ++outside;
      const double value = distance_at(field, p);
      Vec3 nearest = p;
      for (int axis = 0; axis < 3; ++axis) {
        nearest[axis] = std::clamp(p[axis], bounds.lower[axis], bounds.upper[axis]);
      }
      const double there = distance_at(field, nearest);
      EXPECT_GE(value, std::hypot(there, length(p - nearest)) - 1e-5) << name;
      EXPECT_LE(value, there + length(p - nearest) + 1e-5) << name;
    }
    EXPECT_GT(outside, 500) << name;
  }
}

TEST(GridField, SeesASphereFromOutsideTheGridAboutWhereItIs) {
  Random random(83);
  const GridField field = build(make_icosphere(0.5, 4).mesh(), 0.02);
  const Bounds bounds = grid_bounds(field);
  for (int i = 0; i < 3000; ++i) {
    const Vec3 p = random.uniform(0.9, 5.0) * random.direction();
    if (is_in(bounds, static_cast<Vec3f>(p))) continue;
    EXPECT_NEAR(distance_at(field, p), length(p) - 0.5, 0.04 * length(p));
    const auto gradient = static_cast<Vec3>(field.gradient(static_cast<Vec3f>(p)));
    EXPECT_NEAR(length(gradient), 1.0, 1e-6);
    EXPECT_GT(dot(gradient, normalized(p)), 0.98);
  }
}

TEST(GridField, IsContinuousAcrossCellsAndTheGridsBorder) {
  Random random(74);
  for (const auto& [name, mesh, voxel_size] : bodies()) {
    const GridField field = build(mesh, voxel_size);
    const Bounds bounds = grid_bounds(field);
    const auto step = static_cast<float>(1e-6);
    for (int i = 0; i < 3000; ++i) {
      // On a face between cells, or on the border, or a corner of either.
      Vec3 p = point_in(random, bounds);
      for (int axis = 0; axis < 3; ++axis) {
        if (axis != i % 3 && random.below(3) != 0) continue;
        const double last = field.shape()[static_cast<std::size_t>(axis)] - 1.0;
        const double cell = random.below(4) == 0 ? (random.below(2) == 0 ? 0.0 : last)
                                                 : std::round(random.uniform(0.0, last));
        p[axis] = field.origin()[axis] + cell * voxel_size;
      }
      const auto here = static_cast<Vec3f>(p);
      // Neighbors that hold the same nodes agree on them.
      const float allowed =
          static_cast<float>(is_fine_around(field, p) ? 2.0 * field.data().node_error
                                                      : 16.0 * field.interpolation_error());
      for (int k = 0; k < 6; ++k) {
        const Vec3f there = here + step * static_cast<Vec3f>(random.direction());
        ASSERT_NEAR(field.distance(here), field.distance(there), allowed + 5e-6f) << name;
      }
    }
  }
}

TEST(GridField, GradientIsThatOfTheValue) {
  Random random(75);
  for (const auto& [name, mesh, voxel_size] : bodies()) {
    const GridField field = build(mesh, voxel_size);
    const Bounds bounds = grid_bounds(field);
    const double step = 0.02 * voxel_size;
    int checked = 0;
    for (int i = 0; i < 6000; ++i) {
      const Vec3 p = point_in(random, bounds);
      // Both ends of all differences in one cell.
      bool is_clear = true;
      for (int axis = 0; axis < 3; ++axis) {
        const double cells = (p[axis] - field.origin()[axis]) / voxel_size;
        is_clear = is_clear && std::abs(cells - std::round(cells)) > 0.03;
      }
      if (!is_clear) continue;
      ++checked;
      const Vec3f gradient = field.gradient(static_cast<Vec3f>(p));
      for (int axis = 0; axis < 3; ++axis) {
        Vec3 ahead = p;
        Vec3 behind = p;
        ahead[axis] += step;
        behind[axis] -= step;
        const double slope = (distance_at(field, ahead) - distance_at(field, behind)) / (2 * step);
        ASSERT_NEAR(static_cast<double>(gradient[axis]), slope, 2e-3)
            << name << " at " << p.x << " " << p.y << " " << p.z;
      }
    }
    EXPECT_GT(checked, 1000) << name;
  }
}

TEST(GridField, GradientIsNearUnitLengthAwayFromTheMedialAxis) {
  const TriangleMesh mesh = make_icosphere(0.5, 4).mesh();
  const GridField field = build(mesh, 0.025, 0.1);
  Random random(76);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 direction = random.direction();
    const Vec3 p = random.uniform(0.3, 0.6) * direction;
    const Vec3f gradient = field.gradient(static_cast<Vec3f>(p));
    EXPECT_NEAR(length(gradient), 1.0f, 0.1f);
    EXPECT_GT(dot(static_cast<Vec3>(gradient), direction), 0.9);
  }
}

TEST(GridField, TurnsWithTheMesh) {
  // Same body, other grid: the difference stays within both errors.
  Random random(79);
  const Soup soup = make_blob(0.6, 2);
  const GridField still = build(soup.mesh(), 0.05, 0.1);
  const Pose turned_from_still = random.pose(0.5);
  const GridField turned = build(transformed(soup, turned_from_still).mesh(), 0.05, 0.1);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = random.in_cube(0.7);
    EXPECT_NEAR(distance_at(still, p), distance_at(turned, turned_from_still.transform_point(p)),
                2 * still.interpolation_error());
  }
}

TEST(GridField, IsAsGoodAtTheFarEndOfTheLongestAxis) {
  // Eight thousand nodes, and an origin away from zero: the coarsest float32 places of all.
  Random random(82);
  const double h = 1.25e-4;
  const TriangleMesh rod = moved(make_box({0.499, 0.002, 0.001}), {0.6, 0.3, -0.2}).mesh();
  const GridField field = build(rod, h);
  EXPECT_GT(field.shape()[0], 7980);
  for (int i = 0; i < 20'000; ++i) {
    const double x = random.below(2) == 0 ? random.uniform(1.05, 1.0992) : random.uniform(0.1, 1.1);
    const Vec3 p{x, 0.3 + random.uniform(-0.0021, 0.0021), -0.2 + random.uniform(-0.0011, 0.0011)};
    const Vec3 q{std::abs(p.x - 0.6) - 0.499, std::abs(p.y - 0.3) - 0.002,
                 std::abs(p.z + 0.2) - 0.001};
    const double outside = length(Vec3{std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)});
    const double expected = outside + std::min(std::max({q.x, q.y, q.z}), 0.0);
    ASSERT_NEAR(distance_at(field, p), expected, field.interpolation_error() + 3e-7);
  }
}

TEST(GridField, ACavityIsOutside) {
  const Soup hollow = together(make_box({1, 1, 1}), inverted(make_box({0.5, 0.5, 0.5})));
  const GridField field = build(hollow.mesh(), 0.0625);
  EXPECT_EQ(field.distance({0, 0, 0}), 0.5f);
  EXPECT_EQ(field.distance({0.75f, 0, 0}), -0.25f);
  EXPECT_EQ(field.distance({0, 0, 1.0625f}), 0.0625f);
}

TEST(GridField, SeparateBodiesShareAField) {
  const Soup pair =
      together(make_box({0.5, 0.5, 0.5}), moved(make_box({0.5, 0.5, 0.5}), {2, 0, 0}));
  const GridField field = build(pair.mesh(), 0.125);
  EXPECT_EQ(field.distance({0, 0, 0}), -0.5f);
  EXPECT_EQ(field.distance({2, 0, 0}), -0.5f);
  EXPECT_EQ(field.distance({1, 0, 0}), 0.5f);
}

TEST(GridField, AnswersFarAwayWithoutTrouble) {
  const float infinity = std::numeric_limits<float>::infinity();
  const GridField field = build(bodies()[2].mesh, 0.07);
  for (const float far : {1e3f, 1e6f, 1e10f}) {
    for (const Vec3f& direction : {Vec3f{1, 0, 0}, Vec3f{0, -1, 0}, Vec3f{0.6f, 0, -0.8f}}) {
      const Vec3f p = far * direction;
      EXPECT_NEAR(field.distance(p), far, 1.0f + 1e-6f * far);
      const Vec3f gradient = field.gradient(p);
      EXPECT_GT(dot(gradient, direction), 0.999f);
      EXPECT_LE(field.lower_bound(p, 1.0f), field.distance(p));
      EXPECT_GT(field.lower_bound(p, 1.0f), 0.999f * far - 3.0f);
    }
  }
  for (const float far : {1e30f, std::numeric_limits<float>::max(), infinity}) {
    for (const Vec3f& p : {Vec3f{far, 0, 0}, Vec3f{-far, far, 0}, Vec3f{far, -far, far}}) {
      EXPECT_GE(field.distance(p), 1e18f);
      EXPECT_GE(field.lower_bound(p, 1.0f), 1e18f);
      field.gradient(p);
    }
  }
}

TEST(GridField, IsNotANumberWhereThePointIsNot) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const GridField field = build(make_box({1, 1, 1}).mesh(), 0.25);
  for (const Vec3f& p : {Vec3f{nan, 0, 0}, Vec3f{0, nan, 0}, Vec3f{0, 0, nan}}) {
    EXPECT_TRUE(std::isnan(field.distance(p)));
    field.gradient(p);
    field.lower_bound(p, 1.0f);
  }
}

bool is_outside(const Bounds& bounds, const Vec3& p) {
  for (int axis = 0; axis < 3; ++axis) {
    if (p[axis] < bounds.lower[axis] || p[axis] > bounds.upper[axis]) return true;
  }
  return false;
}

TEST(GridField, EightAtOnceAreAsOneByOne) {
  Random random(77);
  int outside = 0;
  for (const auto& [name, mesh, voxel_size] : bodies()) {
    const GridField field = build(mesh, voxel_size);
    const Bounds bounds = grown(grid_bounds(field), 0.3);
    for (int round = 0; round < 400; ++round) {
      EightPoints points;
      EightFloats radii{};
      for (std::size_t i = 0; i < radii.size(); ++i) {
        points.set(i, static_cast<Vec3f>(point_in(random, bounds)));
        radii[i] = static_cast<float>(random.uniform(0.0, 0.2));
      }
      if (round == 0) points.set(3, {std::numeric_limits<float>::quiet_NaN(), 0.0f, 0.0f});
      for (const simd::GridSampling<simd::GridView>* kernels :
           {&simd::grid_sampling<simd::GridView>(), &simd::kPortableGridSampling}) {
        EightFloats distances;
        EightFloats of_centers;
        EightFloats bounded;
        const auto* rows = reinterpret_cast<const float (*)[8]>(points.coordinates.data());
        kernels->measure_distances(field.view(), rows, distances.data());
        kernels->bound_balls(field.view(), rows, radii.data(), of_centers.data(), bounded.data());
        for (std::size_t i = 0; i < radii.size(); ++i) {
          const Vec3f p{points.coordinates[0][i], points.coordinates[1][i],
                        points.coordinates[2][i]};
          const float distance = field.distance(p);
          const float bound = field.lower_bound(p, radii[i]);
          if (std::isnan(distance)) {
            EXPECT_TRUE(std::isnan(distances[i]) && std::isnan(of_centers[i]));
            continue;
          }
          EXPECT_EQ(distances[i], distance) << name;
          EXPECT_EQ(of_centers[i], distance) << name;
          EXPECT_EQ(bounded[i], bound) << name;
          outside += is_outside(grid_bounds(field), static_cast<Vec3>(p));
        }
      }
      EXPECT_EQ(field.distances(points)[0],
                field.distance({points.coordinates[0][0], points.coordinates[1][0],
                                points.coordinates[2][0]}));
    }
  }
  EXPECT_GT(outside, 1000);
}

}  // namespace
}  // namespace voxshell::grid_field_test
