#include "mesh/surface_cutter.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "support/brute_force.h"
#include "support/meshes.h"
#include "support/overlapping_boxes.h"
#include "support/random.h"

namespace voxshell::surface_cutter_test {
namespace {

using namespace test_support;

constexpr double kFinest = 1e-3;

double area_of(const std::array<Vec3, 3>& t) {
  return 0.5 * length(cross(t[1] - t[0], t[2] - t[0]));
}

/// All that is visible of a mesh.
std::vector<std::array<Vec3, 3>> cut_all(const TriangleMesh& mesh) {
  const SurfaceCutter cutter(mesh, true);
  CutBudget budget(mesh.triangles().size());
  std::vector<std::array<Vec3, 3>> visible;
  for (std::uint32_t i = 0; i < mesh.triangles().size(); ++i) {
    bool is_hidden = false;
    const auto pieces = cutter.cut(i, kFinest, budget, is_hidden);
    visible.insert(visible.end(), pieces.begin(), pieces.end());
    if (pieces.empty() && !is_hidden) visible.push_back(mesh.corners(i));
  }
  EXPECT_FALSE(budget.is_spent());
  return visible;
}

TEST(SurfaceCutter, LeavesWhatBoundsTheUnionOfBoxes) {
  for (const BoxUnion& boxes :
       {make_two_boxes(), make_pierced_box(), make_touching_boxes(), make_shallow_boxes()}) {
    const auto faces = boxes.find_faces();
    double area = 0.0;
    for (const auto& piece : cut_all(boxes.soup().mesh())) {
      area += area_of(piece);
      const Vec3 middle = (piece[0] + piece[1] + piece[2]) / 3.0;
      EXPECT_NEAR(boxes.distance(faces, middle), 0.0, 1e-6);
    }
    EXPECT_NEAR(area / BoxUnion::area(faces), 1.0, 1e-4);
  }
}

TEST(SurfaceCutter, ManyBoxesInOneAnotherLeaveTheirUnion) {
  Random random(502);
  BoxUnion boxes;
  for (int i = 0; i < 30; ++i) {
    const Vec3 middle = random.in_cube(0.05);
    const Vec3 half = random.in_box({0.01, 0.01, 0.01}, {0.03, 0.03, 0.03});
    boxes.boxes.push_back({middle - half, middle + half});
  }
  double area = 0.0;
  for (const auto& piece : cut_all(boxes.soup().mesh())) area += area_of(piece);
  EXPECT_NEAR(area / BoxUnion::area(boxes.find_faces()), 1.0, 1e-4);
}

TEST(SurfaceCutter, SidesAndCornersThatCoincideAreCutAsOthers) {
  for (const std::uint64_t seed : {1u, 12u, 39u}) {
    Random random(seed);
    const auto round = [](const Vec3& v) {
      return Vec3{0.005 * std::round(200.0 * v.x), 0.005 * std::round(200.0 * v.y),
                  0.005 * std::round(200.0 * v.z)};
    };
    BoxUnion boxes;
    for (int i = 0; i < 30; ++i) {
      const Vec3 middle = round(random.in_cube(0.05));
      const Vec3 half = round(random.in_box({0.01, 0.01, 0.01}, {0.03, 0.03, 0.03}));
      boxes.boxes.push_back({round(middle - half), round(middle + half)});
    }
    const auto faces = boxes.find_faces();
    double area = 0.0;
    for (const auto& piece : cut_all(boxes.soup().mesh())) {
      area += area_of(piece);
      EXPECT_NEAR(boxes.distance(faces, (piece[0] + piece[1] + piece[2]) / 3.0), 0.0, 1e-6);
    }
    EXPECT_NEAR(area / BoxUnion::area(faces), 1.0, 1e-4);
  }
}

TEST(SurfaceCutter, ManyBarsTurnedAboutOneAxisLeaveAStar) {
  // Square bars: each side is crossed along its whole length, near its edges by all others.
  constexpr int kBars = 20;
  constexpr double kStep = 0.5 * std::numbers::pi / kBars;
  Soup bars;
  for (int i = 0; i < kBars; ++i) {
    const double c = std::cos(i * kStep);
    const double s = std::sin(i * kStep);
    const Matrix3 turn{{c, s, 0.0}, {-s, c, 0.0}, {0.0, 0.0, 1.0}};
    bars = together(bars, transformed(make_box({1.0, 1.0, 20.0}), Pose{turn, {}}));
  }
  double area = 0.0;
  for (const auto& piece : cut_all(bars.mesh())) {
    const Vec3 normal = cross(piece[1] - piece[0], piece[2] - piece[0]);
    if (std::abs(normal.z) < 0.5 * length(normal)) area += area_of(piece);
  }
  // Of each side, what lies beyond the last bar that crosses it, at both ends.
  const double tip = 1.0 - std::tan(0.25 * std::numbers::pi - 0.5 * kStep);
  EXPECT_NEAR(area / (4 * kBars * 2.0 * tip * 40.0), 1.0, 1e-4);
}

TEST(SurfaceCutter, StopsWhereItsBudgetIsSpent) {
  const TriangleMesh mesh = make_pierced_box().soup().mesh();
  const SurfaceCutter cutter(mesh, true);
  CutBudget budget(0);
  budget.take(budget.steps() + 1);
  EXPECT_TRUE(budget.is_spent());
  for (std::uint32_t i = 0; i < mesh.triangles().size(); ++i) {
    bool is_hidden = false;
    EXPECT_TRUE(cutter.cut(i, kFinest, budget, is_hidden).empty());
  }
}

TEST(SurfaceCutter, AFineMeshIsCutOutOfALargeTriangle) {
  // A ball amid the side of a box: half of it, and the side less a disk.
  const Soup ball = make_icosphere(0.3, 4);
  const Soup both = together(make_box({0.5, 0.6, 0.7}), moved(ball, {0.5, 0.02, 0.03}));
  double flat = 0.0;
  double round = 0.0;
  for (const auto& piece : cut_all(both.mesh())) {
    const bool is_flat = piece[0].x <= 0.5 && piece[1].x <= 0.5 && piece[2].x <= 0.5;
    (is_flat ? flat : round) += area_of(piece);
  }
  constexpr double kPi = 3.14159265;
  const double sides = 8.0 * (0.5 * 0.6 + 0.6 * 0.7 + 0.7 * 0.5);
  EXPECT_NEAR(flat, sides - kPi * 0.09, 0.01 * kPi * 0.09);
  EXPECT_NEAR(round, 2.0 * kPi * 0.09, 0.01 * kPi * 0.09);
}

TEST(SurfaceCutter, LinesEndWhereTheyEnterOtherParts) {
  const TriangleMesh mesh = make_pierced_box().soup().mesh();
  const SurfaceCutter cutter(mesh, true);
  // An edge of the rod.
  const Vec3 from{-0.14, 0.017, 0.01};
  const Vec3 to{0.16, 0.017, 0.01};
  const auto parts = cutter.cut_line(from, to, normalized(Vec3{0.0, 1.0, 1.0}));
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_NEAR(parts[0][0], 0.0, 1e-9);
  EXPECT_NEAR(parts[0][1], 0.3, 1e-9);
  EXPECT_NEAR(parts[1][0], 190.0 / 300.0, 1e-9);
  EXPECT_NEAR(parts[1][1], 1.0, 1e-9);
}

TEST(SurfaceCutter, CavitiesAreNoneOfItsBusiness) {
  const Soup cavity = together(make_box({0.5, 0.5, 0.5}), inverted(make_box({0.2, 0.2, 0.2})));
  const TriangleMesh mesh = cavity.mesh();
  EXPECT_EQ(find_near_parts(mesh).size(), 12u);
  EXPECT_FALSE(SurfaceCutter(mesh, true).hides_any(find_near_parts(mesh), 1));
  EXPECT_EQ(cut_all(mesh).size(), 24u);
  EXPECT_TRUE(find_near_parts(make_blob(0.5, 3).mesh()).empty());
}

TEST(SurfaceCutter, TellsShallowOverlapsAndSidesThatTouch) {
  for (const BoxUnion& boxes : {make_touching_boxes(), make_shallow_boxes()}) {
    const TriangleMesh mesh = boxes.soup().mesh();
    EXPECT_TRUE(SurfaceCutter(mesh, true).hides_any(find_near_parts(mesh), 1));
  }
}

}  // namespace
}  // namespace voxshell::surface_cutter_test
