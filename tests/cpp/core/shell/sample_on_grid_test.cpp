#include "shell/sample_on_grid.h"

#include <array>
#include <cstddef>
#include <set>

#include <gtest/gtest.h>

#include "base/stage.h"
#include "support/meshes.h"
#include "support/shells.h"

namespace voxshell::sample_on_grid_test {
namespace {

using namespace test_support;

TEST(SampleOnGrid, FarFromTheOriginMergesPlacesThatFloat32CannotTellApart) {
  // At 10 km neighbors in float32 are a millimeter apart.
  const TriangleMesh mesh = moved(make_box({0.01, 0.01, 0.01}), {1e4, 0, 0}).mesh();
  const PointShell shell = build_shell(mesh, {.spacing = 3e-4});
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

TEST(SampleOnGrid, TellsHowManySamplesItMerged) {
  const Soup box = make_box({0.01, 0.01, 0.01});
  const Progress no_progress;
  for (const double away : {0.0, 1e4}) {
    const TriangleMesh mesh = moved(box, {away, 0, 0}).mesh();
    Stage stage(no_progress, "point shell");
    const ShellSamples sampled = sample_on_grid(mesh, {3e-4, {}}, 1, stage);
    EXPECT_EQ(sampled.spacing, 3e-4);
    EXPECT_EQ(sampled.samples_taken > sampled.points.size(), away > 0.0);
    double area = 0.0;
    for (const ShellPoint& point : sampled.points) area += point.area;
    EXPECT_NEAR(area, mesh.compute_area(), 1e-5 * mesh.compute_area());
  }
}

}  // namespace
}  // namespace voxshell::sample_on_grid_test
