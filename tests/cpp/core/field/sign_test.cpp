#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "mesh/winding_number.h"
#include "support/brute_force.h"
#include "support/meshes.h"
#include "support/random.h"
#include "voxshell/grid_field.h"

namespace voxshell::sign_test {
namespace {

using namespace test_support;

GridField build(const Soup& soup, double voxel_size, SignMethod sign = SignMethod::kAutomatic) {
  auto field = GridField::build(soup.mesh(), {.voxel_size = voxel_size, .sign = sign});
  EXPECT_TRUE(field) << field.error().message;
  if (!field) std::abort();
  return *std::move(field);
}

double distance_at(const GridField& field, const Vec3& p) {
  return static_cast<double>(field.distance(static_cast<Vec3f>(p)));
}

/// Fails where two fields differ by more than a tolerance, which may be another one where they are
/// more than eight voxels deep.
void expect_same(const GridField& a, const GridField& b, double reach, double tolerance,
                 std::optional<double> deep_tolerance = {}) {
  Random random(300);
  int inside = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3 p = random.in_cube(reach);
    const bool is_deep = distance_at(a, p) < -8.0 * a.voxel_size();
    ASSERT_NEAR(distance_at(a, p), distance_at(b, p),
                is_deep ? deep_tolerance.value_or(tolerance) : tolerance)
        << p.x << " " << p.y << " " << p.z;
    inside += distance_at(a, p) < 0.0;
  }
  EXPECT_GT(inside, 100);
}

TEST(Sign, WindingNumbersAreThoseOfTheFullSum) {
  Random random(301);
  const std::vector<Soup> soups{make_blob(0.5, 3), opened(make_icosphere(0.5, 3), 0.2),
                                make_torus(0.5, 0.2, 30, 20)};
  for (const Soup& soup : soups) {
    const TriangleMesh mesh = soup.mesh();
    const WindingNumberTree tree(mesh);
    for (int i = 0; i < 500; ++i) {
      const Vec3 p = random.in_cube(1.0);
      ASSERT_NEAR(tree.compute(p), winding_number(p, mesh), 0.04);
    }
  }
}

TEST(Sign, WindingNumbersOfFewTrianglesAreThoseOfTheFormula) {
  Random random(9);
  for (int round = 0; round < 200; ++round) {
    Soup soup;
    // As many as are summed as one, most of them seen under large angles.
    for (std::uint32_t i = 0; i < 8; ++i) {
      for (int k = 0; k < 3; ++k) soup.vertices.push_back(random.in_cube(1.0));
      soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    const TriangleMesh mesh = soup.mesh();
    const WindingNumberTree tree(mesh);
    for (int i = 0; i < 20; ++i) {
      const auto [a, b, c] = mesh.corners(static_cast<std::size_t>(i % 8));
      const Vec3 near = (a + b + c) / 3.0 + random.in_cube(i < 10 ? 0.5 : 1e-3);
      ASSERT_NEAR(tree.compute(near), winding_number(near, mesh), 1e-12);
    }
  }
}

TEST(Sign, ClosedMeshesAreTakenAsSuch) {
  const GridField field = build(make_blob(0.5, 3), 0.03);
  EXPECT_EQ(field.sign_report().method, SignMethod::kClosed);
  EXPECT_EQ(field.sign_report().confidence, 1.0);
  EXPECT_FALSE(field.sign_report().was_turned);
  EXPECT_EQ(field.sign_report().cap_error, 0.0);
}

TEST(Sign, WindingNumbersAgreeWithRowsOnClosedMeshes) {
  for (const Soup& soup : {make_blob(0.5, 3), make_torus(0.5, 0.2, 30, 20), make_l_shape(0.4)}) {
    const GridField by_rows = build(soup, 0.03, SignMethod::kClosed);
    const GridField by_winding = build(soup, 0.03, SignMethod::kWinding);
    EXPECT_EQ(by_winding.sign_report().method, SignMethod::kWinding);
    EXPECT_GT(by_winding.sign_report().confidence, 0.95);
    EXPECT_EQ(by_winding.sign_report().hidden_triangles, 0u);
    EXPECT_EQ(by_winding.sign_report().cap_error, 0.0);
    EXPECT_EQ(by_winding.data().entries, by_rows.data().entries);
    EXPECT_EQ(by_winding.data().samples, by_rows.data().samples);
  }
}

TEST(Sign, MeshesInsideOutAreTurned) {
  const Soup soup = make_blob(0.5, 3);
  const GridField field = build(inverted(soup), 0.03);
  EXPECT_TRUE(field.sign_report().was_turned);
  EXPECT_EQ(field.sign_report().method, SignMethod::kClosed);
  EXPECT_EQ(field.data().samples, build(soup, 0.03).data().samples);
  const GridField by_winding = build(inverted(opened(soup, 0.35)), 0.03);
  EXPECT_TRUE(by_winding.sign_report().was_turned);
  EXPECT_LT(distance_at(by_winding, {}), -0.3);
}

TEST(Sign, ASmallHoleLeavesTheRestAsItIs) {
  const Soup whole = make_icosphere(0.5, 4);
  Soup holed = whole;
  holed.triangles.erase(holed.triangles.begin(), holed.triangles.begin() + 2);
  const GridField field = build(holed, 0.025);
  const SignReport& report = field.sign_report();
  EXPECT_EQ(report.method, SignMethod::kWinding);
  EXPECT_GT(report.defects.open_edges, 2u);
  EXPECT_NEAR(length(report.first_location), 0.5, 0.01);
  EXPECT_GT(report.confidence, 0.9);
  expect_same(field, build(whole, 0.025), 0.6, 0.03 + report.cap_error);
}

TEST(Sign, ALargeHoleIsClosedAlongTheLimitOfTheInside) {
  const double h = 0.025;
  const Soup bowl = opened(make_icosphere(0.5, 3), 0.2);
  const TriangleMesh mesh = bowl.mesh();
  const GridField field = build(bowl, h);
  EXPECT_GT(field.sign_report().cap_error, h);
  EXPECT_GT(field.interpolation_error(), 2 * h);
  Random random(302);
  int inside = 0;
  for (int i = 0; i < 1200; ++i) {
    const Vec3 p = random.in_cube(0.55);
    const double d = distance_at(field, p);
    const double w = winding_number(p, mesh);
    // Clear of the limit, the sign is that of the winding number.
    if (std::abs(w - 0.5) > 0.2 && distance_to_mesh(p, mesh) > h) {
      ASSERT_EQ(d < 0.0, w > 0.5) << p.x << " " << p.y << " " << p.z << " " << w << " " << d;
      inside += d < 0.0;
    }
    // No farther from the surface than from the mesh.
    ASSERT_LE(std::abs(d), distance_to_mesh(p, mesh) + 8 * field.interpolation_error());
  }
  EXPECT_GT(inside, 60);
  // Across the hole the field passes through zero without a jump.
  double before = distance_at(field, {0.0, 0.0, -0.4});
  for (double z = -0.4; z < 0.6; z += 0.1 * h) {
    const double here = distance_at(field, {0.0, 0.0, z});
    ASSERT_LE(std::abs(here - before), 1.0 * h) << z;
    before = here;
  }
}

TEST(Sign, PartsInsideOthersAreNoSurface) {
  const Soup outer = make_box({0.5, 0.5, 0.5});
  const GridField nested = build(together(outer, make_box({0.2, 0.2, 0.2})), 0.025);
  EXPECT_EQ(nested.sign_report().method, SignMethod::kWinding);
  EXPECT_EQ(nested.sign_report().hidden_triangles, 12u);
  EXPECT_GT(nested.sign_report().overlaps, 0u);
  expect_same(nested, build(outer, 0.025), 0.6, 1e-6);
}

TEST(Sign, OverlappingPartsAreOne) {
  const Soup pair = together(make_icosphere(0.4, 4), moved(make_icosphere(0.4, 4), {0.3, 0, 0}));
  const GridField field = build(pair, 0.02);
  EXPECT_EQ(field.sign_report().method, SignMethod::kWinding);
  EXPECT_GT(field.sign_report().hidden_triangles, 500u);
  EXPECT_NEAR(distance_at(field, {0.15, 0, 0}), -std::sqrt(0.16 - 0.0225), 0.03);
  EXPECT_NEAR(distance_at(field, {0, 0, 0}), -0.4, 0.03);
  EXPECT_NEAR(distance_at(field, {0, 0, 0.5}), 0.1, 0.01);
}

TEST(Sign, DuplicatedAndNonManifoldFacesDoNoHarm) {
  const Soup box = make_box({0.5, 0.4, 0.3});
  Soup doubled = box;
  doubled.triangles.insert(doubled.triangles.end(), box.triangles.begin(), box.triangles.end());
  // Of two faces that are equally near, either may be taken for the nearest where cells are chosen.
  expect_same(build(doubled, 0.025), build(box, 0.025), 0.6, 1e-6, 0.025);

  Soup finned = box;  // a fin stands on an edge
  finned.vertices.push_back({0.0, 0.9, 0.3});
  finned.triangles.push_back({6, 7, 8});
  const GridField field = build(finned, 0.025);
  EXPECT_GT(field.sign_report().defects.non_manifold_edges, 0u);
  EXPECT_LT(distance_at(field, {0, 0, 0}), -0.25);
  EXPECT_GT(distance_at(field, {0, 0.6, 0.1}), 0.05);
}

TEST(Sign, WronglyTurnedTrianglesAreOutvoted) {
  Soup soup = make_icosphere(0.5, 4);
  for (const std::size_t i : {10u, 500u, 2000u})
    std::swap(soup.triangles[i][1], soup.triangles[i][2]);
  const GridField field = build(soup, 0.025);
  EXPECT_GT(field.sign_report().defects.flipped_edges, 0u);
  EXPECT_NEAR(distance_at(field, {}), -0.5, 0.05);
  EXPECT_GT(distance_at(field, {0.6, 0, 0}), 0.05);
}

/// A square of `n` x `n` cells with bumps of this height.
Soup make_sheet(int n, double height) {
  Random random(304);
  Soup soup;
  for (int j = 0; j <= n; ++j) {
    for (int i = 0; i <= n; ++i) {
      soup.vertices.push_back(
          {static_cast<double>(i) / n, static_cast<double>(j) / n, random.uniform(0.0, height)});
    }
  }
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const auto at = static_cast<std::uint32_t>(i + (n + 1) * j);
      const auto above = static_cast<std::uint32_t>(at + static_cast<std::uint32_t>(n) + 1);
      soup.triangles.push_back({at, at + 1, above + 1});
      soup.triangles.push_back({at, above + 1, above});
    }
  }
  return soup;
}

TEST(Sign, SheetsAreRefusedAtAnyVoxelSize) {
  for (const double height : {0.0, 0.02, 0.1}) {
    const TriangleMesh sheet = make_sheet(12, height).mesh();
    for (const double voxel_size : {0.1, 0.03, 0.01}) {
      const auto field = GridField::build(sheet, {.voxel_size = voxel_size});
      ASSERT_FALSE(field) << height << " " << voxel_size;
      EXPECT_EQ(field.error().code, ErrorCode::kInvalidMesh);
      EXPECT_NE(field.error().message.find("inside is ambiguous"), std::string::npos)
          << field.error().message;
    }
  }
}

TEST(Sign, ConfidenceIsTheMeshsOwnWhateverTheVoxels) {
  double before = 1.1;
  for (const double opening : {0.3, -0.1}) {
    const Soup bowl = opened(make_icosphere(0.5, 4), opening);
    const double confidence = build(bowl, 0.02).sign_report().confidence;
    EXPECT_EQ(build(bowl, 0.1).sign_report().confidence, confidence) << opening;
    EXPECT_LT(confidence, before) << opening;
    before = confidence;
  }
  EXPECT_LT(before, 0.9);
}

TEST(Sign, ASoupIsRefusedOrSoundButNeverCrashes) {
  Random random(303);
  for (int trial = 0; trial < 6; ++trial) {
    Soup soup;
    for (std::uint32_t i = 0; i < 60; ++i) {
      const Vec3 at = random.in_cube(0.4);
      for (int corner = 0; corner < 3; ++corner) soup.vertices.push_back(at + random.in_cube(0.2));
      soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    const auto field = GridField::build(soup.mesh(), {.voxel_size = 0.05});
    if (!field) {
      EXPECT_EQ(field.error().code, ErrorCode::kInvalidMesh);
      continue;
    }
    EXPECT_GE(field->sign_report().confidence, 0.5);
    for (int i = 0; i < 200; ++i)
      EXPECT_TRUE(std::isfinite(distance_at(*field, random.in_cube(1))));
  }
}

TEST(Sign, OpenMeshesAreTheSameBitsWithAnyNumberOfThreads) {
  const TriangleMesh mesh = opened(make_blob(0.5, 3), 0.3).mesh();
  const auto one = GridField::build(mesh, {.voxel_size = 0.04, .threads = 1});
  const auto seven = GridField::build(mesh, {.voxel_size = 0.04, .threads = 7});
  ASSERT_TRUE(one && seven);
  EXPECT_EQ(one->data().entries, seven->data().entries);
  EXPECT_EQ(one->data().samples, seven->data().samples);
  EXPECT_EQ(one->sign_report().confidence, seven->sign_report().confidence);
}

TEST(Sign, OpenMeshesAreRefusedWhereTheyMustBeClosed) {
  const Soup bowl = opened(make_icosphere(0.5, 3), 0.2);
  const auto field =
      GridField::build(bowl.mesh(), {.voxel_size = 0.05, .sign = SignMethod::kClosed});
  ASSERT_FALSE(field);
  EXPECT_NE(field.error().message.find("not watertight"), std::string::npos);
  EXPECT_NE(field.error().message.find("; repair it, or find its inside automatically"),
            std::string::npos);
}

}  // namespace
}  // namespace voxshell::sign_test
