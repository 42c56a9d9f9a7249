#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "field/brick_grid.h"
#include "support/brute_force.h"
#include "support/grid_bricks.h"
#include "support/grid_fields.h"
#include "support/meshes.h"
#include "support/random.h"
#include "voxshell/grid_field.h"

namespace voxshell::grid_field_build_test {
namespace {

using namespace test_support;

void expect_error(const Result<GridField>& field, ErrorCode code, const std::string& reason) {
  ASSERT_FALSE(field) << "accepted, but expected: " << reason;
  EXPECT_EQ(field.error().code, code);
  EXPECT_NE(field.error().message.find(reason), std::string::npos) << field.error().message;
}

TEST(GridFieldBuild, SamplesAreTheSameBitsWithAnyNumberOfThreads) {
  const TriangleMesh mesh = bodies()[1].mesh;
  const auto build_with = [&](unsigned threads) {
    auto field = GridField::build(mesh, {.voxel_size = 0.05, .threads = threads});
    EXPECT_TRUE(field);
    return *std::move(field);
  };
  const GridFieldData one = build_with(1).data();
  for (const unsigned threads : {2u, 7u, 0u}) {
    const GridFieldData other = build_with(threads).data();
    EXPECT_EQ(other.entries, one.entries);
    EXPECT_EQ(other.samples, one.samples);
    EXPECT_EQ(other.planes, one.planes);
    EXPECT_EQ(other.node_error, one.node_error);
    EXPECT_EQ(other.coarse_floors, one.coarse_floors);
  }
}

TEST(GridFieldBuild, KeepsTheLargerCellsTheFartherFromTheSurface) {
  Random random(82);
  std::array<int, simd::kCoarseSizes> counts{};
  for (const auto& [name, mesh, voxel_size] : bodies()) {
    const GridField field = build(mesh, 0.5 * voxel_size, 8.0 * voxel_size);
    const double h = field.voxel_size();
    const auto& floors = field.data().coarse_floors;
    for (std::size_t i = 0; i < floors.size(); ++i) {
      ASSERT_GT(floors[i], (kLeastFloors[i] - 0.01) * h) << name;
    }
    const Bounds bounds = grid_bounds(field);
    for (int i = 0; i < 1000; ++i) {
      const Vec3 p = static_cast<Vec3>(static_cast<Vec3f>(point_in(random, bounds)));
      const double size = cell_size_of(field, brick_at(field, p));
      if (size == 1.0) continue;
      const std::size_t at = size == 2.0 ? 0 : size == 4.0 ? 1 : 2;
      ASSERT_GE(distance_to_mesh(p, mesh), floors[at]) << name << ", cells of " << size;
      ASSERT_GE(std::abs(distance_at(field, p)), floors[at]) << name << ", cells of " << size;
      ++counts[at];
    }
  }
  for (const int count : counts) EXPECT_GT(count, 100);
}

TEST(GridFieldBuild, TakesFarMoreThreadsThanASystemGives) {
  const auto field =
      GridField::build(make_box({1, 1, 1}).mesh(), {.voxel_size = 0.02, .threads = 4'000'000'000u});
  ASSERT_TRUE(field);
  EXPECT_NEAR(field->distance({0, 0, 3}), 2.0f, 1e-6f);
}

TEST(GridFieldBuild, RefusesSettingsThatMakeNoSense) {
  const TriangleMesh mesh = make_box({1, 1, 1}).mesh();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double voxel_size : {0.0, -0.1, nan, infinity}) {
    expect_error(GridField::build(mesh, {.voxel_size = voxel_size}), ErrorCode::kInvalidArgument,
                 "voxel size must be above 0 m");
  }
  for (const double padding : {-0.1, nan, infinity}) {
    expect_error(GridField::build(mesh, {.voxel_size = 0.1, .padding = padding}),
                 ErrorCode::kInvalidArgument, "padding must be at least 0 m");
  }
  expect_error(GridField::build(mesh, {.voxel_size = -0.25}), ErrorCode::kInvalidArgument, "-0.25");
}

TEST(GridFieldBuild, RefusesOpenAndInsideOutMeshes) {
  Soup open = make_box({1, 1, 1});
  open.triangles.pop_back();
  expect_error(GridField::build(open.mesh(), {.voxel_size = 0.1, .sign = SignMethod::kClosed}),
               ErrorCode::kInvalidMesh, "3 open");
  expect_error(GridField::build(inverted(make_box({1, 1, 1})).mesh(),
                                {.voxel_size = 0.1, .sign = SignMethod::kClosed}),
               ErrorCode::kInvalidMesh, "inside out");
}

TEST(GridFieldBuild, RefusesAGridBeyondTheMemoryLimitAndAdvisesASizeThatFits) {
  Random random(80);
  for (int trial = 0; trial < 20; ++trial) {
    const Vec3 half{random.uniform(0.05, 1), random.uniform(0.05, 1), random.uniform(0.05, 1)};
    const TriangleMesh mesh = make_box(half).mesh();
    GridFieldSettings settings{.voxel_size = random.uniform(1e-4, 2e-3)};
    settings.memory_limit = static_cast<std::size_t>(std::pow(10.0, random.uniform(4.7, 6.5)));
    const auto refused = GridField::build(mesh, settings);
    expect_error(refused, ErrorCode::kTooLarge, "GB");
    if (refused) return;
    const std::string& message = refused.error().message;
    const std::string before_number = "use a voxel size of at least ";
    const std::size_t at = message.find(before_number);
    ASSERT_NE(at, std::string::npos) << message;
    settings.voxel_size = std::stod(message.substr(at + before_number.size()));
    const auto built = GridField::build(mesh, settings);
    ASSERT_TRUE(built) << "advised: " << message << "\nthen: " << built.error().message;
    EXPECT_LE(built->nbytes(), settings.memory_limit);
  }
}

TEST(GridFieldBuild, NamesThePaddingWhereItIsWhatIsTooLarge) {
  Random random(81);
  const TriangleMesh mesh = make_icosphere(0.1, 2).mesh();
  int both = 0;
  for (int trial = 0; trial < 20; ++trial) {
    GridFieldSettings settings{.voxel_size = std::pow(10.0, random.uniform(-4, -2)),
                               .padding = std::pow(10.0, random.uniform(2, 6))};
    settings.memory_limit = 20'000'000;
    const auto refused = GridField::build(mesh, settings);
    expect_error(refused, ErrorCode::kTooLarge, "use a padding of at most 0.2 m");
    if (refused) return;
    const std::string& message = refused.error().message;
    settings.padding = 0.2;
    const std::string before_number = "and a voxel size of at least ";
    if (const std::size_t at = message.find(before_number); at != std::string::npos) {
      ++both;
      settings.voxel_size = std::stod(message.substr(at + before_number.size()));
    }
    EXPECT_TRUE(GridField::build(mesh, settings)) << message;
  }
  EXPECT_GT(both, 0);
  EXPECT_LT(both, 20);
}

TEST(GridFieldBuild, RefusesMoreSamplesThanCanBeNumberedBeforeItBegins) {
  const TriangleMesh mesh = make_icosphere(0.1, 2).mesh();
  bool has_begun = false;
  const auto refused =
      GridField::build(mesh, {.voxel_size = 1e-3, .padding = 1.0}, [&](std::string_view, double) {
        has_begun = true;
        return false;
      });
  expect_error(refused, ErrorCode::kTooLarge, "padding of at most");
  EXPECT_FALSE(has_begun);
}

TEST(GridFieldBuild, RefusesMoreNodesAlongAnAxisThanFloat32CanNumber) {
  const TriangleMesh rod = make_box({1.0, 0.001, 0.001}).mesh();
  expect_error(GridField::build(rod, {.voxel_size = 1e-4}), ErrorCode::kTooLarge, "voxel size of");
  EXPECT_TRUE(GridField::build(rod, {.voxel_size = 4e-4}));
  // Numbers that overflow any count.
  expect_error(GridField::build(rod, {.voxel_size = 1e-300}), ErrorCode::kTooLarge,
               "voxel size of");
}

TEST(GridFieldBuild, RefusesOverlappingBodies) {
  const Soup sphere = make_icosphere(0.5, 3);
  const Soup overlapping = together(sphere, moved(sphere, {0.6, 0.1, 0.05}));
  expect_error(
      GridField::build(overlapping.mesh(), {.voxel_size = 0.05, .sign = SignMethod::kClosed}),
      ErrorCode::kInvalidMesh, "overlaps itself");
}

TEST(GridFieldBuild, RefusesNestedBodies) {
  const Soup nested = together(make_box({1, 1, 1}), make_box({0.5, 0.5, 0.5}));
  expect_error(GridField::build(nested.mesh(), {.voxel_size = 0.1, .sign = SignMethod::kClosed}),
               ErrorCode::kInvalidMesh, "overlaps itself");
}

TEST(GridFieldBuild, RefusesABodyInsideOutBesideAnother) {
  const Soup pair =
      together(make_box({1, 1, 1}), moved(inverted(make_box({0.5, 0.5, 0.5})), {3, 0, 0}));
  expect_error(GridField::build(pair.mesh(), {.voxel_size = 0.1, .sign = SignMethod::kClosed}),
               ErrorCode::kInvalidMesh, "inside out");
}

TEST(GridFieldBuild, ASpeckInsideOutThatIsSmallerThanAVoxelDoesNoHarm) {
  const Soup speck = moved(inverted(make_box({0.05, 0.05, 0.05})), {2, 0, 0});
  const GridField field = build(together(make_box({1, 1, 1}), speck).mesh(), 0.25);
  EXPECT_NEAR(field.distance({2, 0, 0}), 0.05f, 5e-4f);  // a node, and not inside of anything
  EXPECT_EQ(field.distance({0, 0, 0}), -1.0f);
}

TEST(GridFieldBuild, NamesAPlaceInTheOverlap) {
  const Soup overlapping =
      together(make_box({1, 1, 1}), moved(make_box({0.3, 0.3, 0.3}), {1.01, 0.5, 0.25}));
  const auto field =
      GridField::build(overlapping.mesh(), {.voxel_size = 0.05, .sign = SignMethod::kClosed});
  ASSERT_FALSE(field);
  const std::string& message = field.error().message;
  const std::size_t at = message.find("near [");
  ASSERT_NE(at, std::string::npos) << message;
  double x = 0;
  double y = 0;
  double z = 0;
  ASSERT_EQ(std::sscanf(message.c_str() + at, "near [%lf, %lf, %lf]", &x, &y, &z), 3) << message;
  EXPECT_TRUE(x > 0.7 && x < 1.0 && y > 0.2 && y < 0.8 && z > -0.05 && z < 0.55) << message;
}

TEST(GridFieldBuild, StopsWhereProgressSaysSo) {
  const TriangleMesh mesh = make_box({1, 1, 1}).mesh();
  int calls = 0;
  const auto stopped =
      GridField::build(mesh, {.voxel_size = 0.05}, [&](std::string_view stage, double fraction) {
        EXPECT_EQ(stage, "distance field");
        EXPECT_GE(fraction, 0.0);
        EXPECT_LE(fraction, 1.0);
        ++calls;
        return false;
      });
  expect_error(stopped, ErrorCode::kCanceled, "stopped");
  EXPECT_EQ(calls, 1);
}

TEST(GridFieldBuild, ReportsProgressUpToTheEnd) {
  double last = -1.0;
  const auto field = GridField::build(make_blob(1, 3).mesh(), {.voxel_size = 0.03, .threads = 2},
                                      [&](std::string_view, double fraction) {
                                        EXPECT_GE(fraction, last);
                                        last = fraction;
                                        return true;
                                      });
  ASSERT_TRUE(field);
  EXPECT_EQ(last, 1.0);
}

}  // namespace
}  // namespace voxshell::grid_field_build_test
