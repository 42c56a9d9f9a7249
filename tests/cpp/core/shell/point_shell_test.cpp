#include "voxshell/point_shell.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "mesh/closest_point.h"
#include "shell/surface_voxels.h"
#include "support/brute_force.h"
#include "support/meshes.h"
#include "support/random.h"
#include "support/surface.h"

namespace voxshell {
namespace {

using namespace test_support;

PointShell build(const TriangleMesh& mesh, const PointShellSettings& settings) {
  auto shell = PointShell::build(mesh, settings);
  EXPECT_TRUE(shell) << shell.error().message;
  if (!shell) std::abort();
  return *std::move(shell);
}

void expect_error(const Result<PointShell>& shell, ErrorCode code, const std::string& reason) {
  ASSERT_FALSE(shell) << "accepted, but expected: " << reason;
  EXPECT_EQ(shell.error().code, code);
  EXPECT_NE(shell.error().message.find(reason), std::string::npos) << shell.error().message;
}

struct Body {
  const char* name;
  TriangleMesh mesh;
};

std::vector<Body> bodies() {
  Random random(90);
  const auto turned = [&](const Soup& soup) { return transformed(soup, random.pose(0.3)).mesh(); };
  std::vector<Body> all;
  all.push_back({"box", make_box({0.5, 0.3, 0.2}).mesh()});
  all.push_back({"turned box", turned(make_box({0.5, 0.3, 0.2}))});
  all.push_back({"tetrahedron", turned(make_corner_tetrahedron(1))});
  all.push_back({"L-shape", make_l_shape(0.5).mesh()});
  all.push_back({"sphere", make_icosphere(0.5, 3).mesh()});
  all.push_back({"torus", make_torus(0.6, 0.2, 40, 20).mesh()});
  all.push_back({"blob", turned(make_blob(0.5, 3))});
  all.push_back({"wedge", turned(make_wedge(1.0, 0.05, 0.5))});
  all.push_back({"spike", turned(make_spike(0.1, 1.0))});
  all.push_back({"plate", make_box({0.5, 0.4, 0.001}).mesh()});
  return all;
}

/// All that a shell promises about its points, whatever the settings.
void expect_sound(const PointShell& shell, const TriangleMesh& mesh, const std::string& name) {
  SCOPED_TRACE(name + ", " + std::to_string(shell.size()) + " points");
  const double size = length(mesh.bounds().extents());
  const std::size_t n = shell.size();
  ASSERT_GT(n, 0u);
  ASSERT_EQ(shell.normals().size(), n);
  ASSERT_EQ(shell.areas().size(), n);
  ASSERT_EQ(shell.tree().point_count(), n);

  const ClosestPointTree surface(mesh);
  for (std::size_t i = 0; i < n; ++i) {
    const auto p = static_cast<Vec3>(shell.points()[i]);
    ASSERT_LE(std::sqrt(surface.find_closest(p).squared_distance), 1e-6 * size);
    ASSERT_NEAR(length(shell.normals()[i]), 1.0f, 1e-6f);
    ASSERT_GT(shell.areas()[i], 0.0f);
  }

  // The normal is that of a triangle on which the point lies. By brute force, so not for all.
  for (std::size_t i = 0; i < n; i += std::max<std::size_t>(1, n / 300)) {
    const auto p = static_cast<Vec3>(shell.points()[i]);
    const auto normal = static_cast<Vec3>(shell.normals()[i]);
    bool found = false;
    for (std::size_t t = 0; t < mesh.triangles().size() && !found; ++t) {
      const auto corners = mesh.corners(t);
      const Vec3 outwards = normalized(cross(corners[1] - corners[0], corners[2] - corners[0]));
      found = dot(normal, outwards) > 1 - 1e-6 && distance_to_triangle(p, corners) <= 1e-6 * size;
    }
    ASSERT_TRUE(found) << "point " << i;
  }

  double area = 0.0;
  for (const float a : shell.areas()) area += static_cast<double>(a);
  EXPECT_NEAR(area, mesh.compute_area(), 1e-5 * mesh.compute_area());

  std::vector<std::array<float, 3>> places;
  for (const Vec3f& p : shell.points()) places.push_back({p.x, p.y, p.z});
  std::sort(places.begin(), places.end());
  EXPECT_EQ(std::adjacent_find(places.begin(), places.end()), places.end()) << "repeated points";

  for (int level = 1; level <= shell.tree().level_count(); ++level) {
    const auto spheres = shell.tree().spheres(level);
    for (std::uint64_t i = 0; i < spheres.size(); ++i) {
      const PointRange range = shell.tree().cluster_points(level, i);
      for (std::uint32_t id = range.begin; id < range.end; ++id) {
        const Vec3 away =
            static_cast<Vec3>(shell.points()[id]) - static_cast<Vec3>(spheres[i].centre);
        ASSERT_LE(length(away), static_cast<double>(spheres[i].radius));
      }
    }
  }
}

/// The points of a shell by cells of the surface that each may cover.
class NearPoints {
 public:
  explicit NearPoints(const PointShell& shell, double reach) : shell_(shell), reach_(reach) {
    for (std::uint32_t id = 0; id < shell.size(); ++id) {
      ids_[cell(static_cast<Vec3>(shell.points()[id]))].push_back(id);
    }
  }

  /// To the nearest point that `accepts`; infinite where there is none within reach.
  template <class Accepts>
  double distance(const Vec3& p, const Accepts& accepts) const {
    double nearest = std::numeric_limits<double>::infinity();
    const auto centre = cell(p);
    for (int i = 0; i < 27; ++i) {
      const auto found =
          ids_.find({centre[0] + i % 3 - 1, centre[1] + i / 3 % 3 - 1, centre[2] + i / 9 - 1});
      if (found == ids_.end()) continue;
      for (const std::uint32_t id : found->second) {
        if (!accepts(id)) continue;
        nearest = std::min(nearest, length(static_cast<Vec3>(shell_.points()[id]) - p));
      }
    }
    return nearest <= reach_ ? nearest : std::numeric_limits<double>::infinity();
  }

 private:
  using Cell = std::array<std::int64_t, 3>;

  Cell cell(const Vec3& p) const {
    Cell index;
    for (int axis = 0; axis < 3; ++axis) {
      index[static_cast<std::size_t>(axis)] =
          static_cast<std::int64_t>(std::floor(p[axis] / reach_));
    }
    return index;
  }

  const PointShell& shell_;
  double reach_;
  std::map<Cell, std::vector<std::uint32_t>> ids_;
};

/// No place of the surface is farther than sqrt(3) spacings from a point that does not face away
/// from it.
void expect_covers(const PointShell& shell, const TriangleMesh& mesh, Random& random,
                   const std::string& name, int places = 2000) {
  SCOPED_TRACE(name + ", spacing " + std::to_string(shell.spacing()));
  const SurfaceSampler surface(mesh);
  const double bound = std::sqrt(3.0) * shell.spacing() + 1e-6 * length(mesh.bounds().extents());
  const NearPoints near(shell, bound);
  double worst = 0.0;
  for (int i = 0; i < places; ++i) {
    const auto [p, triangle] = surface.place(random);
    const auto [a, b, c] = mesh.corners(triangle);
    const Vec3 normal = normalized(cross(b - a, c - a));
    const double distance = near.distance(p, [&](std::uint32_t id) {
      return dot(static_cast<Vec3>(shell.normals()[id]), normal) > -0.003;
    });
    ASSERT_LE(distance, bound) << "from " << p.x << ", " << p.y << ", " << p.z;
    worst = std::max(worst, distance);
  }
  // Where spacing is far above the body's size one point a side is enough.
  if (shell.size() > 100) {
    EXPECT_GT(worst, 0.3 * shell.spacing());
  }
}

TEST(PointShell, BySpacingIsSoundAndCovers) {
  Random random(91);
  for (const auto& [name, mesh] : bodies()) {
    for (const double spacing : {0.02, 0.1, 0.5, 5.0}) {
      const PointShell shell = build(mesh, {.spacing = spacing});
      EXPECT_EQ(shell.spacing(), spacing);
      expect_sound(shell, mesh, name);
      expect_covers(shell, mesh, random, name);
    }
  }
}

TEST(PointShell, CountsAreNearTheExpectedDensity) {
  // On average over its orientations a surface passes 1.5 voxels a spacing^2.
  const TriangleMesh sphere = make_icosphere(0.5, 4).mesh();
  const PointShell shell = build(sphere, {.spacing = 0.01});
  const double density = static_cast<double>(shell.size()) * 0.01 * 0.01 / sphere.compute_area();
  EXPECT_NEAR(density, 1.5, 0.03);
}

TEST(PointShell, OfBoxesWithSidesOfWholeSpacings) {
  Random random(92);
  for (const double spacing : {0.1, 0.05, 1.0 / 3.0}) {
    for (const auto& [a, b, c] : {std::tuple{3, 3, 3}, std::tuple{6, 3, 1}, std::tuple{10, 2, 7}}) {
      const TriangleMesh mesh =
          make_box({a * spacing / 2, b * spacing / 2, c * spacing / 2}).mesh();
      const PointShell shell = build(mesh, {.spacing = spacing});
      // Half a spacing to spare on every side: the skin of a block of voxels.
      EXPECT_EQ(shell.size(), static_cast<std::size_t>((a + 1) * (b + 1) * (c + 1) -
                                                       (a - 1) * (b - 1) * (c - 1)));
      expect_sound(shell, mesh, "box");
      expect_covers(shell, mesh, random, "box");
    }
  }
}

std::size_t count_facing(const PointShell& shell, const Vec3& direction) {
  return static_cast<std::size_t>(std::count_if(
      shell.normals().begin(), shell.normals().end(),
      [&](const Vec3f& normal) { return dot(static_cast<Vec3>(normal), direction) > 0.9; }));
}

TEST(PointShell, OfAThinPlateHasPointsOnBothSides) {
  Random random(93);
  for (const double thickness : {0.04, 1e-3, 1e-5, 1e-7}) {
    const TriangleMesh mesh = make_box({0.5, 0.5, thickness / 2}).mesh();
    const PointShell shell = build(mesh, {.spacing = 0.05});
    expect_sound(shell, mesh, "plate");
    expect_covers(shell, mesh, random, "plate");
    // Voxels on the rim have a point there, from which neither side faces away.
    EXPECT_EQ(count_facing(shell, {0, 0, 1}), 19u * 19u);
    EXPECT_EQ(count_facing(shell, {0, 0, -1}), 19u * 19u);
    EXPECT_EQ(shell.size(), 2u * 19u * 19u + 80u);
  }
}

TEST(PointShell, OfThinAndSharpBodiesHasPointsOnAllSides) {
  Random random(98);
  std::vector<Body> all;
  const auto add = [&](const char* name, const Soup& soup) {
    all.push_back({name, soup.mesh()});
    all.push_back({name, transformed(soup, random.pose(0.3)).mesh()});
  };
  add("blade", make_wedge(1.0, 0.05, 0.5));
  add("fine blade", make_wedge(1.0, 1e-4, 0.5));
  // Its edge is in a plane between voxels, where those of both sides may choose the same place.
  add("steep blade", make_wedge(0.3, 0.5, 0.5));
  add("spike", make_spike(0.1, 1.0));
  add("flat spike", make_spike(1.0, 0.01));
  add("rod", make_box({0.003, 0.002, 0.5}));
  add("thin tube", make_torus(0.5, 0.004, 60, 8));
  add("three-sided rod",
      make_prism({{0.004, 0}, {-0.002, 0.0035}, {-0.002, -0.0035}}, {{0, 1, 2}}, -0.5, 0.5));
  add("small tetrahedron", make_corner_tetrahedron(0.02));
  add("gap",
      together(make_box({0.3, 0.3, 0.01}), moved(make_box({0.3, 0.3, 0.01}), {0, 0, 0.021})));
  for (const auto& [name, mesh] : all) {
    for (const double spacing : {0.013, 0.05, 0.2, 3.0}) {
      const PointShell shell = build(mesh, {.spacing = spacing});
      expect_sound(shell, mesh, name);
      expect_covers(shell, mesh, random, name, 5000);
    }
  }
}

TEST(PointShell, OfSmoothBodiesHasOnePointAVoxel) {
  // The second side is the exception.
  for (const std::size_t body : {4u, 5u, 6u}) {
    const auto [name, mesh] = bodies()[body];
    const double spacing = 0.02;
    const double voxels = compute_passed_area(mesh, {}) / (spacing * spacing);
    EXPECT_NEAR(static_cast<double>(build(mesh, {.spacing = spacing}).size()), voxels,
                0.01 * voxels)
        << name;
  }
}

TEST(PointShell, NormalsOfNeedlesAreOutwardsToo) {
  // A box whose top is split along a needle of a triangle, with a normal of mere rounding.
  Random random(94);
  for (const double width : {1e-6, 1e-9, 1e-13, 1e-16, 0.0}) {
    Soup soup = make_box({0.5, 0.5, 0.5});
    const auto [a, b, c] = soup.triangles[1];
    const auto m = static_cast<std::uint32_t>(soup.vertices.size());
    soup.vertices.push_back(0.5 * (soup.vertices[a] + soup.vertices[c]) +
                            Vec3{width, -width, 1e-17});
    soup.triangles[1] = {a, b, m};
    soup.triangles.push_back({m, b, c});
    soup.triangles.push_back({a, m, c});
    const Pose pose = random.pose(0.1);
    const TriangleMesh mesh = transformed(soup, pose).mesh();
    ASSERT_TRUE(check_encloses_volume(mesh));
    const PointShell shell = build(mesh, {.spacing = 0.03});
    for (std::size_t i = 0; i < shell.size(); ++i) {
      const Vec3 p = pose.inverse().transform_point(static_cast<Vec3>(shell.points()[i]));
      const Vec3 normal = pose.inverse().rotate(static_cast<Vec3>(shell.normals()[i]));
      ASSERT_NEAR(length(normal), 1.0, 1e-6) << "width " << width;
      // The normal is that of a side of the cube on which the point lies.
      const int axis = std::abs(normal.x) > 0.9 ? 0 : std::abs(normal.y) > 0.9 ? 1 : 2;
      ASSERT_GT(std::abs(normal[axis]), 1 - 1e-6) << "width " << width << ", point " << i;
      ASSERT_NEAR(p[axis], 0.5 * normal[axis], 1e-6) << "width " << width << ", point " << i;
    }
  }
}

TEST(PointShell, ByTargetIsReachedWithinOnePercent) {
  Random random(95);
  for (const auto& [name, mesh] : bodies()) {
    for (const std::size_t target : {50u, 100u, 137u, 400u, 799u, 2000u, 5000u, 12'345u}) {
      const auto shell = PointShell::build(mesh, {.target_points = target});
      ASSERT_TRUE(shell) << name << ": " << shell.error().message;
      const double miss =
          std::abs(static_cast<double>(shell->size()) - static_cast<double>(target));
      EXPECT_LE(miss, 0.01 * static_cast<double>(target)) << name;
      if (target == 799u) {
        expect_sound(*shell, mesh, name);
        expect_covers(*shell, mesh, random, name);
      }
    }
  }
}

TEST(PointShell, ByTargetOfFewPointsIsReachedToThePoint) {
  // One percent of fewer than 100 points is none.
  for (const auto& [name, mesh] : bodies()) {
    for (const std::size_t target : {5u, 8u, 13u, 20u, 21u, 33u, 51u, 89u}) {
      const auto shell = PointShell::build(mesh, {.target_points = target});
      ASSERT_TRUE(shell) << name << ": " << shell.error().message;
      EXPECT_EQ(shell->size(), target) << name;
    }
  }
}

TEST(PointShell, ByTargetBelowTheSidesOfABodyIsRefused) {
  // A closed body has sides that face away from one another: two to four points at least.
  const auto refused = PointShell::build(make_icosphere(0.5, 3).mesh(), {.target_points = 1});
  expect_error(refused, ErrorCode::kInvalidArgument, "the nearest count found is 4");
}

TEST(PointShell, ByTargetBeyondWhatFloat32CanTellApartIsRefusedWithTheNearestCount) {
  // At 10 km in every direction a cube of 2 mm has 27 places.
  const TriangleMesh mesh = moved(make_box({0.001, 0.001, 0.001}), {1e4, 1e4, 1e4}).mesh();
  for (const std::size_t target : {1000u, 20'000u}) {
    const auto refused = PointShell::build(mesh, {.target_points = target});
    expect_error(refused, ErrorCode::kInvalidArgument,
                 "gives " + std::to_string(target) + " points within 1 %");
    if (refused) return;
    const std::string& message = refused.error().message;
    const std::size_t at = message.find("nearest count found is ");
    ASSERT_NE(at, std::string::npos) << message;
    const unsigned long nearest = std::stoul(message.substr(at + 23));
    EXPECT_GE(nearest, 8u);
    EXPECT_LE(nearest, 27u);
  }
}

TEST(PointShell, ByTargetOnAWire) {
  // A spacing from the area alone would begin with five million voxels.
  const TriangleMesh wire = make_box({0.5, 1e-12, 1e-12}).mesh();
  EXPECT_NEAR(static_cast<double>(build(wire, {.target_points = 200}).size()), 200.0, 2.0);
}

TEST(PointShell, ByToleranceOnAWireThatHasNoThickness) {
  // Points half its thickness apart would be ten million.
  for (const double half : {1e-8, 1e-12, 1e-27}) {
    const TriangleMesh wire = make_box({0.5, half, half}).mesh();
    const std::size_t count = build(wire, {.tolerance = 0.01}).size();
    EXPECT_GE(count, 1'000u);
    EXPECT_LE(count, 2'100u);
  }
}

TEST(PointShell, ByTargetOfManyPoints) {
  for (const std::size_t target : {35'596u, 50'000u}) {
    for (const std::size_t body : {0u, 5u, 6u}) {
      const Body chosen = bodies()[body];
      const PointShell shell = build(chosen.mesh, {.target_points = target});
      EXPECT_NEAR(static_cast<double>(shell.size()), static_cast<double>(target),
                  0.01 * static_cast<double>(target))
          << chosen.name;
    }
  }
}

TEST(PointShell, IsTheSameForAnyNumberOfThreads) {
  const TriangleMesh mesh = bodies()[6].mesh;
  for (PointShellSettings settings :
       {PointShellSettings{.spacing = 0.01}, PointShellSettings{.target_points = 12'000}}) {
    settings.threads = 1;
    const PointShell a = build(mesh, settings);
    EXPECT_GT(a.size(), 10'000u);  // several tasks
    for (const unsigned threads : {1u, 2u, 5u, 0u}) {
      settings.threads = threads;
      const PointShell b = build(mesh, settings);
      EXPECT_EQ(a.spacing(), b.spacing());
      EXPECT_TRUE(
          std::equal(a.points().begin(), a.points().end(), b.points().begin(), b.points().end()));
      EXPECT_TRUE(std::equal(a.normals().begin(), a.normals().end(), b.normals().begin()));
      EXPECT_TRUE(std::equal(a.areas().begin(), a.areas().end(), b.areas().begin()));
    }
  }
}

TEST(PointShell, FollowsTheMeshToAnotherPlace) {
  const Soup soup = make_blob(0.5, 3);
  const PointShell here = build(soup.mesh(), {.spacing = 0.0625});
  const PointShell there = build(moved(soup, {8, -16, 4}).mesh(), {.spacing = 0.0625});
  // Rounding may move a place across the border of its voxel, hardly more.
  EXPECT_NEAR(static_cast<double>(here.size()), static_cast<double>(there.size()), 5.0);
}

TEST(PointShell, TakesSpacingsFarAboveTheBody) {
  const TriangleMesh mesh = make_box({0.5, 0.4, 0.3}).mesh();
  const PointShell expected = build(mesh, {.spacing = 10.0});
  for (const double spacing : {1e9, 1e200, std::numeric_limits<double>::max()}) {
    const PointShell shell = build(mesh, {.spacing = spacing});
    EXPECT_EQ(shell.spacing(), spacing);
    expect_sound(shell, mesh, "box");
    EXPECT_TRUE(std::equal(shell.points().begin(), shell.points().end(), expected.points().begin(),
                           expected.points().end()));
  }
}

TEST(PointShell, RefusesSettingsThatMakeNoSense) {
  const TriangleMesh mesh = make_box({1, 1, 1}).mesh();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  expect_error(PointShell::build(mesh, {}), ErrorCode::kInvalidArgument, "give either");
  expect_error(PointShell::build(mesh, {.spacing = 0.1, .target_points = 100}),
               ErrorCode::kInvalidArgument, "give either");
  for (const double spacing : {-0.1, nan, infinity, -infinity}) {
    expect_error(PointShell::build(mesh, {.spacing = spacing}), ErrorCode::kInvalidArgument,
                 "point spacing must be above 0 m");
  }
}

TEST(PointShell, RefusesMorePointsThanTheLimitAndAdvisesASpacingThatFits) {
  Random random(96);
  for (int trial = 0; trial < 50; ++trial) {
    const TriangleMesh mesh = make_icosphere(random.uniform(0.1, 10), 3).mesh();
    PointShellSettings settings{.spacing = 1e-4};
    settings.point_limit = 1000 + random.below(5000);
    const auto refused = PointShell::build(mesh, settings);
    expect_error(refused, ErrorCode::kTooLarge, std::to_string(settings.point_limit));
    if (refused) return;
    const std::string& message = refused.error().message;
    const std::string before_number = "spacing of at least ";
    const std::size_t at = message.find(before_number);
    ASSERT_NE(at, std::string::npos) << message;
    settings.spacing = std::stod(message.substr(at + before_number.size()));
    const auto built = PointShell::build(mesh, settings);
    ASSERT_TRUE(built) << "advised: " << message << "\nthen: " << built.error().message;
    EXPECT_LE(built->size(), settings.point_limit) << message;
  }
  expect_error(
      PointShell::build(make_box({1, 1, 1}).mesh(), {.target_points = 1001, .point_limit = 1000}),
      ErrorCode::kTooLarge, "limit of 1000");
  expect_error(PointShell::build(make_box({1, 1, 1}).mesh(), {.spacing = 1e-300}),
               ErrorCode::kTooLarge, "limit");
}

TEST(PointShell, RefusesAWireOfMorePointsThanTheLimitThoughItHasNoArea) {
  // Its voxels follow from its length: ten million, where its area would give sixty.
  const TriangleMesh wire = make_box({0.5, 1e-13, 1e-13}).mesh();
  expect_error(PointShell::build(wire, {.spacing = 1e-7, .point_limit = 1'000'000}),
               ErrorCode::kTooLarge, "limit of 1000000; use a point spacing of at least 1.2e-06 m");
}

TEST(PointShell, FarFromTheOriginMergesPlacesThatFloat32CannotTellApart) {
  // At 10 km neighbours in float32 are a millimetre apart.
  const TriangleMesh mesh = moved(make_box({0.01, 0.01, 0.01}), {1e4, 0, 0}).mesh();
  const PointShell shell = build(mesh, {.spacing = 3e-4});
  const std::size_t without_merging = 68 * 68 * 68 - 66 * 66 * 66;
  EXPECT_LT(shell.size(), without_merging * 3 / 4);
  EXPECT_GT(shell.size(), without_merging / 10);
  std::set<std::array<float, 3>> places;
  double area = 0.0;
  for (std::size_t i = 0; i < shell.size(); ++i) {
    const Vec3f& p = shell.points()[i];
    EXPECT_TRUE(places.insert({p.x, p.y, p.z}).second);
    area += static_cast<double>(shell.areas()[i]);
  }
  EXPECT_NEAR(area, mesh.compute_area(), 1e-5 * mesh.compute_area());
}

TEST(PointShell, StopsAtEveryReportWhereProgressSaysSo) {
  const TriangleMesh mesh = make_blob(0.5, 3).mesh();
  for (const PointShellSettings& settings :
       {PointShellSettings{.spacing = 0.05}, PointShellSettings{.target_points = 1000}}) {
    // How many reports there are depends on the machine's speed: stop ever later, to the end.
    int stop_at = 1;
    for (bool finished = false; !finished; ++stop_at) {
      int calls = 0;
      const auto built = PointShell::build(
          mesh, settings, [&](std::string_view, double) { return ++calls < stop_at; });
      finished = built.has_value();
      EXPECT_EQ(finished, calls < stop_at);
      if (!finished) expect_error(built, ErrorCode::kCancelled, "stopped");
    }
    EXPECT_GE(stop_at, 3);
  }
}

TEST(PointShell, TakesOpenMeshes) {
  Soup soup = make_blob(0.5, 3);
  soup.triangles.resize(soup.triangles.size() / 2);
  const TriangleMesh mesh = soup.mesh();
  expect_sound(build(mesh, {.spacing = 0.05}), mesh, "half a blob");
}

}  // namespace
}  // namespace voxshell
