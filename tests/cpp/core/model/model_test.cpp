#include "voxshell/model.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "support/random.h"
#include "voxshell/contacts.h"

namespace voxshell::model_test {
namespace {

using namespace test_support;

using Built = Result<std::shared_ptr<const Model>>;

void expect_error(const Built& model, ErrorCode code, const std::string& reason) {
  ASSERT_FALSE(model) << "accepted, but expected: " << reason;
  EXPECT_EQ(model.error().code, code);
  EXPECT_NE(model.error().message.find(reason), std::string::npos) << model.error().message;
}

std::shared_ptr<const Model> build(const Soup& soup, const ModelSettings& settings) {
  auto model = Model::build(soup.mesh(), settings);
  EXPECT_TRUE(model) << model.error().message;
  if (!model) std::abort();
  return *std::move(model);
}

TEST(Model, IsExactToAToleranceThatFollowsFromSizeAndThicknessUnlessToldOtherwise) {
  const auto model = build(make_box({0.5, 0.25, 0.1}), {});
  EXPECT_DOUBLE_EQ(model->settings().tolerance, 0.0002);
  EXPECT_DOUBLE_EQ(build(make_box({0.2, 0.2, 0.1}), {})->settings().tolerance, 0.4 / 2000.0);
  EXPECT_TRUE(model->grid().has_exact_cells());
  EXPECT_NE(model->shell().edges(), nullptr);
  EXPECT_LT(model->accuracy().distance.worst, model->settings().tolerance);
  EXPECT_LT(model->accuracy().coverage.worst, model->settings().tolerance);
  EXPECT_DOUBLE_EQ(build(make_box({2.5, 2.5, 2.5}), {})->settings().tolerance, 5.0 / 20000.0);
  EXPECT_DOUBLE_EQ(build(make_box({1.5, 1.5, 1.5}), {})->settings().tolerance, 0.0002);
  EXPECT_NEAR(build(make_box({0.5, 0.5, 0.001}), {})->settings().tolerance, 0.0001, 1e-9);
}

TEST(Model, TakesEitherAToleranceOrSizes) {
  const auto mesh = make_box({0.5, 0.25, 0.1}).mesh();
  for (const ModelSettings& settings : {ModelSettings{.tolerance = 0.001, .voxel_size = 0.01},
                                        ModelSettings{.tolerance = 0.001, .target_points = 100},
                                        ModelSettings{.tolerance = -1.0}}) {
    const auto model = Model::build(mesh, settings);
    ASSERT_FALSE(model);
    EXPECT_EQ(model.error().code, ErrorCode::kInvalidArgument);
  }
}

TEST(Model, HasAHundredVoxelsWhereOnlyPointsAreAskedFor) {
  const auto model = build(make_box({0.5, 0.25, 0.1}), {.point_spacing = 0.01});
  EXPECT_DOUBLE_EQ(model->grid().voxel_size(), 0.01);
  EXPECT_EQ(model->shell().spacing(), model->grid().voxel_size());
  // Two bricks of padding on each side.
  EXPECT_NEAR(model->grid().origin().x, -0.5 - 0.16, 1e-12);
  EXPECT_GE(model->grid().shape()[0], 133);
  EXPECT_LE(model->grid().shape()[0], 141);
}

TEST(Model, TakesVoxelSizeOrResolutionAndSpacingOrTarget) {
  const Soup soup = make_box({0.5, 0.25, 0.1});
  EXPECT_EQ(build(soup, {.voxel_size = 0.05})->grid().voxel_size(), 0.05);
  EXPECT_DOUBLE_EQ(build(soup, {.resolution = 25})->grid().voxel_size(), 0.04);
  EXPECT_EQ(build(soup, {.voxel_size = 0.05, .point_spacing = 0.1})->shell().spacing(), 0.1);
  EXPECT_NEAR(
      static_cast<double>(build(soup, {.voxel_size = 0.05, .target_points = 500})->shell().size()),
      500.0, 5.0);
  const auto padded = build(soup, {.voxel_size = 0.05, .padding = 0.6});
  EXPECT_NEAR(padded->grid().origin().x, -1.1, 1e-12);
  // At least a brick is kept.
  EXPECT_NEAR(build(soup, {.voxel_size = 0.05, .padding = 0.0})->grid().origin().x, -0.9, 1e-12);
}

TEST(Model, ResolutionCountsAlongTheLongestSide) {
  for (const Vec3& half : {Vec3{1, 0.2, 0.3}, Vec3{0.2, 1, 0.3}, Vec3{0.2, 0.3, 1}}) {
    EXPECT_DOUBLE_EQ(build(make_box(half), {.resolution = 20})->grid().voxel_size(), 0.1);
  }
}

TEST(Model, RefusesSettingsThatContradict) {
  const Soup soup = make_box({0.5, 0.5, 0.5});
  expect_error(Model::build(soup.mesh(), {.voxel_size = 0.1, .resolution = 10}),
               ErrorCode::kInvalidArgument, "either a voxel size or a resolution");
  expect_error(
      Model::build(soup.mesh(), {.voxel_size = 0.1, .point_spacing = 0.1, .target_points = 100}),
      ErrorCode::kInvalidArgument, "either a point spacing or a number of target points");
}

TEST(Model, RefusesSizesAboveTheMeshAsOnesInAnotherUnit) {
  const TriangleMesh needle = make_box({0.1, 1e-3, 1e-3}).mesh();
  expect_error(Model::build(needle, {.voxel_size = 100}), ErrorCode::kInvalidMesh,
               "a longest side of 0.2 m, below the voxel size of 100 m: check their units");
  expect_error(Model::build(needle, {.resolution = 10, .point_spacing = 0.21}),
               ErrorCode::kInvalidMesh, "below the point spacing of 0.21 m: check their units");
  EXPECT_TRUE(Model::build(needle, {.voxel_size = 0.2}));
}

TEST(Model, AdvisesASettingThatFitsFieldAndShell) {
  // A sphere's shell was refused first, with the advice of a spacing that nobody had given.
  const TriangleMesh sphere = make_icosphere(0.1, 3).mesh();
  const auto refused = Model::build(sphere, {.voxel_size = 2e-5});
  expect_error(refused, ErrorCode::kTooLarge, "distance field of voxel size 2e-05 m");
  if (refused) return;
  const std::string& message = refused.error().message;
  const std::string before_number = "use a voxel size of at least ";
  const std::size_t at = message.find(before_number);
  ASSERT_NE(at, std::string::npos) << message;
  const auto at_work = [](std::string_view, double) { return false; };
  const double advised = std::stod(message.substr(at + before_number.size()));
  expect_error(Model::build(sphere, {.voxel_size = advised}, at_work), ErrorCode::kCanceled, "");
  const std::string before_count = "a resolution of at most ";
  const std::size_t count_at = message.find(before_count);
  ASSERT_NE(count_at, std::string::npos) << message;
  const int resolution = std::stoi(message.substr(count_at + before_count.size()));
  expect_error(Model::build(sphere, {.resolution = resolution}, at_work), ErrorCode::kCanceled, "");
}

TEST(Model, SaysThatASpacingWasTheVoxelSizeWhereNoneWasGiven) {
  // Four hundred sheets next to one another: a shell of as many times the points, in a field of
  // one.
  const Soup box = make_box({0.5, 0.5, 0.5});
  Soup sheets;
  for (int i = 0; i < 400; ++i) sheets = together(sheets, moved(box, {1e-6 * i, 0.0, 0.0}));
  expect_error(Model::build(sheets.mesh(), {.resolution = 200}), ErrorCode::kTooLarge,
               "m (it is the voxel size where none is given)");
  const auto refused = Model::build(sheets.mesh(), {.resolution = 200, .point_spacing = 0.005});
  expect_error(refused, ErrorCode::kTooLarge, "use a point spacing of at least");
  if (refused) return;
  EXPECT_EQ(refused.error().message.find("where none"), std::string::npos);
}

TEST(Model, RefusesSettingsThatMakeNoSense) {
  const Soup soup = make_box({0.5, 0.5, 0.5});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {-0.1, nan, infinity, -infinity}) {
    expect_error(Model::build(soup.mesh(), {.voxel_size = bad}), ErrorCode::kInvalidArgument,
                 "voxel size must be above 0 m");
    expect_error(Model::build(soup.mesh(), {.voxel_size = 0.1, .point_spacing = bad}),
                 ErrorCode::kInvalidArgument, "point spacing must be above 0 m");
  }
  for (const int resolution : {1, -1, std::numeric_limits<int>::min()}) {
    expect_error(Model::build(soup.mesh(), {.resolution = resolution}), ErrorCode::kInvalidArgument,
                 "at least 2 voxels along the longest side, not " + std::to_string(resolution));
  }
  for (const double bad : {nan, infinity}) {
    expect_error(Model::build(soup.mesh(), {.voxel_size = 0.1, .padding = bad}),
                 ErrorCode::kInvalidArgument, "padding");
  }
  // A negative padding means the default.
  EXPECT_NEAR(build(soup, {.voxel_size = 0.1, .padding = -7.0})->grid().origin().x, -2.1, 1e-12);
}

TEST(Model, RefusesMeshesThatEncloseNothing) {
  Soup open = make_box({0.5, 0.5, 0.5});
  open.triangles.pop_back();
  expect_error(Model::build(open.mesh(), {.resolution = 10, .sign = SignMethod::kClosed}),
               ErrorCode::kInvalidMesh, "not watertight");
  expect_error(Model::build(inverted(make_box({0.5, 0.5, 0.5})).mesh(),
                            {.resolution = 10, .sign = SignMethod::kClosed}),
               ErrorCode::kInvalidMesh, "inside out");
  const Soup nested = together(make_box({1, 1, 1}), make_box({0.5, 0.5, 0.5}));
  expect_error(Model::build(nested.mesh(), {.resolution = 20, .sign = SignMethod::kClosed}),
               ErrorCode::kInvalidMesh, "overlaps itself");
}

TEST(Model, TakesOpenNestedAndInvertedMeshesUnlessToldOtherwise) {
  const Soup sphere = make_icosphere(0.5, 3);
  const auto whole = build(sphere, {.resolution = 30});
  Soup holed = sphere;
  holed.triangles.pop_back();
  for (const Soup& soup :
       {holed, inverted(sphere), inverted(holed), together(sphere, make_box({0.1, 0.1, 0.1}))}) {
    const auto model = build(soup, {.resolution = 30});
    EXPECT_NEAR(model->grid().distance({0, 0, 0}), -0.5f, 0.07f);
    const MassProperties& solid = model->solid_mass_properties();
    EXPECT_NEAR(length(solid.center_of_mass), 0.0, 0.01);
    EXPECT_NEAR(solid.inertia.row_x.x, whole->solid_mass_properties().inertia.row_x.x, 0.003);
    // Normals of the shell point outwards.
    const auto& shell = model->shell();
    std::size_t outwards = 0;
    for (std::size_t i = 0; i < shell.size(); ++i) {
      outwards += dot(shell.normals()[i], shell.points()[i]) > 0.0f;
    }
    EXPECT_GT(outwards, shell.size() * 9 / 10);
  }
}

TEST(Model, RefusesBodiesTooFarFromTheirOriginForFloat32AndAdvisesAVoxelSize) {
  const Soup near = make_box({0.5, 0.5, 0.5});
  EXPECT_TRUE(Model::build(moved(near, {80, 0, 0}).mesh(), {.voxel_size = 0.02}));
  for (const Vec3& offset : {Vec3{1e3, 0, 0}, Vec3{0, -1e3, 0}, Vec3{0, 0, 1e3}}) {
    const Soup far = moved(near, offset);
    const auto refused = Model::build(far.mesh(), {.voxel_size = 0.05});
    expect_error(refused, ErrorCode::kInvalidMesh, "move it to its origin");
    if (refused) return;
    const std::string& message = refused.error().message;
    const std::string before_number = "voxel size of at least ";
    const std::size_t at = message.find(before_number);
    ASSERT_NE(at, std::string::npos) << message;
    const double advised = std::stod(message.substr(at + before_number.size()));
    EXPECT_TRUE(Model::build(far.mesh(), {.voxel_size = advised})) << message;
  }
  Random random(140);
  for (int trial = 0; trial < 50; ++trial) {
    const double distance = std::pow(10.0, random.uniform(3, 6));
    const Soup far = scaled(moved(near, {distance, 0, 0}), 0.001);
    const auto refused = Model::build(far.mesh(), {.voxel_size = 1e-9 * distance});
    expect_error(refused, ErrorCode::kInvalidMesh, "move it to its origin");
    if (refused) return;
    const std::string& message = refused.error().message;
    const std::size_t at = message.find("at least ");
    if (at == std::string::npos) continue;  // no voxel size below the mesh's own would do
    const double advised = std::stod(message.substr(at + 9));
    EXPECT_LT(advised, 1e-3) << message;
    const auto again = Model::build(far.mesh(), {.voxel_size = advised});
    EXPECT_TRUE(again || again.error().code != ErrorCode::kInvalidMesh) << message;
  }
}

/// Refusals that need no work come before any: nothing is ever reported.
void expect_error_at_once(const TriangleMesh& mesh, const ModelSettings& settings, ErrorCode code,
                          const std::string& reason) {
  expect_error(Model::build(mesh, settings,
                            [](std::string_view stage, double) {
                              ADD_FAILURE() << "already at work on the " << stage;
                              return false;
                            }),
               code, reason);
}

TEST(Model, RefusesBeforeItWorks) {
  const TriangleMesh box = make_box({0.5, 0.5, 0.5}).mesh();
  expect_error_at_once(box, {.resolution = 2000}, ErrorCode::kTooLarge, "distance field");
  expect_error_at_once(box, {.voxel_size = 2e-4}, ErrorCode::kTooLarge, "at least");
  expect_error_at_once(box, {.voxel_size = 1e-9}, ErrorCode::kInvalidMesh, "single precision");
  expect_error_at_once(box, {.tolerance = 1e-8}, ErrorCode::kInvalidMesh, "single precision");
  Soup far = make_box({0.5, 0.5, 0.5});
  for (Vec3& vertex : far.vertices) vertex.x += 1e6;
  expect_error_at_once(far.mesh(), {.voxel_size = 0.1}, ErrorCode::kInvalidMesh,
                       "check its unit, or move it to its origin (put the offset in the pose)");
  expect_error_at_once(box, {.resolution = 100, .point_spacing = 1e-5}, ErrorCode::kTooLarge,
                       "point shell");
  expect_error_at_once(box, {.resolution = 100, .point_spacing = 0.1, .target_points = 7},
                       ErrorCode::kInvalidArgument, "point spacing");
  Soup open = make_box({0.5, 0.5, 0.5});
  open.triangles.pop_back();
  expect_error_at_once(open.mesh(), {.resolution = 500, .sign = SignMethod::kClosed},
                       ErrorCode::kInvalidMesh, "not watertight");
}

TEST(Model, StopsAtEveryStageWhereProgressSaysSo) {
  const TriangleMesh mesh = make_blob(0.5, 3).mesh();
  for (const ModelSettings& settings :
       {ModelSettings{.resolution = 20}, ModelSettings{.resolution = 20, .target_points = 1000}}) {
    std::set<std::string> stages;
    int reports = 0;
    ASSERT_TRUE(Model::build(mesh, settings, [&](std::string_view stage, double fraction) {
      EXPECT_GE(fraction, 0.0);
      EXPECT_LE(fraction, 1.0);
      stages.emplace(stage);
      ++reports;
      return true;
    }));
    EXPECT_GE(stages.size(), 2u);
    EXPECT_TRUE(stages.contains("distance field"));
    for (const std::string& stop_in : stages) {
      bool asked = false;
      const auto stopped = Model::build(mesh, settings, [&](std::string_view stage, double) {
        EXPECT_FALSE(asked) << "a report after the request to stop, in " << stage;
        asked = stage == stop_in;
        return !asked;
      });
      expect_error(stopped, ErrorCode::kCanceled, "stopped");
      EXPECT_TRUE(asked);
    }
  }
}

TEST(Model, IsTheSameWithAnyNumberOfThreads) {
  const Soup soup = make_torus(0.4, 0.1, 30, 15);
  const auto one = build(soup, {.resolution = 40, .threads = 1});
  const auto seven = build(soup, {.resolution = 40, .threads = 7});
  EXPECT_EQ(one->grid().data().entries, seven->grid().data().entries);
  EXPECT_EQ(one->grid().data().samples, seven->grid().data().samples);
  EXPECT_TRUE(std::equal(one->shell().points().begin(), one->shell().points().end(),
                         seven->shell().points().begin(), seven->shell().points().end()));
}

TEST(Model, KeepsItsMeshBoundsAndMass) {
  const auto model = build(moved(make_box({0.3, 0.2, 0.1}), {1, 2, 3}), {.resolution = 20});
  EXPECT_EQ(model->mesh().triangles().size(), 12u);
  EXPECT_EQ(model->bounds().lower, (Vec3{0.7, 1.8, 2.9}));
  EXPECT_NEAR(model->solid_mass_properties().inertia.row_x.x, (0.16 + 0.04) / 12, 1e-12);
  EXPECT_GT(model->surface_mass_properties().inertia.row_x.x,
            model->solid_mass_properties().inertia.row_x.x);
  EXPECT_LE(length(model->solid_mass_properties().center_of_mass - Vec3{1, 2, 3}), 1e-12);
}

TEST(Model, OfAnySizeCollidesWithItself) {
  // From a micrometer to a kilometer, the same body gives the same contacts.
  std::size_t expected = 0;
  for (const double size : {1.0, 1e-6, 1e-3, 1e3}) {
    // By powers of two, so that rounding is the same.
    const double factor = std::exp2(std::round(std::log2(size)));
    const auto model = build(scaled(make_torus(0.4, 0.1, 24, 12), factor), {.resolution = 32});
    QueryScratch scratch;
    const auto contacts = find_contacts(model->field(), model->shell(),
                                        {{}, factor * Vec3{0.35, 0.05, 0.02}}, {}, scratch);
    if (size == 1.0) expected = contacts.size();
    EXPECT_GT(contacts.size(), 50u);
    EXPECT_EQ(contacts.size(), expected) << size;
  }
}

TEST(Model, KeepsABowlAsASheetUnlessToldToCloseIt) {
  const Soup bowl = opened(make_icosphere(0.1, 4), -1e-6);
  const auto sheet = build(bowl, {.resolution = 60});
  EXPECT_EQ(sheet->openings().loops, 1u);
  EXPECT_NEAR(sheet->openings().sheet_thickness, 2.0 * 0.2 / 60, 1e-3);
  EXPECT_GT(sheet->grid().distance({0.0f, 0.0f, -0.05f}), 0.0f);
  EXPECT_LT(sheet->grid().distance({0.0f, 0.0f, -0.1f}), 0.0f);
  // A shell with a thin wall, whose center is half of its radius below the rim.
  EXPECT_NEAR(sheet->solid_mass_properties().center_of_mass.z, -0.05, 0.003);

  const auto solid = build(bowl, {.resolution = 60, .open = OpenMesh::kSolid});
  EXPECT_EQ(solid->openings().sheet_thickness, 0.0);
  EXPECT_LT(solid->grid().distance({0.0f, 0.0f, -0.05f}), 0.0f);
  EXPECT_NEAR(solid->solid_mass_properties().center_of_mass.z, -0.1 * 3.0 / 8.0, 0.003);
}

TEST(Model, TakesTheThicknessOfASheet) {
  const Soup square{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}}};
  const auto model = build(square, {.resolution = 50, .sheet_thickness = 0.06});
  EXPECT_NEAR(model->bounds().upper.z, 0.03, 1e-12);
  EXPECT_NEAR(model->thickness(), 0.06, 1e-9);
  for (const double thickness : {-0.1, 1.0, std::numeric_limits<double>::quiet_NaN()}) {
    expect_error(Model::build(square.mesh(), {.sheet_thickness = thickness}),
                 ErrorCode::kInvalidArgument, "sheet thickness must be above 0 m");
  }
}

TEST(Model, ClosesABodyWithASmallHoleAsBefore) {
  Soup ball = make_icosphere(0.1, 4);
  ball.triangles.pop_back();
  const auto automatic = build(ball, {.resolution = 40});
  const auto solid = build(ball, {.resolution = 40, .open = OpenMesh::kSolid});
  EXPECT_EQ(automatic->openings().loops, 1u);
  EXPECT_EQ(automatic->openings().sheet_thickness, 0.0);
  EXPECT_EQ(automatic->solid_mass_properties().center_of_mass,
            solid->solid_mass_properties().center_of_mass);
  EXPECT_LT(automatic->grid().distance({0, 0, 0}), -0.09f);
}

}  // namespace
}  // namespace voxshell::model_test
