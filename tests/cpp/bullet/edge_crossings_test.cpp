#include "edge_crossings.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "edge_piece.h"
#include "support/brick.h"
#include "voxshell/contacts.h"

namespace voxshell::bullet::edge_crossings_test {
namespace {

using namespace test_support;

constexpr double kLean = 0.1;  // rad

/// A table whose top is z = 0 for x < 0, as large as it needs to be.
const BoxField kTable{{1.0, 1.0, 1.0}};
const Vec3 kTableCenter{-1.0, 0.0, -1.0};

/// An edge in the plane y = 0 that leans forward, and passes the table's edge at `height`.
EdgePiece leaning_edge(double lean) {
  const Vec3 along{std::cos(lean), 0.0, -std::sin(lean)};
  return {&brick_model()->grid(), {}, along, along, {}, /*tolerance=*/1.0, /*flat=*/kLeaningSine};
}

Crossing cross_table(double lean, double height, double off, double way) {
  const EdgePiece edge = leaning_edge(lean);
  const Vec3 at = Vec3{0.0, 0.0, height} + off * edge.along - kTableCenter;
  return find_crossing(edge, kTable, at, way);
}

TEST(EdgePiece, CrossesTheEdgeWhereTheNormalIsSquareToIt) {
  for (const double height : {1e-5, -1e-4}) {
    const Crossing crossing = cross_table(kLean, height, -1e-4, 1e-3);
    const Vec3 normal = normalized(crossing.outwards);
    EXPECT_NEAR(normal.x, std::sin(kLean), 1e-3) << height;
    EXPECT_NEAR(normal.z, std::cos(kLean), 1e-3) << height;
    // Inside, normals change as deep as it is farther in.
    EXPECT_NEAR(crossing.along, 1e-4 + std::min(height, 0.0), 2e-5) << height;
  }
}

TEST(EdgePiece, CrossesNothingWhereItLiesFlat) {
  EXPECT_EQ(cross_table(0.5 * kLeaningSine, 1e-5, -1e-4, 1e-3).along, 0.0);
}

TEST(EdgePiece, CrossesNothingThatIsFartherThanFourWays) {
  EXPECT_EQ(cross_table(kLean, 1e-5, -1e-2, 1e-3).along, 0.0);
}

// Where the normals of two walls nearly cancel, the depth between them had no bound: bunnies in a
// bin were thrown out of it at 1e12 m/s.
TEST(EdgePiece, CrossesNoThinSheetBetweenItsTwoWalls) {
  const BoxField sheet{{1.0, 1.0, 1e-4}};
  const EdgePiece edge = leaning_edge(0.5 * std::numbers::pi - kLean);
  // It passes through the sheet, and the normal turns over at its middle.
  const Vec3 before_middle = -5e-5 * edge.along;
  EXPECT_EQ(find_crossing(edge, sheet, before_middle, 1e-4).along, 0.0);
}

}  // namespace
}  // namespace voxshell::bullet::edge_crossings_test
