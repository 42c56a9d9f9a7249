#include "mesh/row_winding.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/brute_force.h"
#include "support/meshes.h"
#include "support/random.h"

namespace voxshell::row_winding_test {
namespace {

using namespace test_support;

/// Compares the winding numbers of a lattice with sums of solid angles, except where a point is so
/// near the surface that neither can tell. Returns how many nodes wind as often as `times`.
int count_nodes(const TriangleMesh& mesh, const Vec3& origin, double step, std::size_t size,
                int times) {
  const auto rows =
      RowWinding::build(mesh, {.origin = origin, .step = step, .rows_y = size, .rows_z = size});
  EXPECT_TRUE(rows) << rows.error().message;
  if (!rows) return -1;
  std::vector<double> x(size);
  for (std::size_t i = 0; i < size; ++i) x[i] = origin.x + static_cast<double>(i) * step;
  std::vector<int> winding(size);
  int count = 0;
  for (std::size_t row = 0; row < size * size; ++row) {
    rows->compute(row, x, winding);
    const double y = origin.y + static_cast<double>(row % size) * step;
    const double z = origin.z + static_cast<double>(row / size) * step;
    for (std::size_t i = 0; i < size; ++i) {
      const Vec3 p{x[i], y, z};
      count += winding[i] == times;
      if (distance_to_mesh(p, mesh) < 1e-5 * step) continue;
      const int expected = static_cast<int>(std::lround(winding_number(p, mesh)));
      EXPECT_EQ(winding[i], expected) << p.x << " " << p.y << " " << p.z;
    }
  }
  return count;
}

TEST(RowWinding, AgreesWithSolidAngles) {
  Random random(37);
  for (const Soup& body : {make_corner_tetrahedron(1.5), make_box({0.5, 0.25, 0.75}),
                           make_l_shape(0.5), make_wedge(1.5, 0.3, 0.5), make_spike(0.5, 1.5),
                           make_blob(0.7, 2), make_torus(0.7, 0.25, 24, 12)}) {
    const TriangleMesh mesh = transformed(body, random.pose(0.1)).mesh();
    EXPECT_GT(count_nodes(mesh, {-1.5, -1.5, -1.5}, 0.2, 16, 1), 5);
  }
}

TEST(RowWinding, AgreesOnBodiesAlignedWithTheRows) {
  // Nodes on faces, edges and corners; rows in faces and along edges and through vertices.
  for (const Soup& body : {make_corner_tetrahedron(1.5), make_box({0.5, 0.25, 0.75}),
                           make_l_shape(0.5), make_spike(1.0, 1.5), make_torus(1.0, 0.5, 8, 8)}) {
    EXPECT_GT(count_nodes(body.mesh(), {-1.5, -1.5, -1.5}, 0.25, 13, 1), 5);
  }
  // Rows through the vertices of the sphere's poles and its equators.
  EXPECT_GT(count_nodes(make_icosphere(1.0, 2).mesh(), {-1.5, -1.5, -1.5}, 0.25, 13, 1), 100);
}

TEST(RowWinding, CountsOverlapsTwiceAndInsideOutBodiesBelowZero) {
  const Soup left = make_icosphere(0.7, 2);
  const Soup right = moved(left, {0.5, 0.1, 0});
  EXPECT_GT(count_nodes(together(left, right).mesh(), {-1.5, -1.5, -1.5}, 0.2, 16, 2), 20);
  EXPECT_GT(count_nodes(inverted(left).mesh(), {-1.5, -1.5, -1.5}, 0.2, 16, -1), 20);
}

TEST(RowWinding, IsZeroInACavity) {
  const Soup hollow = together(make_box({1, 1, 1}), inverted(make_box({0.5, 0.5, 0.5})));
  const TriangleMesh mesh = hollow.mesh();
  EXPECT_EQ(count_nodes(mesh, {-1.45, -1.45, -1.45}, 0.3, 10, 1), 7 * 7 * 7 - 3 * 3 * 3);
}

TEST(RowWinding, IsZeroWhereNoRowMeetsTheMesh) {
  EXPECT_EQ(count_nodes(make_box({0.1, 0.1, 0.1}).mesh(), {5, 5, 5}, 1.0, 4, 1), 0);
}

TEST(RowWinding, TakesSliversAndFolds) {
  // A box with a needle in its top, beside the edge; with the negative sign folded over that edge.
  for (const double width : {1e-12, 0.0, -1e-12, -1e-3}) {
    Soup soup = make_box({0.5, 0.5, 0.5});
    const auto [a, b, c] = soup.triangles[1];
    ASSERT_EQ(soup.vertices[a].z, 0.5);
    const auto m = static_cast<std::uint32_t>(soup.vertices.size());
    soup.vertices.push_back(soup.vertices[a] + Vec3{0.4, width, 0});
    soup.triangles[1] = {a, m, c};
    soup.triangles.push_back({m, b, c});
    soup.triangles.push_back({a, b, m});
    const TriangleMesh mesh = soup.mesh();
    ASSERT_TRUE(check_encloses_volume(mesh));
    // Nodes on the surface count as inside on its low sides.
    EXPECT_EQ(count_nodes(mesh, {-0.75, -0.75, -0.75}, 0.25, 7, 1), 4 * 4 * 4) << width;
  }
}

TEST(RowWinding, RefusesAnOpenMesh) {
  Soup soup = make_box({1, 1, 1});
  soup.triangles.erase(soup.triangles.begin() + 4, soup.triangles.begin() + 8);
  const auto rows = RowWinding::build(
      soup.mesh(), {.origin = {-2, -2, -2}, .step = 0.5, .rows_y = 9, .rows_z = 9});
  ASSERT_FALSE(rows);
  EXPECT_EQ(rows.error().code, ErrorCode::kInvalidMesh);
  EXPECT_NE(rows.error().message.find("not closed"), std::string::npos) << rows.error().message;
}

}  // namespace
}  // namespace voxshell::row_winding_test
