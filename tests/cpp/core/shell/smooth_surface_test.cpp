#include "voxshell/smooth_surface.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "support/random.h"
#include "voxshell/point_shell.h"

namespace voxshell::smooth_surface_test {
namespace {

using namespace test_support;

TriangleMesh mesh_of(const Soup& soup) {
  return *TriangleMesh::create(soup.vertices, soup.triangles);
}

PointShell shell_of(const TriangleMesh& mesh, double tolerance) {
  return *PointShell::build(mesh, {.tolerance = tolerance});
}

Vec3 direction_at(double angle, double height) {
  return normalized(Vec3{std::cos(angle), std::sin(angle), height});
}

TEST(SmoothSurface, OfAFineBallIsTheSphere) {
  const TriangleMesh mesh = mesh_of(make_icosphere(1.0, 4));
  const PointShell shell = shell_of(mesh, 1e-3);
  const SmoothSurface surface(mesh, shell);
  ASSERT_TRUE(surface.is_curved());
  for (std::uint32_t id = 0; id < shell.size(); ++id) {
    const auto point = static_cast<Vec3>(shell.points()[id]);
    const auto place = surface.nearest_on(surface.triangle_of(id), point);
    const Vec3 lifted = surface.position(place);
    EXPECT_NEAR(length(lifted), 1.0, 3e-5);
    EXPECT_GT(dot(surface.normal(place), normalized(lifted)), std::cos(5e-3));
    const auto [position, normal] = surface.tangent_plane(place);
    EXPECT_EQ(position, lifted);
    EXPECT_EQ(normal, surface.normal(place));
  }
}

TEST(SmoothSurface, SlidesFromAnywhereToTheFarthestPlaceOfABall) {
  const TriangleMesh mesh = mesh_of(make_icosphere(1.0, 4));
  const PointShell shell = shell_of(mesh, 1e-3);
  const SmoothSurface surface(mesh, shell);
  const Vec3 down = direction_at(0.3, -1.2);
  for (std::uint32_t id = 0; id < shell.size(); ++id) {
    const auto point = static_cast<Vec3>(shell.points()[id]);
    if (dot(point, down) < 0.5) continue;
    const auto start = surface.nearest_on(surface.triangle_of(id), point);
    const auto slide = surface.slide(start, down, 0.01);
    EXPECT_TRUE(slide.is_at_rest);
    EXPECT_LT(length(surface.position(slide.place) - down), 1e-3) << id;
  }
}

TEST(SmoothSurface, OfACylinderIsLeftAlongItsAxis) {
  const TriangleMesh mesh = mesh_of(make_cylinder(0.5, 2.0, 32));
  const PointShell shell = shell_of(mesh, 1e-3);
  const SmoothSurface surface(mesh, shell);
  const Vec3 down = direction_at(0.7, 0.05);
  for (std::uint32_t id = 0; id < shell.element_count(); ++id) {
    const auto point = static_cast<Vec3>(
        shell.is_point(id)
            ? shell.points()[id]
            : shell.edges()->middles()[id - static_cast<std::uint32_t>(shell.size())]);
    if (std::hypot(point.x, point.y) < 0.49 || dot(point, down) < 0.2) continue;
    const auto start = surface.nearest_on(surface.triangle_of(id), point);
    const Vec3 place = surface.position(surface.slide(start, down, 0.01).place);
    EXPECT_LT(length(place - Vec3{0.5 * std::cos(0.7), 0.5 * std::sin(0.7), point.z}), 2e-3)
        << id << (shell.is_point(id) ? " point" : " edge");
  }
}

TEST(SmoothSurface, OfCoarseFacetsIsFlat) {
  EXPECT_FALSE(
      SmoothSurface(mesh_of(make_box({1, 2, 3})), shell_of(mesh_of(make_box({1, 2, 3})), 0.01))
          .is_curved());
  for (const std::uint32_t sides : {29u, 30u}) {
    const TriangleMesh mesh = mesh_of(make_cylinder(0.5, 2.0, sides));
    EXPECT_EQ(SmoothSurface(mesh, shell_of(mesh, 1e-3)).is_curved(), sides == 30u) << sides;
  }
}

TEST(SmoothSurface, FindsTheNearestPlaceByWayOfItsTriangles) {
  const TriangleMesh mesh = mesh_of(make_icosphere(1.0, 4));
  const PointShell shell = shell_of(mesh, 1e-3);
  const SmoothSurface surface(mesh, shell);
  const Vec3 from = static_cast<Vec3>(shell.points()[0]);
  const auto start = surface.nearest_on(surface.triangle_of(0), from);
  for (std::uint32_t id = 0; id < shell.size(); ++id) {
    const auto point = static_cast<Vec3>(shell.points()[id]);
    if (dot(point, from) < 0.5) continue;
    EXPECT_LT(length(surface.position(surface.below(start, point)) - point), 5e-3) << id;
  }
}

}  // namespace
}  // namespace voxshell::smooth_surface_test
