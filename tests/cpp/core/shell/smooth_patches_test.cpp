#include "shell/smooth_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "mesh/edges.h"
#include "support/meshes.h"

namespace voxshell::smooth_patches_test {
namespace {

using namespace test_support;

struct Built {
  TriangleMesh mesh;
  PointShell shell;
  SmoothPatches patches;
};

Built build(const Soup& soup, double tolerance) {
  TriangleMesh mesh = soup.mesh();
  PointShell shell = *PointShell::build(mesh, {.tolerance = tolerance});
  SmoothPatches patches = build_smooth_patches(mesh, shell, TriangleFinder(mesh));
  return {std::move(mesh), std::move(shell), std::move(patches)};
}

bool is_side(const Built& of, std::uint32_t triangle) {
  return std::abs(face_normal(of.mesh.corners(triangle)).z) < 0.5;
}

// A box whose vertical edges are rounded.
Soup make_filleted_box() {
  std::vector<std::array<double, 2>> polygon;
  std::vector<Triangle> caps;
  for (std::uint32_t i = 0; i < 40; ++i) {
    const double angle = 2.0 * std::numbers::pi * (i - i / 10) / 36.0;
    polygon.push_back({(i / 10 % 3 == 0 ? 0.04 : -0.04) + 0.01 * std::cos(angle),
                       (i < 20 ? 0.03 : -0.03) + 0.01 * std::sin(angle)});
    if (i >= 2) caps.push_back({0, i - 1, i});
  }
  return make_prism(polygon, caps, -0.02, 0.02);
}

TEST(SmoothPatches, AreConnectedUpToCreases) {
  const Built cylinder = build(make_cylinder(0.5, 2.0, 32), 1e-3);
  const auto& neighbors = cylinder.patches.neighbors;
  int sides = 0;
  for (std::uint32_t triangle = 0; triangle < neighbors.size(); ++triangle) {
    const auto connected = std::ranges::count_if(
        neighbors[triangle], [](std::uint32_t other) { return other != kNoTriangle; });
    for (const std::uint32_t other : neighbors[triangle]) {
      if (other == kNoTriangle) continue;
      EXPECT_EQ(is_side(cylinder, other), is_side(cylinder, triangle));
      EXPECT_EQ(std::ranges::count(neighbors[other], triangle), 1);
    }
    if (!is_side(cylinder, triangle)) continue;
    ++sides;
    EXPECT_EQ(connected, 2);
  }
  EXPECT_EQ(sides, 64);
  for (const auto& of_triangle : build(make_box({1, 2, 3}), 0.01).patches.neighbors) {
    EXPECT_EQ(std::ranges::count(of_triangle, kNoTriangle), 2);
  }
}

TEST(SmoothPatches, OfACylinderHaveNormalsThatPointFromItsAxis) {
  const Built cylinder = build(make_cylinder(0.5, 2.0, 32), 1e-3);
  for (std::uint32_t triangle = 0; triangle < cylinder.patches.lifts.size(); ++triangle) {
    const std::array<Vec3, 3> corners = cylinder.mesh.corners(triangle);
    const std::array<Vec3, 3> normals = cylinder.patches.normals_of(triangle);
    for (std::size_t i = 0; i < kCorners; ++i) {
      const Vec3 expected = is_side(cylinder, triangle)
                                ? normalized(Vec3{corners[i].x, corners[i].y, 0.0})
                                : normalized(Vec3{0.0, 0.0, corners[i].z});
      EXPECT_LT(length(normals[i] - expected), 1e-6);
    }
  }
}

TEST(SmoothPatches, OfACylinderAreLiftedToItsRadiusAtTheMiddlesOfFacets) {
  const Built cylinder = build(make_cylinder(0.5, 2.0, 32), 1e-3);
  const double sagitta = 0.5 * (1.0 - std::cos(std::numbers::pi / 32));
  for (std::uint32_t triangle = 0; triangle < cylinder.patches.lifts.size(); ++triangle) {
    const bool is_curved = is_side(cylinder, triangle);
    EXPECT_EQ(cylinder.patches.is_flat(triangle), !is_curved);
    EXPECT_NEAR(cylinder.patches.lifts[triangle], is_curved ? sagitta : 0.0, 2e-5);
  }
  EXPECT_EQ(cylinder.patches.most_lift, std::ranges::max(cylinder.patches.lifts));
}

// With means of the angles alone, faces of 100 mm bulged by a millimeter, and sides of a cone by
// more.
TEST(SmoothPatches, OfFlatFacesBesideFilletsAndOfConesKeepTheirShape) {
  const Built filleted = build(make_filleted_box(), 1e-4);
  EXPECT_GT(filleted.patches.most_lift, 0.0f);
  EXPECT_LT(filleted.patches.most_lift, 5e-5f);
  EXPECT_LT(build(make_cone(0.05, 0.1, 64), 1e-4).patches.most_lift, 1e-4f);
}

TEST(SmoothPatches, KeepTheNormalsOfFacesAtTheTipOfACone) {
  const Built cone = build(make_cone(0.05, 0.1, 64), 1e-4);
  int at_tip = 0;
  for (std::uint32_t triangle = 0; triangle < cone.patches.lifts.size(); ++triangle) {
    const std::array<Vec3, 3> corners = cone.mesh.corners(triangle);
    for (std::size_t i = 0; i < kCorners; ++i) {
      if (corners[i].z < 0.09) continue;
      ++at_tip;
      const Vec3 normal = cone.patches.normals_of(triangle)[i];
      EXPECT_LT(length(normal - face_normal(corners)), 1e-6);
    }
  }
  EXPECT_EQ(at_tip, 64);
}

TEST(SmoothPatches, OfElementsContainTheirPlaces) {
  const Built filleted = build(make_filleted_box(), 1e-4);
  ASSERT_EQ(filleted.patches.triangle_of_element.size(), filleted.shell.element_count());
  int at_creases = 0;
  for (std::uint32_t id = 0; id < filleted.shell.size(); ++id) {
    const auto place = static_cast<Vec3>(filleted.shell.points()[id]);
    const std::uint32_t triangle = filleted.patches.triangle_of_element[id];
    const std::uint32_t flat = filleted.patches.flat_of_element[id];
    const std::array<Vec3, 3> corners = filleted.mesh.corners(triangle);
    EXPECT_NEAR(dot(place - corners[0], face_normal(corners)), 0.0, 2e-7) << id;
    if (flat == kNoTriangle) {
      EXPECT_FALSE(filleted.patches.is_flat(triangle)) << id;
    } else {
      EXPECT_TRUE(filleted.patches.is_flat(flat)) << id;
      at_creases += flat != triangle;
    }
  }
  EXPECT_GT(at_creases, 50);
}

TEST(SmoothPatches, OfAPolyhedronAreFlatAndHaveNoElements) {
  const Built box = build(make_box({1, 2, 3}), 0.01);
  EXPECT_EQ(box.patches.most_lift, 0.0f);
  EXPECT_TRUE(box.patches.triangle_of_element.empty());
  EXPECT_TRUE(box.patches.flat_of_element.empty());
}

}  // namespace
}  // namespace voxshell::smooth_patches_test
