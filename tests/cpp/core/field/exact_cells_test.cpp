#include "field/exact_cells.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "field/grid_field_check.h"
#include "mesh/closest_point.h"
#include "simd/grid_formula.h"
#include "support/brute_force.h"
#include "support/grid_fields.h"
#include "support/meshes.h"
#include "support/pairs.h"
#include "support/random.h"
#include "voxshell/contacts.h"
#include "voxshell/contacts_flat.h"
#include "voxshell/grid_field.h"

namespace voxshell::exact_cells_test {
namespace {

using namespace test_support;

GridField build_exact(const TriangleMesh& mesh, double voxel_size, double tolerance,
                      unsigned threads = 0) {
  auto field = GridField::build(mesh, {.voxel_size = voxel_size,
                                       .tolerance = tolerance,
                                       .padding = 2.0 * voxel_size,
                                       .threads = threads});
  EXPECT_TRUE(field) << field.error().message;
  if (!field) std::abort();
  return *std::move(field);
}

Vec3 point_on(const TriangleMesh& mesh, Random& random) {
  const auto [a, b, c] = mesh.corners(
      static_cast<std::size_t>(random.unit() * static_cast<double>(mesh.triangles().size())));
  double u = random.unit();
  double v = random.unit();
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  return a + u * (b - a) + v * (c - a);
}

TEST(ExactCells, AreNoneWithoutATolerance) {
  EXPECT_FALSE(build(make_box({1, 1, 1}).mesh(), 0.1).has_exact_cells());
}

TEST(ExactCells, BringTheSurfaceWithinTheTolerance) {
  Random random(301);
  for (const auto& [name, mesh, voxel_size] : bodies()) {
    const double tolerance = 0.02 * voxel_size;
    const GridField field = build_exact(mesh, voxel_size, tolerance);
    const GridField uniform = build(mesh, voxel_size);
    ASSERT_TRUE(field.has_exact_cells()) << name;
    double worst = 0.0;
    double worst_uniform = 0.0;
    for (int i = 0; i < 20'000; ++i) {
      const auto p = static_cast<Vec3f>(point_on(mesh, random));
      worst = std::max(worst, static_cast<double>(std::abs(field.distance(p))));
      worst_uniform = std::max(worst_uniform, static_cast<double>(std::abs(uniform.distance(p))));
    }
    EXPECT_LT(worst, 1.4 * tolerance + field.data().node_error) << name;
    if (std::string_view(name) == "hollow") continue;  // its faces lie along the grid
    EXPECT_GT(worst_uniform, 2.0 * tolerance) << name << ": the test asks for nothing";
  }
}

/// A box with a vertex amid an edge of one of its faces, `aside` of it, and a needle in between.
Soup make_box_with_needle(double half, const Vec3& aside) {
  Soup soup = make_box({half, half, half});
  // The first of the sides' triangles has the lower edge of its face.
  const std::size_t at = soup.triangles.size() - 8;
  const auto [a, b, c] = soup.triangles[at];
  const auto middle = static_cast<std::uint32_t>(soup.vertices.size());
  soup.vertices.push_back(0.5 * (soup.vertices[a] + soup.vertices[b]) + aside);
  soup.triangles[at] = {a, middle, c};
  soup.triangles.push_back({middle, b, c});
  soup.triangles.push_back({a, b, middle});
  return soup;
}

TEST(ExactCells, AreNotTurnedByNeedlesAlongEdges) {
  const double half = 0.05;
  for (const double aside : {0.0, 1e-17, 1e-12, 1e-9}) {
    const TriangleMesh mesh = make_box_with_needle(half, aside * Vec3{1.0, 0.5, 0.3}).mesh();
    ASSERT_TRUE(mesh.compute_defects().is_closed());
    const GridField field = build_exact(mesh, 0.001, 2e-5);
    const Vec3 middle = mesh.vertices().back();
    Random random(311);
    for (int i = 0; i < 5'000; ++i) {
      const Vec3 p = middle + random.in_cube(0.002);
      const Vec3 q{std::abs(p.x) - half, std::abs(p.y) - half, std::abs(p.z) - half};
      const Vec3 outside{std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)};
      const double expected = length(outside) + std::min(std::max({q.x, q.y, q.z}), 0.0);
      // Deeper, samples round the ridge off.
      ASSERT_NEAR(field.distance(static_cast<Vec3f>(p)), expected, 4e-4) << aside;
    }
  }
}

TEST(ExactCells, LeaveCellsThatAreProvedToBeRight) {
  Random random(310);
  for (const auto& [name, mesh, voxel_size] : bodies()) {
    const double tolerance = 0.05 * voxel_size;
    const GridField field = build_exact(mesh, voxel_size, tolerance);
    const double proved = field.surface_error();
    EXPECT_LE(proved, 2.0 * 0.7 * tolerance + field.data().node_error) << name;
    EXPECT_LT(proved, 0.2 * field.interpolation_error()) << name;
    double worst = 0.0;
    for (int i = 0; i < 20'000; ++i) {
      const Vec3 p = point_on(mesh, random);
      worst = std::max(worst, static_cast<double>(std::abs(field.distance(static_cast<Vec3f>(p)))));
      if (i % 10 != 0) continue;
      const Vec3 near = p + random.uniform(0.0, 2.0) * proved * random.direction();
      const double truth = signed_distance_to_mesh(near, mesh);
      const bool is_inside = field.distance(static_cast<Vec3f>(near)) < 0.0f;
      if (is_inside != (truth < 0.0)) worst = std::max(worst, std::abs(truth));
    }
    EXPECT_LE(worst, proved) << name;
    if (std::string_view(name) == "hollow" || std::string_view(name) == "torus") continue;
    EXPECT_GT(worst, 0.1 * proved) << name << ": the test asks for nothing";
  }
  const auto uniform = build(make_box({1, 1, 1}).mesh(), 0.1);
  EXPECT_EQ(uniform.surface_error(), uniform.interpolation_error());
}

/// The fraction of places inside a box, aslant in its grid, where the gradient is more than 10
/// degrees off the normal of the nearest face, or of one that is almost as near.
double fraction_of_wrong_normals(double wall_thickness) {
  constexpr double kVoxel = 0.02;
  const Vec3 half{0.5, 0.4, 5.0 * kVoxel};
  Random random(311);
  const Matrix3 turned = random.rotation();
  const TriangleMesh mesh = transformed(make_box(half), Pose{turned, {}}).mesh();
  const auto field = GridField::build(mesh, {.voxel_size = kVoxel,
                                             .tolerance = 0.02 * kVoxel,
                                             .wall_thickness = wall_thickness,
                                             .padding = 2.0 * kVoxel});
  EXPECT_TRUE(field) << field.error().message;
  constexpr int kPlaces = 20'000;
  int wrong = 0;
  for (int i = 0; i < kPlaces; ++i) {
    const Vec3 p{random.uniform(-half.x, half.x), random.uniform(-half.y, half.y),
                 random.uniform(-half.z, half.z)};
    const Vec3 gradient =
        turned.transposed() * static_cast<Vec3>(field->gradient(static_cast<Vec3f>(turned * p)));
    const Vec3 depths{half.x - std::abs(p.x), half.y - std::abs(p.y), half.z - std::abs(p.z)};
    const double nearest = std::min({depths.x, depths.y, depths.z});
    double cosine = -1.0;
    for (int axis = 0; axis < 3; ++axis) {
      if (depths[axis] > nearest + 0.02 * kVoxel) continue;
      // In the very middle either side is as near.
      const double along = std::abs(p[axis]) < 0.01 * kVoxel
                               ? std::abs(gradient[axis])
                               : std::copysign(1.0, p[axis]) * gradient[axis];
      cosine = std::max(cosine, along / length(gradient));
    }
    wrong += cosine > 0.985 ? 0 : 1;
  }
  return static_cast<double>(wrong) / kPlaces;
}

TEST(ExactCells, HoldTheNormalsOfTheNearestFaceUpToTheMiddleOfAWall) {
  EXPECT_LT(fraction_of_wrong_normals(0.2), 0.01);
  EXPECT_GT(fraction_of_wrong_normals(0.0), 0.03) << "the test asks for nothing";
}

TEST(ExactCells, HaveTheNormalsOfThinWalls) {
  const Vec3 half{0.5, 0.4, 0.015};
  const GridField field = build_exact(make_box(half).mesh(), 0.05, 0.001);
  Random random(302);
  for (int i = 0; i < 2'000; ++i) {
    const double depth = random.uniform(0.0005, 0.014);
    const double side = i % 2 == 0 ? 1.0 : -1.0;
    const Vec3 p{random.uniform(-0.4, 0.4), random.uniform(-0.3, 0.3), side * (half.z - depth)};
    EXPECT_NEAR(field.distance(static_cast<Vec3f>(p)), -depth, 2e-6);
    const Vec3f normal = field.gradient(static_cast<Vec3f>(p));
    EXPECT_NEAR(normal.z, side, 1e-5);
  }
}

TEST(ExactCells, SeeWallsThinnerThanASamplesUnit) {
  // Regression: samples are rounded to a 256th of a voxel, which filled in a plate of a 200th.
  const Vec3 half{0.5, 0.5, 0.0001};
  const GridField field = build_exact(make_box(half).mesh(), 0.04, 0.00001);
  Random random(306);
  for (int i = 0; i < 2'000; ++i) {
    const double z = random.uniform(-0.0005, 0.0005);
    const Vec3 p{random.uniform(-0.45, 0.45), random.uniform(-0.45, 0.45), z};
    ASSERT_NEAR(field.distance(static_cast<Vec3f>(p)), std::abs(z) - half.z, 5e-6);
  }
}

TEST(ExactCells, TellInsideFromOutsideAtEdgesAndCorners) {
  const Vec3 half{0.3, 0.2, 0.25};
  const GridField field = build_exact(make_box(half).mesh(), 0.07, 1e-4);
  Random random(303);
  for (int i = 0; i < 20'000; ++i) {
    // About a corner, an edge or a face.
    Vec3 p;
    for (int axis = 0; axis < 3; ++axis) {
      p[axis] = (random.unit() < 0.5 ? 1.0 : -1.0) *
                (half[axis] - (random.unit() < 0.7 ? random.uniform(-0.03, 0.03) : 0.1));
    }
    Vec3 outside;
    double deepest = -1.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double beyond = std::abs(p[axis]) - half[axis];
      outside[axis] = std::max(beyond, 0.0);
      deepest = std::max(deepest, beyond);
    }
    const double truth = deepest > 0.0 ? length(outside) : deepest;
    ASSERT_NEAR(field.distance(static_cast<Vec3f>(p)), truth, 4e-4 + 0.1 * std::abs(truth));
    if (std::abs(truth) > 4e-4) {
      ASSERT_EQ(field.distance(static_cast<Vec3f>(p)) < 0.0f, truth < 0.0);
    }
  }
}

TEST(ExactCells, AreTheSameForAnyNumberOfThreads) {
  const TriangleMesh mesh = make_blob(0.6, 2).mesh();
  const GridFieldData one = build_exact(mesh, 0.07, 1e-3, 1).data();
  for (const unsigned threads : {2u, 5u}) {
    const GridFieldData other = build_exact(mesh, 0.07, 1e-3, threads).data();
    EXPECT_EQ(one.exact.bricks, other.exact.bricks);
    EXPECT_EQ(one.exact.masks, other.exact.masks);
    EXPECT_EQ(one.exact.lists, other.exact.lists);
    EXPECT_EQ(one.exact.feature_normals, other.exact.feature_normals);
  }
}

TEST(ExactCells, KeepTheLowerBoundOfBalls) {
  Random random(304);
  for (const auto& [name, mesh, voxel_size] : bodies()) {
    const GridField field = build_exact(mesh, voxel_size, 0.02 * voxel_size);
    const Bounds bounds = grown(mesh.bounds(), voxel_size);
    for (int i = 0; i < 10'000; ++i) {
      const Vec3 center = static_cast<Vec3>(static_cast<Vec3f>(point_in(random, bounds)));
      const double radius = voxel_size * std::pow(10.0, random.uniform(-3, 0.5));
      const float bound = field.lower_bound(static_cast<Vec3f>(center), static_cast<float>(radius));
      Vec3 p = center;
      for (int step = 0; step < 16; ++step) {
        ASSERT_GE(field.distance(static_cast<Vec3f>(p)), bound - 2e-6f) << name;
        const Vec3 slope = step % 4 == 3 ? random.direction()
                                         : static_cast<Vec3>(field.gradient(static_cast<Vec3f>(p)));
        p = p - (radius / (1 + step / 3)) * slope;
        const double far = length(p - center);
        if (far > radius) p = center + (radius * (1.0 - 1e-6) / far) * (p - center);
      }
    }
  }
}

/// What kernels leave out places by, of eight balls about a place. Returns how many bounds are
/// larger than those of lower_bound().
template <class View>
int expect_tight_bounds(const GridField& field, const View& view, const Vec3& center, double radius,
                        Random& random) {
  using namespace simd::portable;
  Triple<F8> places{};
  for (int lane = 0; lane < kLanes; ++lane) {
    const auto p = static_cast<Vec3f>(center + (lane % 4) * radius * random.direction());
    set_lane(places, lane, {p.x, p.y, p.z});
  }
  const auto radius_f = static_cast<float>(radius);
  const F8 bounds = evaluate_tight_bound(view, places, splat<F8>(radius_f), simd::kBrickCells);
  int larger = 0;
  for (int lane = 0; lane < kLanes; ++lane) {
    const Vec3f at{places.x[lane], places.y[lane], places.z[lane]};
    larger += bounds[lane] > field.lower_bound(at, radius_f) ? 1 : 0;
    Vec3 p = static_cast<Vec3>(at);
    for (int step = 0; step < 8; ++step) {
      EXPECT_GE(field.distance(static_cast<Vec3f>(p)), bounds[lane] - 2e-6f);
      const Vec3 slope = step % 4 == 3 ? random.direction()
                                       : static_cast<Vec3>(field.gradient(static_cast<Vec3f>(p)));
      p = static_cast<Vec3>(at) - (radius * (1.0 - 1e-6)) * normalized(slope);
    }
  }
  return larger;
}

TEST(ExactCells, AndSamplesKeepTheTightBoundsOfBalls) {
  Random random(306);
  int larger = 0;
  for (const auto& [name, mesh, voxel_size] : bodies()) {
    const GridField exact = build_exact(mesh, voxel_size, 0.02 * voxel_size);
    const GridField sampled = build(mesh, voxel_size);
    const Bounds bounds = grown(mesh.bounds(), voxel_size);
    for (int i = 0; i < 2000; ++i) {
      const Vec3 center = point_in(random, bounds);
      const double radius = voxel_size * std::pow(10.0, random.uniform(-3, -0.3));
      larger += expect_tight_bounds(exact, exact.exact_view(), center, radius, random);
      larger += expect_tight_bounds(sampled, sampled.view(), center, radius, random);
      if (testing::Test::HasFailure()) {
        ADD_FAILURE() << name;
        return;
      }
    }
  }
  EXPECT_GT(larger, 10'000);
}

TEST(ExactCells, GiveTheContactsOfTheFlatLoopToTheBit) {
  Random random(305);
  const PointShell shell = make_shell(make_torus(0.3, 0.1, 30, 16), 0.03);
  QueryScratch scratch;
  int hits = 0;
  for (const auto& [name, mesh, voxel_size] : bodies()) {
    const Field field = build_exact(mesh, voxel_size, 0.02 * voxel_size);
    ASSERT_TRUE(std::get<GridField>(field).has_exact_cells());
    Pose pose;
    for (int i = 0; i < 400; ++i) {
      if (i % 4 == 0) {
        pose = {random.rotation(), random.uniform(0.0, 0.9) * random.direction()};
      } else {  // near the last one, so that the scratch serves
        pose.translation += 1e-4 * random.direction();
      }
      const float margin = i % 3 == 0 ? 0.0f : static_cast<float>(random.uniform(-0.02, 0.1));
      const auto contacts = find_contacts(field, shell, pose, {.margin = margin}, scratch);
      const auto flat = find_contacts_flat(field, shell, pose, {.margin = margin});
      ASSERT_EQ(contacts.size(), flat.size()) << name;
      for (std::size_t k = 0; k < flat.size(); ++k) ASSERT_EQ(contacts[k], flat[k]) << name;
      ASSERT_EQ(collides(field, shell, pose, margin), !flat.empty()) << name;
      hits += !flat.empty();
    }
  }
  EXPECT_GT(hits, 1000);
}

TEST(ExactCells, OfFilesMustBeSound) {
  const GridFieldData sound = build_exact(make_box({0.5, 0.4, 0.015}).mesh(), 0.05, 0.001).data();
  ASSERT_TRUE(check_grid_field(sound));
  int asked = 0;
  const auto expect_refused = [&](const auto& spoil) {
    GridFieldData data = sound;
    spoil(data.exact);
    EXPECT_FALSE(check_grid_field(data)) << asked;
    ++asked;
  };
  expect_refused([](ExactCells& exact) { exact.bricks.pop_back(); });
  expect_refused([](ExactCells& exact) { exact.bricks[0] = 1u << 30; });
  expect_refused([&](ExactCells& exact) {
    const auto is_coarse = [](std::uint32_t entry) { return (entry & 7) != 3; };
    exact.bricks[static_cast<std::size_t>(std::ranges::find_if(sound.entries, is_coarse) -
                                          sound.entries.begin())] = 1;
  });
  expect_refused([](ExactCells& exact) { exact.masks.pop_back(); });
  expect_refused([](ExactCells& exact) { exact.masks.back() = 1u << 30; });
  expect_refused([](ExactCells& exact) { exact.lists[0] = UINT32_MAX; });
  expect_refused([](ExactCells& exact) { exact.triangles[0] = NAN; });
  expect_refused([](ExactCells& exact) { exact.listed[0] = UINT32_MAX; });
  expect_refused([](ExactCells& exact) { exact.feature_normals.pop_back(); });
  expect_refused([](ExactCells& exact) { exact.feature_normals[5] = INFINITY; });
}

}  // namespace
}  // namespace voxshell::exact_cells_test
