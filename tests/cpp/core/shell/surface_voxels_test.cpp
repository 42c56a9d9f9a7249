#include "shell/surface_voxels.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/brute_force.h"
#include "support/meshes.h"
#include "support/random.h"
#include "support/surface.h"

namespace voxshell::surface_voxels_test {
namespace {

using namespace test_support;

double total_area(const std::vector<SurfaceSample>& samples) {
  double area = 0.0;
  for (const SurfaceSample& sample : samples) area += sample.area;
  return area;
}

/// Where the voxels of a grid that is aligned with the mesh begin: the mesh is in the middle of a
/// whole number of them that is larger than it.
Vec3 grid_origin(const TriangleMesh& mesh, double spacing) {
  Vec3 origin;
  for (int axis = 0; axis < 3; ++axis) {
    const double voxels = std::floor(mesh.bounds().extents()[axis] / spacing + 1e-9) + 1.0;
    origin[axis] = mesh.bounds().center()[axis] - 0.5 * voxels * spacing;
  }
  return origin;
}

Vec3 normal_of(const TriangleMesh& mesh, std::size_t triangle) {
  const auto [a, b, c] = mesh.corners(triangle);
  return compute_triangle_normal(a, b, c);
}

/// A voxel's index, and whether the point is clearly in it.
struct Place {
  std::array<std::int64_t, 3> voxel;
  bool is_clear = true;
};

Place place_in_grid(const Vec3& p, const Vec3& origin, double spacing) {
  Place place{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int a = static_cast<int>(axis);
    const double cells = (p[a] - origin[a]) / spacing;
    place.voxel[axis] = static_cast<std::int64_t>(std::floor(cells));
    place.is_clear = place.is_clear && std::abs(cells - std::round(cells)) > 1e-6;
  }
  return place;
}

void expect_samples_are_sound(const TriangleMesh& mesh, const VoxelGrid& grid,
                              double tolerance = 1e-10) {
  const auto samples = sample_surface_voxels(mesh, grid);
  ASSERT_FALSE(samples.empty());
  EXPECT_NEAR(total_area(samples), mesh.compute_area(), tolerance * mesh.compute_area());
  for (const SurfaceSample& sample : samples) {
    ASSERT_LT(sample.triangle, mesh.triangles().size());
    ASSERT_LE(distance_to_triangle(sample.point, mesh.corners(sample.triangle)), 1e-9);
    ASSERT_GT(sample.area, 0.0);
  }
}

using SamplesByVoxel = std::map<std::array<std::int64_t, 3>, std::vector<SurfaceSample>>;

TEST(SurfaceVoxels, ReachEverySideOfTheSurfaceInAVoxelOnce) {
  Random random(80);
  std::size_t voxels_of_sides[5] = {};
  for (const Soup& body : {make_corner_tetrahedron(1), make_box({0.5, 0.25, 1}), make_l_shape(0.5),
                           make_wedge(2, 0.01, 0.5), make_spike(0.1, 2), make_icosphere(1, 2),
                           make_blob(1, 3), make_torus(1, 0.25, 24, 12)}) {
    const TriangleMesh mesh = transformed(body, random.pose(1)).mesh();
    for (const double spacing : {0.07, 0.3, 3.0}) {
      expect_samples_are_sound(mesh, {spacing, {}});
      const auto samples = sample_surface_voxels(mesh, {spacing, {}});
      const Vec3 origin = grid_origin(mesh, spacing);
      SamplesByVoxel sampled;
      std::size_t on_borders = 0;
      for (const SurfaceSample& sample : samples) {
        const Place place = place_in_grid(sample.point, origin, spacing);
        if (place.is_clear) {
          sampled[place.voxel].push_back(sample);
        } else {
          ++on_borders;
        }
      }
      for (const auto& [voxel, sides] : sampled) {
        ASSERT_LE(sides.size(), 4u);
        ++voxels_of_sides[sides.size()];
        for (std::size_t i = 0; i < sides.size(); ++i) {
          for (std::size_t j = 0; j < i; ++j) {
            EXPECT_LT(dot(normal_of(mesh, sides[i].triangle), normal_of(mesh, sides[j].triangle)),
                      -0.5e-3);
          }
        }
      }
      const SurfaceSampler surface(mesh);
      std::set<std::array<std::int64_t, 3>> missed;
      for (int i = 0; i < 20'000; ++i) {
        const auto [p, triangle] = surface.place(random);
        const Place place = place_in_grid(p, origin, spacing);
        if (!place.is_clear) continue;
        const Vec3 normal = normal_of(mesh, triangle);
        bool found = false;
        for (const SurfaceSample& side : sampled[place.voxel]) {
          found = found || dot(normal, normal_of(mesh, side.triangle)) > -1.5e-3;
        }
        if (!found) missed.insert(place.voxel);
      }
      // A sample on the border between voxels stands for one that is missed here.
      EXPECT_LE(missed.size(), on_borders);
    }
  }
  EXPECT_GT(voxels_of_sides[1], 1000u);
  EXPECT_GT(voxels_of_sides[2], 100u);
  EXPECT_GT(voxels_of_sides[3] + voxels_of_sides[4], 2u);
}

TEST(SurfaceVoxels, SampleIsTheClosestToTheCenterOfTheVoxelOfItsSide) {
  Random random(81);
  std::size_t away = 0;
  for (const TriangleMesh& mesh :
       {make_blob(1, 3).mesh(), transformed(make_wedge(1, 0.3, 1), random.pose(1)).mesh(),
        transformed(make_box({1, 1, 0.02}), random.pose(1)).mesh()}) {
    const double spacing = 0.2;
    const Vec3 origin = grid_origin(mesh, spacing);
    SamplesByVoxel sampled;
    for (const SurfaceSample& sample : sample_surface_voxels(mesh, {spacing, {}})) {
      const Place place = place_in_grid(sample.point, origin, spacing);
      if (place.is_clear) sampled[place.voxel].push_back(sample);
    }
    const SurfaceSampler surface(mesh);
    for (int i = 0; i < 50'000; ++i) {
      const auto [p, triangle] = surface.place(random);
      const Place place = place_in_grid(p, origin, spacing);
      if (!place.is_clear) continue;
      Vec3 center;
      for (int axis = 0; axis < 3; ++axis) {
        center[axis] =
            origin[axis] +
            (static_cast<double>(place.voxel[static_cast<std::size_t>(axis)]) + 0.5) * spacing;
      }
      // The sides come by distance: the first that the place does not face away from is nearer.
      const auto& sides = sampled[place.voxel];
      for (std::size_t k = 0; k < sides.size(); ++k) {
        ASSERT_GE(length(p - center), length(sides[k].point - center) - 1e-9);
        if (dot(normal_of(mesh, triangle), normal_of(mesh, sides[k].triangle)) > -0.9e-3) break;
        ++away;
      }
    }
  }
  EXPECT_GT(away, 1000u);
}

TEST(SurfaceVoxels, OfManySidesHaveEachTheAreaThatFacesTheirWay) {
  // A bar within one row of voxels: each voxel holds two or four of its sides.
  const TriangleMesh mesh = make_box({0.01, 0.02, 1.0}).mesh();
  const auto samples = sample_surface_voxels(mesh, {0.1, {}});
  Vec3 sum{};
  for (const SurfaceSample& sample : samples) {
    const Vec3 normal = normal_of(mesh, sample.triangle);
    sum += sample.area * normal;
    // To the sides at right angles, half of the others' area goes either way.
    if (std::abs(normal.z) < 0.5 && std::abs(sample.point.z) < 0.9) {
      EXPECT_GE(sample.area, 0.1 * 0.02 - 1e-9);
      EXPECT_LE(sample.area, 0.1 * (0.04 + 2 * 0.02) + 1e-9);
    }
  }
  EXPECT_EQ(samples.size(), 2u * 19u + 2u);  // the ends face away from nothing
}

TEST(SurfaceVoxels, MiddlesAreWithinTheirPieces) {
  Random random(85);
  for (const Soup& body : {make_wedge(2, 0.01, 0.5), make_blob(1, 3), make_corner_tetrahedron(1)}) {
    const TriangleMesh mesh = transformed(body, random.pose(1)).mesh();
    const double spacing = 0.1;
    const Vec3 origin = grid_origin(mesh, spacing);
    for (const SurfaceSample& sample : sample_surface_voxels(mesh, {spacing, {}})) {
      const Vec3 middle = sample.point + static_cast<Vec3>(sample.to_middle);
      EXPECT_LE(distance_to_triangle(middle, mesh.corners(sample.triangle)), 1e-7);
      const Place place = place_in_grid(sample.point, origin, spacing);
      const Place place_of_middle = place_in_grid(middle, origin, spacing);
      if (place.is_clear && place_of_middle.is_clear) {
        EXPECT_EQ(place.voxel, place_of_middle.voxel);
      }
    }
  }
}

TEST(SurfaceVoxels, AreTheSameForAnyNumberOfThreads) {
  // Triangles of many sizes: many in one task, and one in many.
  const TriangleMesh mesh =
      together(make_blob(1, 3), moved(make_box({2, 2, 2}), {3.5, 0, 0})).mesh();
  const VoxelGrid grid{0.025, {}};
  const auto one = sample_surface_voxels(mesh, grid, 1);
  EXPECT_GT(one.size(), 150'000u);
  for (const unsigned threads : {2u, 3u, 16u}) {
    const auto many = sample_surface_voxels(mesh, grid, threads);
    ASSERT_EQ(one.size(), many.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
      ASSERT_EQ(one[i].point, many[i].point);
      ASSERT_EQ(one[i].to_middle, many[i].to_middle);
      ASSERT_EQ(one[i].triangle, many[i].triangle);
      ASSERT_EQ(one[i].area, many[i].area);
    }
  }
}

TEST(SurfaceVoxels, OfLargeTrianglesAreCutInSlicesWithoutSeams) {
  Random random(86);
  for (const double spacing : {0.01, 0.013}) {
    const TriangleMesh mesh = make_box({0.5, 0.4, 0.6}).mesh();
    expect_samples_are_sound(mesh, {spacing, {}});
    expect_samples_are_sound(mesh, {spacing, random.rotation(), {0.3, 0.1, 0.2}});
  }
  const auto samples = sample_surface_voxels(make_box({0.5, 0.5, 0.5}).mesh(), {0.01, {}});
  EXPECT_EQ(samples.size(), 101u * 101u * 101u - 99u * 99u * 99u);
}

TEST(SurfaceVoxels, OfNeedlesAloneAreSampledToo) {
  const auto mesh = TriangleMesh::create(
      std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0.5, 1e-12, 0}, {5, 5, 5}, {5, 6, 5}, {5, 5, 6}},
      std::vector<Triangle>{{0, 1, 2}, {3, 4, 5}});
  ASSERT_TRUE(mesh);
  std::size_t on_needle = 0;
  for (const SurfaceSample& sample : sample_surface_voxels(*mesh, {0.1, {}})) {
    on_needle += sample.triangle == 0 ? 1 : 0;
  }
  EXPECT_GE(on_needle, 10u);
  EXPECT_EQ(compute_triangle_normal({0, 0, 0}, {1, 0, 0}, {0.5, 1e-12, 0}), Vec3{});
  EXPECT_EQ(compute_triangle_normal({0, 0, 0}, {1, 0, 0}, {0.5, 1e-6, 0}), (Vec3{0, 0, 1}));
}

TEST(SurfaceVoxels, PassedAreaIsWhatAFlatSurfacePasses) {
  Random random(87);
  EXPECT_NEAR(compute_passed_area(make_box({0.5, 1, 1.5}).mesh(), {}), 22.0, 1e-12);
  const TriangleMesh mesh = make_box({0.5, 0.4, 0.6}).mesh();
  const double spacing = 0.01;
  for (int i = 0; i < 5; ++i) {
    const Matrix3 rotation = random.rotation();
    const auto voxels =
        static_cast<double>(sample_surface_voxels(mesh, {spacing, rotation, {}}).size());
    const double expected = compute_passed_area(mesh, rotation) / (spacing * spacing);
    EXPECT_NEAR(voxels, expected, 0.02 * expected);
  }
}

TEST(SurfaceVoxels, AreNoneWhereProgressAsksToStop) {
  const TriangleMesh mesh = make_blob(1, 3).mesh();
  for (const int stop_at : {1, 2}) {
    int calls = 0;
    const auto progress = [&](std::string_view, double) { return ++calls < stop_at; };
    EXPECT_TRUE(sample_surface_voxels(mesh, {0.05, {}}, 2, progress).empty());
  }
}

TEST(SurfaceVoxels, OfABoxOfWholeVoxelsAreItsSkin) {
  // With half a voxel to spare on each side: (n + 1)^3 voxels less the (n - 1)^3 within.
  for (const int n : {1, 2, 3, 6, 7, 10, 20}) {
    for (const double spacing : {0.1, 0.3, 0.01, 1.0 / 3.0, 0.7}) {
      for (const double offset : {0.0, 0.05, -17.3}) {
        const double half = n * spacing / 2;
        const TriangleMesh mesh =
            moved(make_box({half, half, half}), {offset, 2 * offset, 0}).mesh();
        const auto samples = sample_surface_voxels(mesh, {spacing, {}});
        EXPECT_EQ(samples.size(), static_cast<std::size_t>((n + 1) * (n + 1) * (n + 1) -
                                                           (n - 1) * (n - 1) * (n - 1)))
            << n << " voxels of " << spacing << " at " << offset;
        EXPECT_NEAR(total_area(samples), mesh.compute_area(), 1e-10 * mesh.compute_area());
      }
    }
  }
}

TEST(SurfaceVoxels, TakeTrianglesOnAndAlongTheFacesOfVoxels) {
  // Corners at quarters of the spacing, so that most triangles touch faces, edges and corners.
  Random random(82);
  const auto lattice = [&] { return 0.25 * static_cast<double>(random.below(17)); };
  for (int trial = 0; trial < 2000; ++trial) {
    Soup soup;
    for (std::uint32_t i = 0; i < 6; ++i) {
      for (int corner = 0; corner < 3; ++corner) {
        soup.vertices.push_back({lattice(), lattice(), lattice()});
      }
      soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    const auto mesh = TriangleMesh::create(soup.vertices, soup.triangles);
    if (!mesh) continue;
    const Vec3 shift{0.25 * static_cast<double>(random.below(5)), 0.0, 0.5};
    expect_samples_are_sound(*mesh, {1.0, {}, shift});
    expect_samples_are_sound(*mesh, {0.75, random.rotation(), shift});
  }
}

TEST(SurfaceVoxels, TakeTrianglesAlmostInTheFacesOfVoxels) {
  Random random(83);
  for (int trial = 0; trial < 6000; ++trial) {
    // Within rounding of a face, the worst case for cutting along it; or tilted a little more.
    const double tilt = trial % 2 == 0 ? 1e-15 : std::pow(10.0, random.uniform(-13, -3));
    const auto noise = [&] { return tilt * (random.unit() - 0.5); };
    const double x = std::round(random.uniform(-3, 3));
    const double y = std::round(random.uniform(-3, 3));
    Soup soup;
    soup.vertices = {{x + noise(), y + noise(), random.uniform(-5, 5)},
                     {x + noise(), y + noise(), random.uniform(-5, 5)},
                     {x + random.uniform(-2, 2), y + noise(), random.uniform(-5, 5)},
                     {-4, -4, -4},
                     {4, 4, 4},
                     {4, -4, 0}};
    soup.triangles = {{0, 1, 2}, {3, 4, 5}};
    const auto mesh = TriangleMesh::create(soup.vertices, soup.triangles);
    ASSERT_TRUE(mesh);
    // The bounds are 8 m, or one triangle's 10 m, so the faces of voxels are at whole numbers or
    // halfway between them.
    expect_samples_are_sound(*mesh, {1.0, {}, {0.5, 0.5, 0.5}}, 1e-7);
    expect_samples_are_sound(*mesh, {1.0, {}}, 1e-7);
  }
}

TEST(SurfaceVoxels, TurnedGridsSampleTheSameSurface) {
  Random random(84);
  const TriangleMesh mesh = make_torus(1, 0.25, 24, 12).mesh();
  for (int i = 0; i < 20; ++i) {
    expect_samples_are_sound(mesh, {0.1, random.rotation(), random.in_cube(1)});
  }
}

}  // namespace
}  // namespace voxshell::surface_voxels_test
