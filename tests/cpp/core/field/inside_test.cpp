#include "field/inside.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "field/brick_grid.h"
#include "mesh/surface_cutter.h"
#include "support/brute_force.h"
#include "support/meshes.h"

namespace voxshell::inside_test {
namespace {

using namespace test_support;

constexpr std::size_t kNodes = simd::kBrickCells + 1;

class InsideByWindingNumbersTest : public testing::Test {
 protected:
  InsideByWindingNumbersTest() {
    for (std::size_t z = 0; z < kNodes; ++z) {
      for (std::size_t y = 0; y < kNodes; ++y) {
        for (std::size_t x = 0; x < kNodes; ++x) {
          const Vec3 p =
              grid_.node(simd::kBrickCells * kBrick[0] + x, simd::kBrickCells * kBrick[1] + y,
                         simd::kBrickCells * kBrick[2] + z);
          nodes_.push_back(p);
          distances_.push_back(static_cast<float>(distance_to_mesh(p, mesh_) / grid_.voxel_size));
        }
      }
    }
  }

  std::vector<int> find_nodes(const InsideByWindingNumbers& inside) const {
    std::vector<int> layers(nodes_.size());
    inside.find_nodes(kBrick, distances_, layers);
    return layers;
  }

  static constexpr std::array<std::size_t, 3> kBrick{1, 2, 1};
  /// Open, with the limit of the inside across the opening.
  TriangleMesh mesh_ = opened(make_icosphere(0.5, 2), 0.2).mesh();
  BrickGrid grid_{{-0.8, -0.8, -0.8}, 0.05, {4, 4, 4}};
  SurfaceCutter cutter_{mesh_, false};
  std::vector<Vec3> nodes_;  ///< of the brick
  std::vector<float> distances_;
};

TEST_F(InsideByWindingNumbersTest, IsWhereTheFullSumIsAboveAHalf) {
  const InsideByWindingNumbers inside(grid_, mesh_.bounds(), cutter_);
  const std::vector<int> layers = find_nodes(inside);
  int inner = 0;
  for (std::size_t node = 0; node < layers.size(); ++node) {
    const double number = winding_number(nodes_[node], mesh_);
    if (std::abs(number - 0.5) < 0.05) continue;
    EXPECT_EQ(layers[node], number > 0.5 ? 1 : 0) << node;
    inner += layers[node];
  }
  EXPECT_GT(inner, 50);
  EXPECT_LT(inner, 700);
}

TEST_F(InsideByWindingNumbersTest, GivesTheSameWhereSidesAreKnown) {
  InsideByWindingNumbers inside(grid_, mesh_.bounds(), cutter_);
  const std::vector<int> found = find_nodes(inside);
  std::vector<double> numbers(nodes_.size());
  inside.compute(nodes_, numbers);
  const std::size_t brick = kBrick[0] + 4 * (kBrick[1] + 4 * kBrick[2]);
  inside.remember({{brick, decide_sides(numbers)}});
  EXPECT_EQ(find_nodes(inside), found);
}

/// Winding numbers of followed bricks were computed twice, which took a third of the build of open
/// meshes.
TEST_F(InsideByWindingNumbersTest, DoesNotComputeNumbersOfKnownBricksAgain) {
  InsideByWindingNumbers inside(grid_, mesh_.bounds(), cutter_);
  const std::vector<int> found = find_nodes(inside);
  std::vector<double> numbers(nodes_.size());
  inside.compute(nodes_, numbers);
  for (double& number : numbers) number = 1.0 - number;
  const std::size_t brick = kBrick[0] + 4 * (kBrick[1] + 4 * kBrick[2]);
  inside.remember({{brick, decide_sides(numbers)}});
  const std::vector<int> turned = find_nodes(inside);
  for (std::size_t node = 0; node < found.size(); ++node) {
    EXPECT_EQ(turned[node], 1 - found[node]) << node;
  }
}

}  // namespace
}  // namespace voxshell::inside_test
