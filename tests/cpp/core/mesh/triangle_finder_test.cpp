#include "mesh/triangle_finder.h"

#include <gtest/gtest.h>

#include "support/brute_force.h"
#include "support/meshes.h"
#include "support/random.h"

namespace voxshell::triangle_finder_test {
namespace {

using namespace test_support;

TEST(TriangleFinder, FindsTheNearestTriangleFromAnyGuess) {
  const TriangleMesh mesh = make_torus(0.3, 0.1, 24, 12).mesh();
  const auto count = static_cast<double>(mesh.triangles().size());
  const TriangleFinder finder(mesh);
  Random random(7);
  for (int i = 0; i < 500; ++i) {
    const Vec3 place = random.in_cube(0.5);
    const auto guess = static_cast<std::uint32_t>(random.uniform(0.0, count));
    const std::uint32_t found = finder.find_nearest(place, guess);
    EXPECT_NEAR(distance_to_triangle(place, mesh.corners(found)), distance_to_mesh(place, mesh),
                1e-6);
  }
}

}  // namespace
}  // namespace voxshell::triangle_finder_test
