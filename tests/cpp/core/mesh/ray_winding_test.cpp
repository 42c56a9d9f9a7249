#include "mesh/ray_winding.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "support/brute_force.h"
#include "support/meshes.h"
#include "support/overlapping_boxes.h"
#include "support/random.h"

namespace voxshell::ray_winding_test {
namespace {

using namespace test_support;

/// Boxes in one another, some inside out, a cavity, and a body whose edges lie along the axes.
std::vector<TriangleMesh> make_balanced_meshes() {
  Random random(7);
  BoxUnion boxes;
  for (int i = 0; i < 20; ++i) {
    const Vec3 middle = random.in_cube(0.2);
    boxes.boxes.push_back({middle - Vec3{0.2, 0.1, 0.3}, middle + Vec3{0.1, 0.2, 0.1}});
  }
  const Soup cavity = together(make_box({0.5, 0.5, 0.5}), inverted(make_box({0.2, 0.2, 0.2})));
  return {boxes.soup().mesh(), cavity.mesh(), make_blob(0.5, 3).mesh(),
          together(make_blob(0.5, 3), inverted(make_icosphere(0.4, 2))).mesh(),
          moved(make_box({0.5, 0.25, 0.1}), {1e4, -1e4, 1e4}).mesh()};
}

TEST(RayWinding, IsTheNumberThatSolidAnglesGive) {
  Random random(11);
  for (const TriangleMesh& mesh : make_balanced_meshes()) {
    const RayWinding winding(mesh);
    int enclosed = 0;
    for (int i = 0; i < 500; ++i) {
      const Vec3 half = 0.55 * mesh.bounds().extents();
      const Vec3 p = mesh.bounds().center() + random.in_box(-half, half);
      const Vec3 q = p + 1e-3 * random.direction();
      std::size_t steps = 0;
      const auto numbers = winding.compute({p, q}, steps);
      EXPECT_LE(steps, mesh.triangles().size());
      if (!numbers) continue;
      EXPECT_EQ((*numbers)[0], std::lround(winding_number(p, mesh)));
      EXPECT_EQ((*numbers)[1], std::lround(winding_number(q, mesh)));
      if ((*numbers)[0] != 0) ++enclosed;
    }
    EXPECT_GT(enclosed, 50);
  }
}

TEST(RayWinding, SaysNothingOfPlacesOnTheSurface) {
  const TriangleMesh box = make_box({0.5, 0.25, 0.1}).mesh();
  const RayWinding winding(box);
  std::size_t steps = 0;
  for (const Vec3& p :
       {Vec3{0.5, 0.25, 0.1}, Vec3{0.5, 0.25, 0.0}, Vec3{0.5, 0.1, 0.02}, Vec3{-0.3, 0.0, -0.1}}) {
    EXPECT_FALSE(winding.compute({Vec3{}, p}, steps));
    EXPECT_TRUE(winding.compute({Vec3{}, 0.999 * p}, steps));
    EXPECT_TRUE(winding.compute({Vec3{}, 1.001 * p}, steps));
  }
}

}  // namespace
}  // namespace voxshell::ray_winding_test
