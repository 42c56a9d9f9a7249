#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/brute_force.h"
#include "support/flat_loop.h"
#include "support/meshes.h"
#include "support/overlapping_boxes.h"
#include "support/random.h"
#include "voxshell/model.h"

namespace voxshell::overlapping_parts_test {
namespace {

using namespace test_support;

std::shared_ptr<const Model> build(const Soup& soup, const ModelSettings& settings) {
  auto model = Model::build(soup.mesh(), settings);
  EXPECT_TRUE(model) << model.error().message;
  if (!model) std::abort();
  return *std::move(model);
}

std::vector<BoxUnion> all_unions() {
  return {make_two_boxes(), make_pierced_box(), make_touching_boxes(), make_shallow_boxes()};
}

/// Uniform, and to a tolerance.
constexpr double kTolerance = 2e-4;
const std::vector<ModelSettings>& all_settings() {
  static const auto* all =
      new std::vector<ModelSettings>{{.voxel_size = 2e-3}, {.tolerance = kTolerance}};
  return *all;
}

double distance_at(const Model& model, const Vec3& p) {
  return static_cast<double>(model.grid().distance(static_cast<Vec3f>(p)));
}

TEST(OverlappingParts, HaveTheFieldOfTheirUnion) {
  for (const BoxUnion& boxes : all_unions()) {
    const auto faces = boxes.find_faces();
    for (const ModelSettings& settings : all_settings()) {
      const auto model = build(boxes.soup(), settings);
      const double h = model->grid().voxel_size();
      Random random(503);
      int inside = 0;
      double worst_at_surface = 0.0;
      for (int i = 0; i < 6000; ++i) {
        const auto& face = faces[random.below(faces.size())];
        const Vec3 on = random.in_box(face.lower, face.upper);
        worst_at_surface = std::max(worst_at_surface, std::abs(distance_at(*model, on)));
        const Vec3 p = on + random.in_cube(3.0 * h);
        const double d = boxes.distance(faces, p);
        ASSERT_NEAR(distance_at(*model, p), d, model->grid().interpolation_error())
            << p.x << " " << p.y << " " << p.z;
        inside += d < 0.0;
      }
      EXPECT_GT(inside, 1000);
      EXPECT_LE(worst_at_surface, settings.tolerance > 0.0 ? kTolerance : 0.6 * h);
    }
  }
}

TEST(OverlappingParts, HaveNoElementsInOneAnother) {
  for (const BoxUnion& boxes : all_unions()) {
    const auto faces = boxes.find_faces();
    for (const ModelSettings& settings : all_settings()) {
      const auto model = build(boxes.soup(), settings);
      const PointShell& shell = model->shell();
      const auto expect_on_surface = [&](const Vec3f& p) {
        ASSERT_NEAR(boxes.distance(faces, static_cast<Vec3>(p)), 0.0, 1e-6);
      };
      double area = 0.0;
      for (const float of_point : shell.areas()) area += static_cast<double>(of_point);
      EXPECT_NEAR(area / BoxUnion::area(faces), 1.0, 1e-3);
      for (const Vec3f& p : shell.points()) expect_on_surface(p);
      if (settings.tolerance == 0.0) continue;
      ASSERT_NE(shell.edges(), nullptr);
      for (std::size_t i = 0; i < shell.edges()->size(); ++i) {
        const Vec3f middle = shell.edges()->middles()[i];
        const Vec3f half = shell.edges()->halves()[i];
        for (const float fraction : {-1.0f, -0.5f, 0.0f, 0.5f, 1.0f}) {
          expect_on_surface(middle + fraction * half);
        }
      }
      // None is missing where it is visible.
      EXPECT_LE(model->accuracy().coverage.worst, kTolerance);
    }
  }
}

TEST(OverlappingParts, AreMeasuredWhereTheyAreVisible) {
  for (const BoxUnion& boxes : all_unions()) {
    const auto by_tolerance = build(boxes.soup(), {.tolerance = kTolerance});
    EXPECT_LE(by_tolerance->accuracy().distance.worst, 1.25 * kTolerance);
    const auto uniform = build(boxes.soup(), {.voxel_size = 2e-3});
    // At least what is found on faces; more at edges.
    const auto faces = boxes.find_faces();
    Random random(504);
    double worst = 0.0;
    for (int i = 0; i < 100'000; ++i) {
      const auto& face = faces[random.below(faces.size())];
      worst =
          std::max(worst, std::abs(distance_at(*uniform, random.in_box(face.lower, face.upper))));
    }
    EXPECT_GE(uniform->accuracy().distance.worst, 0.95 * worst);
    EXPECT_LE(uniform->accuracy().distance.worst, uniform->grid().interpolation_error());
  }
}

TEST(OverlappingParts, MeetOthersAsTheFlatLoopHasIt) {
  const auto cube = build(make_box({0.0025, 0.0025, 0.0025}), {.voxel_size = 5e-4});
  for (const BoxUnion& boxes : all_unions()) {
    for (const ModelSettings& settings : all_settings()) {
      const auto model = build(boxes.soup(), settings);
      const Vec3 middle = model->bounds().center();
      Random random(505);
      QueryScratch scratch;
      int hits = 0;
      for (int i = 0; i < 150; ++i) {
        Pose pose = random.pose(0.06);
        pose.translation += middle;
        for (const auto& other : {cube, model}) {
          hits += !find_contacts_flat(model->field(), other->shell(), pose).empty();
          expect_equal_to_flat(model->field(), other->shell(), pose, 0.0f, scratch);
        }
      }
      EXPECT_GT(hits, 30);
    }
  }
}

/// One part, closed: a ball whose vertices are moved at random, by more than its triangles are
/// wide, as in a noisy scan; and a plate, a vertex of whose upper side comes out of the lower one.
std::vector<Soup> all_that_cross_themselves() {
  Random random(506);
  Soup scan = make_icosphere(0.05, 4);
  for (Vec3& vertex : scan.vertices) vertex += random.in_cube(0.0015);
  Soup plate = subdivided(make_box({0.02, 0.015, 0.0025}), 4);
  auto nearest = std::ranges::min_element(plate.vertices, {}, [](const Vec3& v) {
    return squared_length(v - Vec3{0.001, 0.001, 0.0025});
  });
  nearest->z -= 0.006;
  return {scan, plate};
}

TEST(SelfCrossingParts, HaveTheSignsOfTheirWindingNumbers) {
  for (const Soup& soup : all_that_cross_themselves()) {
    const auto model = build(soup, {});
    EXPECT_EQ(model->grid().sign_report().method, SignMethod::kWinding);
    EXPECT_EQ(model->grid().sign_report().confidence, 1.0);
    const TriangleMesh mesh = soup.mesh();
    Random random(507);
    int inside = 0;
    for (int i = 0; i < 20'000; ++i) {
      const auto corners = mesh.corners(random.below(mesh.triangles().size()));
      const Vec3 p = (corners[0] + corners[1] + corners[2]) / 3.0 + random.in_cube(0.001);
      const bool is_inside = winding_number(p, mesh) > 0.5;
      if (std::abs(distance_at(*model, p)) > model->grid().surface_error()) {
        ASSERT_EQ(distance_at(*model, p) < 0.0, is_inside) << p.x << " " << p.y << " " << p.z;
      }
      inside += is_inside ? 1 : 0;
    }
    EXPECT_GT(inside, 1000);
  }
}

TEST(SelfCrossingParts, MeetOthersAsTheFlatLoopHasIt) {
  const auto cube = build(make_box({0.002, 0.002, 0.002}), {});
  for (const Soup& soup : all_that_cross_themselves()) {
    const auto model = build(soup, {});
    Random random(508);
    QueryScratch scratch;
    int hits = 0;
    for (int i = 0; i < 300; ++i) {
      Pose pose = random.pose(0.003);
      pose.translation += soup.vertices[random.below(soup.vertices.size())];
      hits += !find_contacts_flat(model->field(), cube->shell(), pose).empty();
      expect_equal_to_flat(model->field(), cube->shell(), pose, 0.0f, scratch);
    }
    EXPECT_GT(hits, 50);
  }
}

TEST(SelfCrossingParts, AreRefusedAsClosed) {
  for (const Soup& soup : all_that_cross_themselves()) {
    const auto model = Model::build(soup.mesh(), {.sign = SignMethod::kClosed});
    ASSERT_FALSE(model);
    EXPECT_EQ(model.error().code, ErrorCode::kInvalidMesh);
  }
}

TEST(OverlappingParts, SheetsThatAllCrossOneAnotherAreRefused) {
  // Triangles narrower than their sheets are thick: each becomes a column that crosses all others.
  Random random(504);
  Soup triangles;
  for (std::uint32_t i = 0; i < 400; ++i) {
    const Vec3 middle = random.in_cube(0.05);
    for (int k = 0; k < 3; ++k) triangles.vertices.push_back(middle + random.in_cube(0.02));
    triangles.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const auto model = Model::build(triangles.mesh(), {.resolution = 8, .open = OpenMesh::kSheet});
  ASSERT_FALSE(model);
  EXPECT_EQ(model.error().code, ErrorCode::kInvalidMesh);
  EXPECT_NE(model.error().message.find("crosses itself too often"), std::string::npos)
      << model.error().message;
}

TEST(FaultyTriangles, ATurnedOneLeavesNoHole) {
  const Soup box = make_box({0.05, 0.04, 0.03});
  for (const ModelSettings& settings : all_settings()) {
    for (const std::size_t turned : {0u, 5u, 11u}) {
      Soup soup = box;
      std::swap(soup.triangles[turned][1], soup.triangles[turned][2]);
      const auto model = build(soup, settings);
      const auto good = build(box, settings);
      EXPECT_EQ(model->grid().sign_report().method, SignMethod::kClosed);
      EXPECT_EQ(model->grid().sign_report().defects.flipped_edges, 3u);
      EXPECT_EQ(model->grid().data().samples, good->grid().data().samples);
      EXPECT_EQ(model->shell().size(), good->shell().size());
    }
  }
}

TEST(FaultyTriangles, CopiesAreLeftOut) {
  const Soup box = make_box({0.05, 0.04, 0.03});
  Soup doubled = box;
  doubled.triangles.insert(doubled.triangles.end(), box.triangles.begin(), box.triangles.end());
  for (const ModelSettings& settings : all_settings()) {
    const auto model = build(doubled, settings);
    const auto good = build(box, settings);
    EXPECT_EQ(model->mesh().triangles().size(), 12u);
    EXPECT_EQ(model->grid().sign_report().method, SignMethod::kClosed);
    EXPECT_EQ(model->grid().data().samples, good->grid().data().samples);
    EXPECT_EQ(model->shell().element_count(), good->shell().element_count());
  }
}

}  // namespace
}  // namespace voxshell::overlapping_parts_test
