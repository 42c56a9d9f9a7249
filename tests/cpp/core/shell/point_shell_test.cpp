#include "voxshell/point_shell.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "shell/surface_voxels.h"
#include "support/meshes.h"
#include "support/random.h"
#include "support/shells.h"

namespace voxshell::point_shell_test {
namespace {

using namespace test_support;

TEST(PointShell, BySpacingIsSoundAndCovers) {
  Random random(91);
  for (const auto& [name, mesh] : make_named_meshes()) {
    for (const double spacing : {0.02, 0.1, 0.5, 5.0}) {
      const PointShell shell = build_shell(mesh, {.spacing = spacing});
      EXPECT_EQ(shell.spacing(), spacing);
      expect_sound(shell, mesh, name);
      expect_covers(shell, mesh, random, name);
    }
  }
}

TEST(PointShell, CountsAreNearTheExpectedDensity) {
  // On average over its orientations a surface passes 1.5 voxels a spacing^2.
  const TriangleMesh sphere = make_icosphere(0.5, 4).mesh();
  const PointShell shell = build_shell(sphere, {.spacing = 0.01});
  const double density = static_cast<double>(shell.size()) * 0.01 * 0.01 / sphere.compute_area();
  EXPECT_NEAR(density, 1.5, 0.03);
}

TEST(PointShell, OfBoxesWithSidesOfWholeSpacings) {
  Random random(92);
  for (const double spacing : {0.1, 0.05, 1.0 / 3.0}) {
    for (const auto& [a, b, c] : {std::tuple{3, 3, 3}, std::tuple{6, 3, 1}, std::tuple{10, 2, 7}}) {
      const TriangleMesh mesh =
          make_box({a * spacing / 2, b * spacing / 2, c * spacing / 2}).mesh();
      const PointShell shell = build_shell(mesh, {.spacing = spacing});
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
    const PointShell shell = build_shell(mesh, {.spacing = 0.05});
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
  std::vector<NamedMesh> all;
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
      const PointShell shell = build_shell(mesh, {.spacing = spacing});
      expect_sound(shell, mesh, name);
      expect_covers(shell, mesh, random, name, 5000);
    }
  }
}

TEST(PointShell, OfSmoothBodiesHasOnePointAVoxel) {
  // The second side is the exception.
  for (const std::size_t body : {4u, 5u, 6u}) {
    const auto [name, mesh] = make_named_meshes()[body];
    const double spacing = 0.02;
    const double voxels = compute_passed_area(mesh, {}) / (spacing * spacing);
    EXPECT_NEAR(static_cast<double>(build_shell(mesh, {.spacing = spacing}).size()), voxels,
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
    const PointShell shell = build_shell(mesh, {.spacing = 0.03});
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

TEST(PointShell, IsTheSameForAnyNumberOfThreads) {
  const TriangleMesh mesh = make_named_meshes()[6].mesh;
  for (PointShellSettings settings :
       {PointShellSettings{.spacing = 0.01}, PointShellSettings{.target_points = 12'000}}) {
    settings.threads = 1;
    const PointShell a = build_shell(mesh, settings);
    EXPECT_GT(a.size(), 10'000u);  // several tasks
    for (const unsigned threads : {1u, 2u, 5u, 0u}) {
      settings.threads = threads;
      const PointShell b = build_shell(mesh, settings);
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
  const PointShell here = build_shell(soup.mesh(), {.spacing = 0.0625});
  const PointShell there = build_shell(moved(soup, {8, -16, 4}).mesh(), {.spacing = 0.0625});
  // Rounding may move a place across the border of its voxel, hardly more.
  EXPECT_NEAR(static_cast<double>(here.size()), static_cast<double>(there.size()), 5.0);
}

TEST(PointShell, TakesSpacingsFarAboveTheBody) {
  const TriangleMesh mesh = make_box({0.5, 0.4, 0.3}).mesh();
  const PointShell expected = build_shell(mesh, {.spacing = 10.0});
  for (const double spacing : {1e9, 1e200, std::numeric_limits<double>::max()}) {
    const PointShell shell = build_shell(mesh, {.spacing = spacing});
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

TEST(PointShell, RefusesToleranceAndSpacingTogether) {
  const TriangleMesh mesh = make_box({1, 1, 1}).mesh();
  for (const PointShellSettings& settings :
       {PointShellSettings{.tolerance = 1e-3, .spacing = 0.1},
        PointShellSettings{.tolerance = 1e-3, .target_points = 100},
        PointShellSettings{.tolerance = -1e-3},
        PointShellSettings{.tolerance = std::numeric_limits<double>::infinity()}}) {
    const auto shell = PointShell::build(mesh, settings);
    ASSERT_FALSE(shell);
    EXPECT_EQ(shell.error().code, ErrorCode::kInvalidArgument);
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
      if (!finished) expect_error(built, ErrorCode::kCanceled, "stopped");
    }
    EXPECT_GE(stop_at, 3);
  }
}

TEST(PointShell, TakesOpenMeshes) {
  Soup soup = make_blob(0.5, 3);
  soup.triangles.resize(soup.triangles.size() / 2);
  const TriangleMesh mesh = soup.mesh();
  expect_sound(build_shell(mesh, {.spacing = 0.05}), mesh, "half a blob");
}

}  // namespace
}  // namespace voxshell::point_shell_test
