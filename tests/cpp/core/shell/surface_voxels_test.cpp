#include "shell/surface_voxels.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/brute_force.h"
#include "support/meshes.h"
#include "support/random.h"
#include "support/surface.h"

namespace voxshell {
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
    origin[axis] = mesh.bounds().centre()[axis] - 0.5 * voxels * spacing;
  }
  return origin;
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

TEST(SurfaceVoxels, ReachEveryPlaceOfTheSurfaceOnce) {
  Random random(80);
  for (const Soup& body : {make_corner_tetrahedron(1), make_box({0.5, 0.25, 1}), make_l_shape(0.5),
                           make_wedge(2, 0.01, 0.5), make_spike(0.1, 2), make_icosphere(1, 2),
                           make_blob(1, 3), make_torus(1, 0.25, 24, 12)}) {
    const TriangleMesh mesh = transformed(body, random.pose(1)).mesh();
    for (const double spacing : {0.07, 0.3, 3.0}) {
      expect_samples_are_sound(mesh, {spacing, {}});
      const auto samples = sample_surface_voxels(mesh, {spacing, {}});
      const Vec3 origin = grid_origin(mesh, spacing);
      std::set<std::array<std::int64_t, 3>> sampled;
      std::size_t on_borders = 0;
      for (const SurfaceSample& sample : samples) {
        const Place place = place_in_grid(sample.point, origin, spacing);
        if (place.is_clear) {
          EXPECT_TRUE(sampled.insert(place.voxel).second);
        } else {
          ++on_borders;
        }
      }
      const SurfaceSampler surface(mesh);
      std::set<std::array<std::int64_t, 3>> missed;
      for (int i = 0; i < 20'000; ++i) {
        const Place place = place_in_grid(surface(random), origin, spacing);
        if (place.is_clear && !sampled.contains(place.voxel)) missed.insert(place.voxel);
      }
      // A sample on the border between voxels stands for one that is missed here.
      EXPECT_LE(missed.size(), on_borders);
    }
  }
}

TEST(SurfaceVoxels, SampleIsTheClosestToTheCentreOfTheVoxel) {
  Random random(81);
  const TriangleMesh mesh = make_blob(1, 3).mesh();
  const double spacing = 0.2;
  const Vec3 origin = grid_origin(mesh, spacing);
  const auto samples = sample_surface_voxels(mesh, {spacing, {}});
  const SurfaceSampler surface(mesh);
  std::vector<std::pair<Place, Vec3>> places;
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 p = surface(random);
    places.emplace_back(place_in_grid(p, origin, spacing), p);
  }
  for (const SurfaceSample& sample : samples) {
    const Place place = place_in_grid(sample.point, origin, spacing);
    if (!place.is_clear) continue;
    Vec3 centre;
    for (int axis = 0; axis < 3; ++axis) {
      centre[axis] =
          origin[axis] +
          (static_cast<double>(place.voxel[static_cast<std::size_t>(axis)]) + 0.5) * spacing;
    }
    for (const auto& [other, p] : places) {
      if (other.voxel == place.voxel) {
        ASSERT_GE(length(p - centre), length(sample.point - centre) - 1e-9);
      }
    }
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
}  // namespace voxshell
