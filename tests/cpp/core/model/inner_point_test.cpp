#include <gtest/gtest.h>

#include "support/meshes.h"
#include "voxshell/model.h"

namespace voxshell::inner_point_test {
namespace {

using namespace test_support;

double depth_of_inner_point(const Soup& soup, double voxel_size) {
  const auto model = Model::build(soup.mesh(), {.voxel_size = voxel_size, .threads = 1});
  EXPECT_TRUE(model);
  return -static_cast<double>((*model)->grid().distance((*model)->inner_point()));
}

TEST(InnerPoint, IsDeepInside) {
  EXPECT_GT(depth_of_inner_point(make_box({0.1, 0.2, 0.3}), 0.01), 0.07);
  EXPECT_GT(depth_of_inner_point(make_icosphere(0.2, 3), 0.01), 0.15);
  EXPECT_GT(depth_of_inner_point(make_torus(0.4, 0.12, 40, 20), 0.02), 0.09);
}

TEST(InnerPoint, IsInsideAThinWall) {
  EXPECT_GT(depth_of_inner_point(make_box({0.5, 0.5, 0.004}), 0.005), 0.0);
}

}  // namespace
}  // namespace voxshell::inner_point_test
