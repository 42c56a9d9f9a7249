#include "model/measure_accuracy.h"

#include <cmath>
#include <cstddef>
#include <memory>

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "voxshell/model.h"

namespace voxshell::measure_accuracy_test {
namespace {

using namespace test_support;

constexpr double kDegree = 0.017453292519943295;

std::shared_ptr<const Model> build(const Soup& soup, const ModelSettings& settings) {
  auto model = Model::build(soup.mesh(), settings);
  EXPECT_TRUE(model) << model.error().message;
  if (!model) std::abort();
  return *std::move(model);
}

bool is_ordered(const ErrorStatistic& errors) {
  return 0.0 <= errors.median && errors.median <= errors.p99 && errors.p99 <= errors.worst;
}

TEST(Accuracy, IsMeasuredAtAHundredThousandPlacesOfAnyMesh) {
  for (const Soup& soup : {make_box({0.5, 0.25, 0.1}), make_icosphere(0.1, 6),
                           make_corner_tetrahedron(1.0), make_blob(0.1, 3)}) {
    const Accuracy accuracy = build(soup, {.resolution = 20})->accuracy();
    EXPECT_GE(accuracy.places, 100'000u);
    EXPECT_TRUE(is_ordered(accuracy.distance));
    EXPECT_TRUE(is_ordered(accuracy.normal));
    EXPECT_TRUE(is_ordered(accuracy.coverage));
  }
}

// Between points that are s apart a ball stands out by s^2 / (2 r), with s up to the diagonal of a
// voxel, and trilinear distances are too small by about h^2 / (4 r).
TEST(Accuracy, OfABallFollowsFromItsRadius) {
  constexpr double kRadius = 0.1;
  const Soup soup = make_icosphere(kRadius, 6);
  for (const int resolution : {50, 100}) {
    const auto model = build(soup, {.resolution = resolution});
    const Accuracy& accuracy = model->accuracy();
    const double voxel = model->grid().voxel_size();
    EXPECT_LT(accuracy.distance.worst, voxel * voxel / kRadius);
    EXPECT_GT(accuracy.distance.p99, 0.1 * voxel * voxel / kRadius);
    EXPECT_LT(accuracy.coverage.worst, 3.0 * voxel * voxel / (2.0 * kRadius));
    EXPECT_GT(accuracy.coverage.worst, 0.2 * voxel * voxel / (2.0 * kRadius));
    EXPECT_LE(accuracy.gap, std::sqrt(3.0) * model->shell().spacing());
    EXPECT_LT(accuracy.normal.worst, 4.0 * kDegree);
    EXPECT_FALSE(accuracy.is_sharp);
    EXPECT_NEAR(accuracy.curvature, 1.0 / kRadius, 0.25 / kRadius);
  }
}

TEST(Accuracy, OfABoxIsExactAwayFromItsEdges) {
  const auto model = build(make_box({0.5, 0.5, 0.5}), {.resolution = 50});
  const Accuracy& accuracy = model->accuracy();
  EXPECT_LT(accuracy.distance.p99, 1e-5);
  EXPECT_LT(accuracy.normal.median, 0.1 * kDegree);
  // Within a cell of an edge the gradient is a mean of those of the faces.
  EXPECT_GT(accuracy.normal.worst, 20.0 * kDegree);
  EXPECT_TRUE(accuracy.is_sharp);
  EXPECT_EQ(accuracy.curvature, 0.0);
}

TEST(Accuracy, TellsHowFarEdgesStandOutBetweenPoints) {
  const Matrix3 turned{
      {2.0 / 3, -1.0 / 3, 2.0 / 3}, {2.0 / 3, 2.0 / 3, -1.0 / 3}, {-1.0 / 3, 2.0 / 3, 2.0 / 3}};
  const Soup box = transformed(make_box({0.5, 0.4, 0.3}), Pose{turned, {}});
  const auto model = build(box, {.resolution = 50});
  EXPECT_GT(model->accuracy().coverage.worst, 0.1 * model->shell().spacing());
  EXPECT_LT(model->accuracy().coverage.worst, 1.8 * model->shell().spacing());
  EXPECT_LT(model->accuracy().coverage.median, 1e-6);
}

TEST(Accuracy, OfATorusShrinksWithTheSquareOfTheVoxels) {
  const Soup torus = make_torus(0.1, 0.03, 192, 96);
  const Accuracy coarse = build(torus, {.resolution = 50})->accuracy();
  const Accuracy fine = build(torus, {.resolution = 100})->accuracy();
  EXPECT_NEAR(coarse.distance.p99 / fine.distance.p99, 4.0, 1.5);
  // Of polygons: that of the faces themselves does not shrink.
  EXPECT_NEAR(coarse.coverage.p99 / fine.coverage.p99, 4.0, 2.0);
  EXPECT_LT(fine.normal.p99, 0.7 * coarse.normal.p99);
  EXPECT_NEAR(fine.curvature, 1.0 / 0.03, 0.6 / 0.03);
}

TEST(Accuracy, OfModelsByToleranceKeepsTheToleranceOfTheShell) {
  for (const Soup& soup :
       {make_torus(0.1, 0.03, 192, 96), make_blob(0.1, 4), make_icosphere(0.1, 4)}) {
    const auto model = build(soup, {.tolerance = 0.0003});
    const double worst = model->accuracy().coverage.worst;
    EXPECT_LE(worst, 0.0003);
    EXPECT_GT(worst, 0.0001) << "the test asks for nothing";
    double area = 0.0;
    for (const float of_point : model->shell().areas()) area += static_cast<double>(of_point);
    EXPECT_NEAR(area / model->mesh().compute_area(), 1.0, 1e-4)
        << "points that are added have none";
  }
}

TEST(Accuracy, HasTheSameBitsForAnyNumberOfThreads) {
  const auto model = build(make_blob(0.1, 4), {.resolution = 40});
  const auto measure = [&](unsigned threads) {
    PointShell shell = model->shell();
    return measure_accuracy(model->mesh(), model->grid(), shell,
                            {.thickness = model->thickness(), .threads = threads});
  };
  const Accuracy one = measure(1);
  for (const unsigned threads : {2u, 5u}) {
    const Accuracy other = measure(threads);
    EXPECT_EQ(one.distance.p99, other.distance.p99);
    EXPECT_EQ(one.normal.worst, other.normal.worst);
    EXPECT_EQ(one.normal.median, other.normal.median);
    EXPECT_EQ(one.coverage.p99, other.coverage.p99);
    EXPECT_EQ(one.gap, other.gap);
  }
}

/// Only places that added points may be the nearest to are measured again.
TEST(Accuracy, OfAShellThatHasGrownIsThatOfTheShellMeasuredAnew) {
  for (const Soup& soup : {make_blob(0.1, 4), make_torus(0.1, 0.03, 48, 24)}) {
    const auto model = build(soup, {.resolution = 20});
    PointShell shell = model->shell();
    const auto measure = [&](double tolerance) {
      return measure_accuracy(model->mesh(), model->grid(), shell,
                              {.thickness = model->thickness(), .tolerance = tolerance});
    };
    const double coverage = model->accuracy().coverage.worst;
    const Accuracy grown = measure(0.3 * coverage);
    EXPECT_GT(shell.size(), model->shell().size() + 50);
    EXPECT_LT(grown.coverage.worst, coverage);
    const Accuracy anew = measure(0.0);
    EXPECT_EQ(grown.coverage.median, anew.coverage.median);
    EXPECT_EQ(grown.coverage.p99, anew.coverage.p99);
    EXPECT_EQ(grown.coverage.worst, anew.coverage.worst);
    EXPECT_EQ(grown.gap, anew.gap);
  }
}

TEST(Accuracy, LeavesOutSurfaceThatLiesInsideOfOtherParts) {
  const Soup cross = together(make_box({0.5, 0.1, 0.1}), make_box({0.1, 0.5, 0.1}));
  const Accuracy accuracy = build(cross, {.resolution = 50})->accuracy();
  // The walls inside are 0.1 m deep.
  EXPECT_LT(accuracy.distance.p99, 0.02);
}

}  // namespace
}  // namespace voxshell::measure_accuracy_test
