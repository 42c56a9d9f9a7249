#include "mesh/repair.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "mesh/t_vertices.h"
#include "support/meshes.h"
#include "support/random.h"

namespace voxshell::repair_test {
namespace {

using namespace test_support;

void turn(Soup& soup, std::size_t triangle) {
  std::swap(soup.triangles[triangle][1], soup.triangles[triangle][2]);
}

std::vector<Triangle> triangles_of(const TriangleMesh& mesh) {
  return {mesh.triangles().begin(), mesh.triangles().end()};
}

TEST(Repair, ATurnedTriangleIsTurnedBack) {
  const Soup box = make_box({0.5, 0.4, 0.3});
  for (std::size_t i = 0; i < box.triangles.size(); ++i) {
    Soup turned = box;
    turn(turned, i);
    const RepairedMesh repaired = repair_mesh(turned.mesh());
    EXPECT_EQ(repaired.found.flipped_edges, 3u);
    EXPECT_TRUE(repaired.is_closed);
    EXPECT_NEAR(repaired.mesh.compute_volume(), 0.48, 1e-12) << i;
  }
}

TEST(Repair, ManyTurnedTrianglesAreTurnedBack) {
  Soup blob = make_blob(0.5, 4);
  const double volume = blob.mesh().compute_volume();
  Random random(501);
  for (int i = 0; i < 1000; ++i) turn(blob, random.below(blob.triangles.size()));
  const RepairedMesh repaired = repair_mesh(blob.mesh());
  EXPECT_GT(repaired.found.flipped_edges, 1000u);
  EXPECT_TRUE(repaired.is_closed);
  EXPECT_NEAR(repaired.mesh.compute_volume(), volume, 1e-12);
}

TEST(Repair, VerticesAmidTheEdgesOfOthersAreNoOpenings) {
  for (const Soup& whole : {make_box({0.5, 0.4, 0.3}), make_blob(0.5, 2)}) {
    Soup soup = whole;
    Random random(502);
    for (int i = 0; i < 40; ++i) {
      // Four for one; the neighbors know nothing of it. Some pieces are cut again.
      const std::size_t chosen = random.below(soup.triangles.size());
      const Triangle t = soup.triangles[chosen];
      const auto first = static_cast<std::uint32_t>(soup.vertices.size());
      for (std::size_t k = 0; k < 3; ++k) {
        const double fraction = random.uniform(0.2, 0.8);
        soup.vertices.push_back((1.0 - fraction) * soup.vertices[t[k]] +
                                fraction * soup.vertices[t[(k + 1) % 3]]);
      }
      soup.triangles[chosen] = {first, first + 1, first + 2};
      soup.triangles.insert(
          soup.triangles.end(),
          {{t[0], first, first + 2}, {t[1], first + 1, first}, {t[2], first + 2, first + 1}});
    }
    const RepairedMesh repaired = repair_mesh(soup.mesh());
    EXPECT_GT(repaired.found.open_edges, 40u);
    EXPECT_TRUE(repaired.is_closed);
    EXPECT_NEAR(repaired.mesh.compute_volume(), whole.mesh().compute_volume(), 1e-9);
    EXPECT_NEAR(repaired.mesh.compute_area(), whole.mesh().compute_area(), 1e-9);
  }
  // True openings stay open, and all that is around them as it was.
  const TriangleMesh bowl = opened(make_icosphere(0.5, 3), 0.2).mesh();
  EXPECT_EQ(triangles_of(repair_mesh(bowl).mesh), triangles_of(bowl));
}

TEST(Repair, TrianglesAlongALineAreNotCutIntoPiecesOfPieces) {
  // Each vertex lies amid most edges, and each piece has an edge amid which others lie.
  Random random(73);
  Soup wire;
  for (int i = 0; i < 60; ++i) {
    wire.vertices.push_back({random.unit(), 1e-9 * random.unit(), 1e-9 * random.unit()});
  }
  for (int i = 0; i < 120; ++i) {
    const auto vertex = [&] { return static_cast<std::uint32_t>(random.below(60)); };
    const Triangle t{vertex(), vertex(), vertex()};
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) wire.triangles.push_back(t);
  }
  const TriangleMesh mesh = wire.mesh();
  EXPECT_EQ(cut_at_t_vertices(mesh).size(), mesh.triangles().size());
}

TEST(Repair, PartsKeepTheirSides) {
  // A cavity, and a body that is inside out as a whole.
  for (const Soup& soup : {together(make_box({0.5, 0.5, 0.5}), inverted(make_box({0.2, 0.2, 0.2}))),
                           inverted(make_blob(0.5, 2))}) {
    const double volume = soup.mesh().compute_volume();
    Soup turned = soup;
    turn(turned, 3);
    turn(turned, soup.triangles.size() - 2);
    const RepairedMesh repaired = repair_mesh(turned.mesh());
    EXPECT_TRUE(repaired.is_closed);
    EXPECT_NEAR(repaired.mesh.compute_volume(), volume, 1e-12);
  }
}

TEST(Repair, WhatIsClosedIsReturnedAsItWas) {
  const TriangleMesh mesh = make_blob(0.5, 3).mesh();
  const RepairedMesh repaired = repair_mesh(mesh);
  EXPECT_EQ(triangles_of(repaired.mesh), triangles_of(mesh));
  EXPECT_TRUE(repaired.is_closed && repaired.is_balanced);
}

TEST(Repair, OfCopiesThatFaceTheSameWayOneIsKept) {
  const Soup box = make_box({0.5, 0.4, 0.3});
  for (const std::size_t copies : {1u, 5u, 12u}) {
    Soup doubled = box;
    for (std::size_t i = 0; i < copies; ++i) {
      const Triangle& t = box.triangles[i];
      doubled.triangles.push_back({t[1], t[2], t[0]});
    }
    const RepairedMesh repaired = repair_mesh(doubled.mesh());
    EXPECT_GT(repaired.found.non_manifold_edges + repaired.found.flipped_edges, 0u);
    EXPECT_EQ(triangles_of(repaired.mesh), triangles_of(box.mesh())) << copies;
  }
}

TEST(Repair, PartsThatShareATriangleKeepIt) {
  // Both have the same bottom.
  const Soup both = together(make_corner_tetrahedron(0.3), [] {
    Soup steep = make_corner_tetrahedron(0.3);
    steep.vertices[3].z = 0.5;
    return steep;
  }());
  const RepairedMesh repaired = repair_mesh(both.mesh());
  EXPECT_EQ(repaired.mesh.triangles().size(), 8u);
  EXPECT_TRUE(repaired.is_balanced);
}

TEST(Repair, FacesWithTwoSidesKeepBoth) {
  const Soup sheet{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.1}}, {{0, 1, 2}, {0, 2, 3}}};
  Soup doubled = sheet;
  for (const Triangle& t : inverted(sheet).triangles) doubled.triangles.push_back(t);
  const RepairedMesh repaired = repair_mesh(doubled.mesh());
  EXPECT_EQ(triangles_of(repaired.mesh), triangles_of(doubled.mesh()));
  EXPECT_TRUE(repaired.is_balanced);
}

TEST(Repair, WhatHasOneSideStaysAsItIs) {
  Soup strip;
  constexpr std::uint32_t kAround = 20;
  for (std::uint32_t i = 0; i < kAround; ++i) {
    const double angle = 6.283185307179586 * i / kAround;
    for (const double side : {-0.2, 0.2}) {
      const double radius = 1.0 + side * std::cos(0.5 * angle);
      strip.vertices.push_back(
          {radius * std::cos(angle), radius * std::sin(angle), side * std::sin(0.5 * angle)});
    }
  }
  for (std::uint32_t i = 0; i < kAround; ++i) {
    const bool is_last = i + 1 == kAround;
    const std::uint32_t low = is_last ? 1 : 2 * i + 2;
    const std::uint32_t high = is_last ? 0 : 2 * i + 3;
    strip.triangles.push_back({2 * i, low, high});
    strip.triangles.push_back({2 * i, high, 2 * i + 1});
  }
  const RepairedMesh repaired = repair_mesh(strip.mesh());
  EXPECT_GT(repaired.found.flipped_edges, 0u);
  EXPECT_EQ(triangles_of(repaired.mesh), triangles_of(strip.mesh()));
}

}  // namespace
}  // namespace voxshell::repair_test
