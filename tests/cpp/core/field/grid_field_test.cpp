#include "voxshell/grid_field.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/brute_force.h"
#include "support/grid_bricks.h"
#include "support/meshes.h"
#include "support/random.h"

namespace voxshell {
namespace {

using namespace test_support;

GridField build(const TriangleMesh& mesh, double voxel_size, double padding = 0.0) {
  auto field = GridField::build(mesh, {.voxel_size = voxel_size, .padding = padding});
  EXPECT_TRUE(field) << field.error().message;
  if (!field) std::abort();
  return *std::move(field);
}

void expect_error(const Result<GridField>& field, ErrorCode code, const std::string& reason) {
  ASSERT_FALSE(field) << "accepted, but expected: " << reason;
  EXPECT_EQ(field.error().code, code);
  EXPECT_NE(field.error().message.find(reason), std::string::npos) << field.error().message;
}

struct Body {
  const char* name;
  TriangleMesh mesh;
  double voxel_size;
};

/// About unit size. Turned out of the grid's axes, apart from the L-shape.
std::vector<Body> bodies() {
  Random random(70);
  const auto turned = [&](const Soup& soup) { return transformed(soup, random.pose(0.3)).mesh(); };
  std::vector<Body> all;
  all.push_back({"L-shape", make_l_shape(0.5).mesh(), 0.06});
  all.push_back({"torus", turned(make_torus(0.7, 0.25, 20, 12)), 0.07});
  all.push_back({"blob", turned(make_blob(0.6, 2)), 0.07});
  all.push_back({"wedge", turned(make_wedge(1.0, 0.08, 0.5)), 0.04});
  all.push_back({"spike", turned(make_spike(0.3, 1.2)), 0.05});
  all.push_back({"plate", turned(make_box({0.5, 0.4, 0.015})), 0.05});  // thinner than a voxel
  all.push_back({"hollow",
                 together(make_box({0.5, 0.5, 0.5}), inverted(make_box({0.35, 0.3, 0.25}))).mesh(),
                 0.05});
  return all;
}

Bounds grid_bounds(const GridField& field) {
  Bounds bounds;
  bounds.extend(field.origin());
  const auto [nx, ny, nz] = field.shape();
  bounds.extend(field.origin() + field.voxel_size() * Vec3{nx - 1.0, ny - 1.0, nz - 1.0});
  return bounds;
}

Vec3 point_in(Random& random, const Bounds& bounds) {
  return random.in_box(bounds.lower, bounds.upper);
}

Bounds grown(const Bounds& bounds, double by) {
  const Vec3 margin{by, by, by};
  return {bounds.lower - margin, bounds.upper + margin};
}

bool is_in(const Bounds& bounds, const Vec3f& p) {
  return squared_distance(bounds, static_cast<Vec3>(p)) == 0.0;
}

/// As GridFieldData::bounds says it.
double lowest_in(const GridField& field, std::size_t brick) {
  return static_cast<double>(std::bit_cast<float>(field.data().bounds[brick] & 0xffff0000u));
}
double local_constant(const GridField& field, std::size_t brick) {
  return static_cast<double>(std::bit_cast<float>(field.data().bounds[brick] << 16));
}
bool has_local_constant(const GridField& field, std::size_t brick) {
  return local_constant(field, brick) < 1e29;
}

double distance_at(const GridField& field, const Vec3& p) {
  return static_cast<double>(field.distance(static_cast<Vec3f>(p)));
}

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
    EXPECT_EQ(data.bounds.size(), data.entries.size());
    EXPECT_EQ(field.nbytes(),
              8 * data.entries.size() + 2 * data.samples.size() + 4 * data.planes.size());
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
      visit_nodes(field, brick, [&](const Vec3& p, double value) {
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
    const float jump = static_cast<float>(field.data().jump);
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
      const bool is_continuous = has_local_constant(field, brick_at(field, p));
      for (int k = 0; k < 6; ++k) {
        const Vec3f there = here + step * static_cast<Vec3f>(random.direction());
        const float allowed =
            is_continuous ? jump : 2.0f * static_cast<float>(8.0 * field.interpolation_error());
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

TEST(GridField, LocalConstantsBoundEveryPairAroundABrick) {
  Random random(77);
  // Between flat faces, where neighbours hold planes or agree to a quantum.
  std::vector<Body> flat;
  flat.push_back({"box", make_box({0.5, 0.4, 0.6}).mesh(), 0.02});
  flat.push_back({"turned", transformed(make_box({0.5, 0.4, 0.6}), random.pose(1.0)).mesh(), 0.02});
  flat.push_back({"L-shape", make_l_shape(0.5).mesh(), 0.02});
  for (const auto& [name, mesh, voxel_size] : flat) {
    const GridField field = build(mesh, voxel_size, 2 * voxel_size);
    const Bounds bounds = grid_bounds(field);
    const double reach = 8.0 * voxel_size;
    double steepest = 0.0;
    int checked = 0;
    for (int i = 0; i < 100'000; ++i) {
      const Vec3 p = point_in(random, bounds);
      const Vec3 q =
          p + random.unit() * (i % 2 == 0 ? 0.5 * voxel_size : reach) * random.direction();
      const std::size_t brick = brick_at(field, p);
      if (!has_local_constant(field, brick)) continue;
      ++checked;
      const double constant = local_constant(field, brick);
      const double apart = length(p - q);
      // Values outside the grid are never below that of its nearest point.
      const double change = distance_at(field, p) - distance_at(field, q);
      const double allowed = constant * apart + field.data().jump + 1e-6;
      ASSERT_LE(change, allowed) << name;
      if (is_in(bounds, static_cast<Vec3f>(q))) {
        ASSERT_GE(change, -allowed) << name;
      }
      steepest = std::max(
          steepest, length(static_cast<Vec3>(field.gradient(static_cast<Vec3f>(p)))) / constant);
    }
    EXPECT_GT(checked, 10'000) << name;
    EXPECT_LE(steepest, 1.0 + 1e-5) << name;
    EXPECT_GT(steepest, 0.75) << name;  // a constant far too large would prune nothing
  }
}

TEST(GridField, LocalConstantIsOneBesideAFaceAndMoreAroundAnEdge) {
  const GridField field = build(make_box({1, 1, 1}).mesh(), 0.02);
  const double face = local_constant(field, brick_at(field, Vec3{0.01, 0.01, 1.01}));
  EXPECT_GE(face, 1.0);
  EXPECT_LE(face, 1.02);  // to bfloat16
  // Inside, the two slopes that meet over an edge are mixed: up to sqrt(2) of either.
  for (std::size_t brick = 0; brick < field.data().entries.size(); ++brick) {
    if (!has_local_constant(field, brick)) continue;
    EXPECT_GE(local_constant(field, brick), 1.0);
    EXPECT_LE(local_constant(field, brick), std::sqrt(3.0) * 1.02);
  }
}

TEST(GridField, BoundsOfBricksHoldAndAreClose) {
  Random random(84);
  for (const auto& [name, mesh, voxel_size] : bodies()) {
    const GridField field = build(mesh, voxel_size);
    for (std::size_t brick = 0; brick < field.data().entries.size(); ++brick) {
      double lowest = 1e30;
      visit_nodes(field, brick,
                  [&](const Vec3&, double value) { lowest = std::min(lowest, value); });
      const double expected = lowest - field.interpolation_error() * cell_size_of(field, brick);
      ASSERT_LE(lowest_in(field, brick), expected + 1e-9) << name;
      ASSERT_GE(lowest_in(field, brick), expected - 0.01 * std::abs(expected)) << name;
    }
  }
}

/// The smallest value that can be found in a ball: at random, downhill, and at the grid's nodes.
float find_smallest(const GridField& field, const Vec3& centre, double radius, Random& random) {
  float smallest = field.distance(static_cast<Vec3f>(centre));
  const auto try_point = [&](const Vec3& p) {
    const Vec3 away = p - centre;
    const double far = length(away);
    // Stay within the ball also after rounding.
    const Vec3 clamped = far > radius ? centre + (radius * (1.0 - 1e-7) / far) * away : p;
    smallest = std::min(smallest, field.distance(static_cast<Vec3f>(clamped)));
    return clamped;
  };
  for (int i = 0; i < 10; ++i) {
    try_point(centre + radius * random.direction());
    try_point(centre + (radius * random.unit()) * random.direction());
  }
  for (int start = 0; start < 3; ++start) {
    Vec3 p = start == 0 ? centre : try_point(centre + radius * random.direction());
    for (int i = 0; i < 12; ++i) {
      const Vec3f slope = field.gradient(static_cast<Vec3f>(p));
      p = try_point(p - (radius / (1 + i / 3)) * static_cast<Vec3>(slope));
    }
  }
  const double h = field.voxel_size();
  Vec3 low = centre - Vec3{radius, radius, radius} - field.origin();
  for (int i = 0; i < 20; ++i) {
    Vec3 node;
    for (int axis = 0; axis < 3; ++axis) {
      const double cells = std::ceil(low[axis] / h) + std::floor(random.unit() * 2.0 * radius / h);
      node[axis] = field.origin()[axis] + cells * h;
    }
    if (length(node - centre) < radius) try_point(node);
  }
  return smallest;
}

TEST(GridField, LowerBoundHoldsInAcrossAndOutsideTheGrid) {
  Random random(78);
  for (const auto& [name, mesh, voxel_size] : bodies()) {
    const GridField field = build(mesh, voxel_size, 2 * voxel_size);
    const Bounds bounds = grid_bounds(field);
    int in_the_grid = 0;
    int across = 0;
    int outside = 0;
    int deep = 0;
    double slack = 0.0;
    for (int i = 0; i < 4000; ++i) {
      const Vec3 centre = point_in(random, grown(bounds, i % 4 == 0 ? 1.0 : 0.0));
      const double radius = std::pow(10.0, random.uniform(-3, 0));
      const auto centre_f = static_cast<Vec3f>(centre);
      const float bound = field.lower_bound(centre_f, static_cast<float>(radius));
      const float smallest = find_smallest(field, static_cast<Vec3>(centre_f), radius, random);
      ASSERT_GE(smallest, bound - 2e-6f) << name << " at " << centre.x << " " << centre.y << " "
                                         << centre.z << ", radius " << radius;
      const bool centre_in = is_in(bounds, centre_f);
      const bool ball_in = is_in(Bounds{bounds.lower + Vec3{radius, radius, radius},
                                        bounds.upper - Vec3{radius, radius, radius}},
                                 centre_f);
      in_the_grid += ball_in;
      across += centre_in && !ball_in;
      outside += !centre_in;
      deep += smallest < -static_cast<float>(voxel_size);
      const std::size_t brick = brick_at(field, centre);
      if (ball_in && radius < voxel_size && has_local_constant(field, brick)) {
        const double jump = field.data().jump;
        const double missing = static_cast<double>(smallest - bound) - jump - 1e-6;
        slack = std::max(slack, missing / (radius * local_constant(field, brick)));
      }
    }
    EXPECT_GT(in_the_grid, 500) << name;
    EXPECT_GT(across, 300) << name;
    EXPECT_GT(outside, 300) << name;
    if (std::string_view(name) != "plate" && std::string_view(name) != "wedge") {
      EXPECT_GT(deep, 100) << name;
    }
    // A useless bound holds, too: small balls in the grid must be answered tightly.
    EXPECT_LT(slack, 2.0) << name;
  }
}

TEST(GridField, LowerBoundOfABallDeepInsideIsBelowZero) {
  // Regression: the distance to the surface's bounds, which is 0 in there, is no bound inside.
  const GridField field = build(make_box({1, 1, 1}).mesh(), 0.1);
  EXPECT_LE(field.lower_bound({0, 0, 0}, 0.01f), -0.99f);
  EXPECT_GE(field.lower_bound({0, 0, 0}, 0.01f), -2.0f);
}

TEST(GridField, LowerBoundIsTightFarAway) {
  const GridField field = build(make_box({1, 1, 1}).mesh(), 0.1);
  // The surface may be to the side of what the grid's border sees.
  EXPECT_GE(field.lower_bound({101, 0, 0}, 1.0f), 99.0f - 2.0f);
  EXPECT_LE(field.lower_bound({101, 0, 0}, 1.0f), 99.0f);
}

TEST(GridField, SamplesAreTheSameBitsWithAnyNumberOfThreads) {
  const TriangleMesh mesh = bodies()[1].mesh;
  const auto build_with = [&](unsigned threads) {
    auto field = GridField::build(mesh, {.voxel_size = 0.05, .threads = threads});
    EXPECT_TRUE(field);
    return *std::move(field);
  };
  const GridFieldData one = build_with(1).data();
  for (const unsigned threads : {2u, 7u, 0u}) {
    const GridFieldData other = build_with(threads).data();
    EXPECT_EQ(other.entries, one.entries);
    EXPECT_EQ(other.bounds, one.bounds);
    EXPECT_EQ(other.samples, one.samples);
    EXPECT_EQ(other.planes, one.planes);
    EXPECT_EQ(other.error, one.error);
    EXPECT_EQ(other.jump, one.jump);
    EXPECT_EQ(other.coarse_floor, one.coarse_floor);
  }
}

TEST(GridField, HoldsPlanesWhereAFaceIsFlat) {
  Random random(85);
  for (const Pose& pose : {Pose{}, random.pose(0.5), random.pose(2.0)}) {
    const TriangleMesh mesh = transformed(make_box({0.5, 0.4, 0.3}), pose).mesh();
    const double h = 0.01;
    const GridField field = build(mesh, h);
    const std::size_t bricks = field.data().entries.size();
    EXPECT_EQ(field.data().planes.size(), 4u * 6u);  // one a face, shared by its bricks
    std::size_t planes = 0;
    for (std::size_t brick = 0; brick < bricks; ++brick) {
      if (!entry_of(field, brick).is_plane) continue;
      ++planes;
      visit_nodes(field, brick, [&](const Vec3& p, double value) {
        if (random.below(2000) == 0) {
          ASSERT_NEAR(value, signed_distance_to_mesh(p, mesh), h / 512);
        }
      });
    }
    EXPECT_GT(planes, 0.4 * static_cast<double>(bricks));
  }
}

TEST(GridField, PlanesSayHowFarAroundThemTheyHold) {
  const GridField field = build(make_box({0.5, 0.4, 0.3}).mesh(), 0.01);
  const auto& [nx, ny, nz] = field.data().bricks;
  const auto entry_at = [&](int x, int y, int z) {
    return entry_of(field, static_cast<std::size_t>(x + nx * (y + ny * z)));
  };
  int largest = 0;
  for (int z = 0; z < nz; ++z) {
    for (int y = 0; y < ny; ++y) {
      for (int x = 0; x < nx; ++x) {
        const BrickEntry entry = entry_at(x, y, z);
        if (!entry.is_plane) continue;
        const auto holds = [&](int radius) {
          if (std::min({x, y, z, nx - 1 - x, ny - 1 - y, nz - 1 - z}) < radius) return false;
          for (int c = -radius; c <= radius; ++c) {
            for (int b = -radius; b <= radius; ++b) {
              for (int a = -radius; a <= radius; ++a) {
                const BrickEntry other = entry_at(x + a, y + b, z + c);
                if (!other.is_plane || other.first != entry.first) return false;
              }
            }
          }
          return true;
        };
        ASSERT_TRUE(holds(entry.radius));
        ASSERT_TRUE(entry.radius == simd::kFieldMask || !holds(entry.radius + 1));
        largest = std::max(largest, entry.radius);
      }
    }
  }
  EXPECT_GE(largest, 1);
}

TEST(GridField, ACavityUnderAFaceIsSeenThroughNoPlane) {
  const Soup cavity = inverted(moved(make_box({0.1, 0.1, 0.1}), {0, 0, 0.3}));
  const GridField field = build(together(make_box({0.5, 0.5, 0.5}), cavity).mesh(), 0.02);
  EXPECT_NEAR(field.distance({0, 0, 0.47f}), -0.03f, 2e-4f);
  EXPECT_NEAR(field.distance({0, 0, 0.41f}), -0.01f, 2e-4f);
  EXPECT_NEAR(field.distance({0.15f, 0, 0.3f}), -0.05f, 2e-3f);
}

TEST(GridField, TakesFarMoreThreadsThanASystemGives) {
  const auto field =
      GridField::build(make_box({1, 1, 1}).mesh(), {.voxel_size = 0.02, .threads = 4'000'000'000u});
  ASSERT_TRUE(field);
  EXPECT_NEAR(field->distance({0, 0, 3}), 2.0f, 1e-6f);
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

TEST(GridField, RefusesSettingsThatMakeNoSense) {
  const TriangleMesh mesh = make_box({1, 1, 1}).mesh();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double voxel_size : {0.0, -0.1, nan, infinity}) {
    expect_error(GridField::build(mesh, {.voxel_size = voxel_size}), ErrorCode::kInvalidArgument,
                 "voxel size must be above 0 m");
  }
  for (const double padding : {-0.1, nan, infinity}) {
    expect_error(GridField::build(mesh, {.voxel_size = 0.1, .padding = padding}),
                 ErrorCode::kInvalidArgument, "padding must be at least 0 m");
  }
  expect_error(GridField::build(mesh, {.voxel_size = -0.25}), ErrorCode::kInvalidArgument, "-0.25");
}

TEST(GridField, RefusesOpenAndInsideOutMeshes) {
  Soup open = make_box({1, 1, 1});
  open.triangles.pop_back();
  expect_error(GridField::build(open.mesh(), {.voxel_size = 0.1, .sign = SignMethod::kClosed}),
               ErrorCode::kInvalidMesh, "3 open");
  expect_error(GridField::build(inverted(make_box({1, 1, 1})).mesh(),
                                {.voxel_size = 0.1, .sign = SignMethod::kClosed}),
               ErrorCode::kInvalidMesh, "inside out");
}

TEST(GridField, RefusesAGridBeyondTheMemoryLimitAndAdvisesASizeThatFits) {
  Random random(80);
  for (int trial = 0; trial < 20; ++trial) {
    const Vec3 half{random.uniform(0.05, 1), random.uniform(0.05, 1), random.uniform(0.05, 1)};
    const TriangleMesh mesh = make_box(half).mesh();
    GridFieldSettings settings{.voxel_size = random.uniform(1e-4, 2e-3)};
    settings.memory_limit = static_cast<std::size_t>(std::pow(10.0, random.uniform(4.7, 6.5)));
    const auto refused = GridField::build(mesh, settings);
    expect_error(refused, ErrorCode::kTooLarge, "GB");
    if (refused) return;
    const std::string& message = refused.error().message;
    const std::string before_number = "use a voxel size of at least ";
    const std::size_t at = message.find(before_number);
    ASSERT_NE(at, std::string::npos) << message;
    settings.voxel_size = std::stod(message.substr(at + before_number.size()));
    const auto built = GridField::build(mesh, settings);
    ASSERT_TRUE(built) << "advised: " << message << "\nthen: " << built.error().message;
    EXPECT_LE(built->nbytes(), settings.memory_limit);
  }
}

TEST(GridField, RefusesMoreNodesAlongAnAxisThanFloat32CanNumber) {
  const TriangleMesh rod = make_box({1.0, 0.001, 0.001}).mesh();
  expect_error(GridField::build(rod, {.voxel_size = 1e-4}), ErrorCode::kTooLarge, "voxel size of");
  EXPECT_TRUE(GridField::build(rod, {.voxel_size = 4e-4}));
  // Numbers that overflow any count.
  expect_error(GridField::build(rod, {.voxel_size = 1e-300}), ErrorCode::kTooLarge,
               "voxel size of");
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

TEST(GridField, RefusesOverlappingBodies) {
  const Soup sphere = make_icosphere(0.5, 3);
  const Soup overlapping = together(sphere, moved(sphere, {0.6, 0.1, 0.05}));
  expect_error(
      GridField::build(overlapping.mesh(), {.voxel_size = 0.05, .sign = SignMethod::kClosed}),
      ErrorCode::kInvalidMesh, "overlaps itself");
}

TEST(GridField, RefusesNestedBodies) {
  const Soup nested = together(make_box({1, 1, 1}), make_box({0.5, 0.5, 0.5}));
  expect_error(GridField::build(nested.mesh(), {.voxel_size = 0.1, .sign = SignMethod::kClosed}),
               ErrorCode::kInvalidMesh, "overlaps itself");
}

TEST(GridField, RefusesABodyInsideOutBesideAnother) {
  const Soup pair =
      together(make_box({1, 1, 1}), moved(inverted(make_box({0.5, 0.5, 0.5})), {3, 0, 0}));
  expect_error(GridField::build(pair.mesh(), {.voxel_size = 0.1, .sign = SignMethod::kClosed}),
               ErrorCode::kInvalidMesh, "inside out");
}

TEST(GridField, ASpeckInsideOutThatIsSmallerThanAVoxelDoesNoHarm) {
  const Soup speck = moved(inverted(make_box({0.05, 0.05, 0.05})), {2, 0, 0});
  const GridField field = build(together(make_box({1, 1, 1}), speck).mesh(), 0.25);
  EXPECT_NEAR(field.distance({2, 0, 0}), 0.05f, 5e-4f);  // a node, and not inside of anything
  EXPECT_EQ(field.distance({0, 0, 0}), -1.0f);
}

TEST(GridField, NamesAPlaceInTheOverlap) {
  const Soup overlapping =
      together(make_box({1, 1, 1}), moved(make_box({0.3, 0.3, 0.3}), {1.01, 0.5, 0.25}));
  const auto field =
      GridField::build(overlapping.mesh(), {.voxel_size = 0.05, .sign = SignMethod::kClosed});
  ASSERT_FALSE(field);
  const std::string& message = field.error().message;
  const std::size_t at = message.find("near [");
  ASSERT_NE(at, std::string::npos) << message;
  double x = 0;
  double y = 0;
  double z = 0;
  ASSERT_EQ(std::sscanf(message.c_str() + at, "near [%lf, %lf, %lf]", &x, &y, &z), 3) << message;
  EXPECT_TRUE(x > 0.7 && x < 1.0 && y > 0.2 && y < 0.8 && z > -0.05 && z < 0.55) << message;
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

TEST(GridField, StopsWhereProgressSaysSo) {
  const TriangleMesh mesh = make_box({1, 1, 1}).mesh();
  int calls = 0;
  const auto stopped =
      GridField::build(mesh, {.voxel_size = 0.05}, [&](std::string_view stage, double fraction) {
        EXPECT_EQ(stage, "distance field");
        EXPECT_GE(fraction, 0.0);
        EXPECT_LE(fraction, 1.0);
        ++calls;
        return false;
      });
  expect_error(stopped, ErrorCode::kCancelled, "stopped");
  EXPECT_EQ(calls, 1);
}

TEST(GridField, ReportsProgressUpToTheEnd) {
  double last = -1.0;
  const auto field = GridField::build(make_blob(1, 3).mesh(), {.voxel_size = 0.03, .threads = 2},
                                      [&](std::string_view, double fraction) {
                                        EXPECT_GE(fraction, last);
                                        last = fraction;
                                        return true;
                                      });
  ASSERT_TRUE(field);
  EXPECT_EQ(last, 1.0);
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

TEST(GridField, ReachHoldsTheGrid) {
  for (const auto& [name, mesh, voxel_size] : bodies()) {
    const GridField field = build(mesh, voxel_size);
    const Bounds bounds = grid_bounds(field);
    EXPECT_GE(field.reach(), std::max(length(bounds.lower), length(bounds.upper)));
  }
}

}  // namespace
}  // namespace voxshell
