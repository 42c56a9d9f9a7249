#include "shell/sample_by_target.h"

#include <cmath>
#include <cstddef>
#include <string>

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "support/random.h"
#include "support/shells.h"

namespace voxshell::sample_by_target_test {
namespace {

using namespace test_support;

TEST(SampleByTarget, IsReachedWithinOnePercent) {
  Random random(95);
  for (const auto& [name, mesh] : make_named_meshes()) {
    for (const std::size_t target : {50u, 100u, 137u, 400u, 799u, 2000u, 5000u, 12'345u}) {
      const auto shell = PointShell::build(mesh, {.target_points = target});
      ASSERT_TRUE(shell) << name << ": " << shell.error().message;
      const double miss =
          std::abs(static_cast<double>(shell->size()) - static_cast<double>(target));
      EXPECT_LE(miss, 0.01 * static_cast<double>(target)) << name;
      if (target == 799u) {
        expect_sound(*shell, mesh, name);
        expect_covers(*shell, mesh, random, name);
      }
    }
  }
}

TEST(SampleByTarget, OfFewPointsIsReachedToThePoint) {
  // Targets below 100 points leave no room for an error of one percent.
  for (const auto& [name, mesh] : make_named_meshes()) {
    for (const std::size_t target : {5u, 8u, 13u, 20u, 21u, 33u, 51u, 89u}) {
      const auto shell = PointShell::build(mesh, {.target_points = target});
      ASSERT_TRUE(shell) << name << ": " << shell.error().message;
      EXPECT_EQ(shell->size(), target) << name;
    }
  }
}

TEST(SampleByTarget, BelowTheSidesOfABodyIsRefused) {
  // A closed body has sides that face away from one another: two to four points at least.
  const auto refused = PointShell::build(make_icosphere(0.5, 3).mesh(), {.target_points = 1});
  expect_error(refused, ErrorCode::kInvalidArgument, "the nearest count found is 4");
}

TEST(SampleByTarget, BeyondWhatFloat32CanTellApartIsRefusedWithTheNearestCount) {
  // At 10 km in every direction a cube of 2 mm has 27 places.
  const TriangleMesh mesh = moved(make_box({0.001, 0.001, 0.001}), {1e4, 1e4, 1e4}).mesh();
  for (const std::size_t target : {1000u, 20'000u}) {
    const auto refused = PointShell::build(mesh, {.target_points = target});
    expect_error(refused, ErrorCode::kInvalidArgument,
                 "gives " + std::to_string(target) + " points within 1 %");
    if (refused) return;
    const std::string& message = refused.error().message;
    const std::size_t at = message.find("nearest count found is ");
    ASSERT_NE(at, std::string::npos) << message;
    const unsigned long nearest = std::stoul(message.substr(at + 23));
    EXPECT_GE(nearest, 8u);
    EXPECT_LE(nearest, 27u);
  }
}

TEST(SampleByTarget, OnAWire) {
  // A spacing from the area alone would begin with five million voxels.
  const TriangleMesh wire = make_box({0.5, 1e-12, 1e-12}).mesh();
  EXPECT_NEAR(static_cast<double>(build_shell(wire, {.target_points = 200}).size()), 200.0, 2.0);
}

TEST(SampleByTarget, OfManyPoints) {
  for (const std::size_t target : {35'596u, 50'000u}) {
    for (const std::size_t body : {0u, 5u, 6u}) {
      const NamedMesh chosen = make_named_meshes()[body];
      const PointShell shell = build_shell(chosen.mesh, {.target_points = target});
      EXPECT_NEAR(static_cast<double>(shell.size()), static_cast<double>(target),
                  0.01 * static_cast<double>(target))
          << chosen.name;
    }
  }
}

}  // namespace
}  // namespace voxshell::sample_by_target_test
