#include "voxshell/triangle_mesh.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "support/random.h"

namespace voxshell::triangle_mesh_test {
namespace {

using namespace test_support;

void expect_invalid(const Result<TriangleMesh>& mesh, const std::string& reason) {
  ASSERT_FALSE(mesh) << "accepted, but expected: " << reason;
  EXPECT_EQ(mesh.error().code, ErrorCode::kInvalidMesh);
  EXPECT_NE(mesh.error().message.find(reason), std::string::npos) << mesh.error().message;
}

void expect_encloses_nothing(const TriangleMesh& mesh, const std::string& reason) {
  const auto checked = check_encloses_volume(mesh);
  ASSERT_FALSE(checked) << "accepted, but expected: " << reason;
  EXPECT_EQ(checked.error().code, ErrorCode::kInvalidMesh);
  EXPECT_NE(checked.error().message.find(reason), std::string::npos) << checked.error().message;
}

Result<TriangleMesh> create(const Soup& soup) {
  return TriangleMesh::create(soup.vertices, soup.triangles);
}

/// Each triangle with corners of its own, as in an STL file.
Soup unwelded(const Soup& soup) {
  Soup apart;
  for (const Triangle& t : soup.triangles) {
    const auto first = static_cast<std::uint32_t>(apart.vertices.size());
    for (const std::uint32_t corner : t) apart.vertices.push_back(soup.vertices[corner]);
    apart.triangles.push_back({first, first + 1, first + 2});
  }
  return apart;
}

TEST(TriangleMesh, GeneratorsOfTheseTestsMakeClosedBodies) {
  for (const Soup& soup :
       {make_corner_tetrahedron(1), make_box({1, 2, 3}), make_l_shape(1), make_wedge(5, 0.1, 1),
        make_spike(1, 10), make_icosphere(1, 2), make_blob(1, 3), make_torus(2, 0.5, 24, 12)}) {
    const TriangleMesh mesh = soup.mesh();
    EXPECT_TRUE(mesh.compute_defects().is_closed());
    EXPECT_TRUE(check_encloses_volume(mesh));
    EXPECT_EQ(mesh.triangles().size(), soup.triangles.size());
    EXPECT_EQ(mesh.vertices().size(), soup.vertices.size());
  }
}

TEST(TriangleMesh, AreaAndVolumeMatchClosedForms) {
  const TriangleMesh box = make_box({0.5, 1.0, 1.5}).mesh();
  EXPECT_NEAR(box.compute_area(), 22.0, 1e-13);
  EXPECT_NEAR(box.compute_volume(), 6.0, 1e-13);

  const TriangleMesh tetrahedron = make_corner_tetrahedron(2.0).mesh();
  EXPECT_NEAR(tetrahedron.compute_area(), 6.0 + 2.0 * std::sqrt(3.0), 1e-13);
  EXPECT_NEAR(tetrahedron.compute_volume(), 8.0 / 6.0, 1e-13);

  const TriangleMesh l_shape = make_l_shape(0.1).mesh();
  EXPECT_NEAR(l_shape.compute_area(), 0.14, 1e-15);
  EXPECT_NEAR(l_shape.compute_volume(), 0.003, 1e-16);

  const double pi = std::numbers::pi;
  const TriangleMesh sphere = make_icosphere(1.0, 5).mesh();
  EXPECT_NEAR(sphere.compute_area(), 4.0 * pi, 0.01);
  EXPECT_LT(sphere.compute_area(), 4.0 * pi);
  EXPECT_NEAR(sphere.compute_volume(), 4.0 * pi / 3.0, 0.01);

  const TriangleMesh torus = make_torus(2.0, 0.5, 200, 100).mesh();
  EXPECT_NEAR(torus.compute_area(), 4.0 * pi * pi, 0.02);
  EXPECT_NEAR(torus.compute_volume(), pi * pi, 0.02);
}

TEST(TriangleMesh, VolumeDoesNotDependOnThePlace) {
  // Coordinates keep 1e-11 m here; tetrahedra to the origin would lose all but three digits.
  const Soup soup = transformed(make_box({0.05, 0.05, 0.05}), Pose{Random(9).rotation(), {}});
  const TriangleMesh mesh = moved(soup, {1.2e5, -2.3e5, 3.4e5}).mesh();
  EXPECT_NEAR(mesh.compute_volume(), 0.001, 1e-11);
}

TEST(TriangleMesh, VerticesAtOnePlaceAreMerged) {
  const Soup soup = make_l_shape(0.1);
  const TriangleMesh mesh = unwelded(soup).mesh();
  EXPECT_EQ(mesh.vertices().size(), soup.vertices.size());
  EXPECT_EQ(mesh.triangles().size(), soup.triangles.size());
  EXPECT_TRUE(mesh.compute_defects().is_closed());
  EXPECT_NEAR(mesh.compute_volume(), 0.003, 1e-16);
}

TEST(TriangleMesh, VerticesAFractionApartAreNotMerged) {
  Soup soup = unwelded(make_box({1, 1, 1}));
  soup.vertices[0].x = std::nextafter(soup.vertices[0].x, 2.0);
  const MeshDefects defects = soup.mesh().compute_defects();
  EXPECT_FALSE(defects.is_closed());
  EXPECT_EQ(defects.open_edges, 4u);  // two sides of the one triangle and what they met
}

TEST(TriangleMesh, NegativeZeroIsZero) {
  Soup soup = unwelded(make_corner_tetrahedron(1.0));
  bool flip = false;
  for (Vec3& v : soup.vertices) {
    for (int axis = 0; axis < 3; ++axis) {
      if (v[axis] == 0.0 && (flip = !flip)) v[axis] = -0.0;
    }
  }
  const TriangleMesh mesh = soup.mesh();
  EXPECT_EQ(mesh.vertices().size(), 4u);
  EXPECT_TRUE(mesh.compute_defects().is_closed());
  for (const Vec3& v : mesh.vertices()) {
    for (int axis = 0; axis < 3; ++axis) EXPECT_FALSE(std::signbit(v[axis]));
  }
}

TEST(TriangleMesh, VerticesThatNoTriangleUsesAreDropped) {
  Soup soup = make_box({1, 1, 1});
  soup.vertices.insert(soup.vertices.begin(), {100, 100, 100});
  for (Triangle& t : soup.triangles) t = {t[0] + 1, t[1] + 1, t[2] + 1};
  soup.vertices.push_back({-50, 0, 0});
  const TriangleMesh mesh = soup.mesh();
  EXPECT_EQ(mesh.vertices().size(), 8u);
  EXPECT_EQ(mesh.bounds().lower, (Vec3{-1, -1, -1}));
  EXPECT_EQ(mesh.bounds().upper, (Vec3{1, 1, 1}));
}

TEST(TriangleMesh, VerticesOfDroppedTrianglesCountNeitherAsVerticesNorInTheBounds) {
  Soup soup = make_box({1, 1, 1});
  soup.vertices.push_back({100, 0, 0});
  soup.triangles.insert(soup.triangles.begin(), {8, 8, 0});
  soup.triangles.push_back({3, 8, 8});
  const TriangleMesh mesh = soup.mesh();
  EXPECT_EQ(mesh.triangles().size(), 12u);
  EXPECT_EQ(mesh.vertices().size(), 8u);
  EXPECT_EQ(mesh.bounds().upper, (Vec3{1, 1, 1}));
  EXPECT_TRUE(check_encloses_volume(mesh));
}

TEST(TriangleMesh, TrianglesThatLoseACornerByMergingAreDropped) {
  // A cap edge of zero length: its two side triangles degenerate, and what is left is closed.
  Soup soup = make_prism({{0, 0}, {1, 0}, {1, 0}, {0, 1}}, {{0, 1, 2}, {0, 2, 3}}, 0, 1);
  EXPECT_EQ(soup.triangles.size(), 12u);
  const TriangleMesh mesh = soup.mesh();
  EXPECT_EQ(mesh.triangles().size(), 8u);
  EXPECT_EQ(mesh.vertices().size(), 6u);
  EXPECT_TRUE(check_encloses_volume(mesh));
  EXPECT_NEAR(mesh.compute_volume(), 0.5, 1e-15);
}

TEST(TriangleMesh, TrianglesWithoutAreaButThreeCornersStayForTheSakeOfClosedness) {
  // The box's bottom edge from 0 to 1 gets a vertex in its middle on one side only.
  Soup soup = make_box({1, 1, 1});
  soup.vertices.push_back({0, -1, -1});
  soup.triangles[0] = {0, 2, 8};  // was {0, 2, 1}
  soup.triangles.push_back({8, 2, 1});
  soup.triangles.push_back({0, 8, 1});
  const TriangleMesh mesh = soup.mesh();
  EXPECT_EQ(mesh.triangles().size(), 14u);
  EXPECT_TRUE(check_encloses_volume(mesh));
}

TEST(TriangleMesh, BoundsHoldExactlyTheVertices) {
  const TriangleMesh mesh = moved(make_box({1, 2, 3}), {10, 20, 30}).mesh();
  EXPECT_EQ(mesh.bounds().lower, (Vec3{9, 18, 27}));
  EXPECT_EQ(mesh.bounds().upper, (Vec3{11, 22, 33}));
}

TEST(TriangleMesh, RefusesAnEmptyMesh) {
  expect_invalid(TriangleMesh::create({}, {}), "no triangles");
  const Soup soup = make_box({1, 1, 1});
  expect_invalid(TriangleMesh::create(soup.vertices, {}), "no triangles");
}

TEST(TriangleMesh, RefusesAnIndexOutOfRange) {
  Soup soup = make_box({1, 1, 1});
  soup.triangles[5][1] = 8;
  expect_invalid(create(soup),
                 "triangle 5 of the mesh uses vertex 8, but there are 8, counted from 0; remove");
  soup.triangles[5][1] = 0xFFFFFFFFu;
  expect_invalid(create(soup), "vertex 4294967295");
  expect_invalid(TriangleMesh::create({}, soup.triangles), "but there are 0");
}

TEST(TriangleMesh, RefusesCoordinatesThatAreNotFinite) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
        -std::numeric_limits<double>::infinity()}) {
    for (int axis = 0; axis < 3; ++axis) {
      Soup soup = make_box({1, 1, 1});
      soup.vertices[6][axis] = bad;
      const std::string where = "not finite (first: vertex 6); remove them";
      expect_invalid(create(soup), "1 of 8 vertices of the mesh are " + where);
      soup.vertices[7][axis] = bad;
      expect_invalid(create(soup), "2 of 8 vertices of the mesh are " + where);
    }
  }
}

TEST(TriangleMesh, RefusesAMeshWithoutArea) {
  expect_invalid(create({{{1, 1, 1}, {2, 2, 2}, {3, 3, 3}}, {{0, 1, 2}}}), "area above zero");
  expect_invalid(create({{{1, 1, 1}, {2, 2, 2}}, {{0, 1, 1}, {0, 0, 0}}}),
                 "area above zero, of 2; export it again");
}

TEST(TriangleMesh, RefusesSizesThatFloat32ArithmeticCannotHold) {
  expect_invalid(create(make_box({1e-10, 1e-10, 1e-10})), "too small: its longest side is 2e-10 m");
  expect_invalid(create(make_box({1e-80, 1e-80, 1e-80})), "check its unit");
  expect_invalid(create(make_box({2e9, 1, 1})), "too large: it reaches 2e+09 m");
  expect_invalid(create(moved(make_box({1, 1, 1}), {0, -3e9, 0})), "too large: it reaches 3e+09 m");
  expect_invalid(create(make_box({1e200, 1e200, 1e200})), "too large");
  expect_invalid(create(make_box({1e308, 1, 1})), "too large");
  EXPECT_TRUE(create(make_box({1e-9, 1e-9, 1e-9})));
  EXPECT_TRUE(create(make_box({0.9e9, 1, 1})));
}

TEST(TriangleMesh, CountsAndLocatesOpenEdges) {
  Soup soup = make_box({1, 1, 1});
  soup.triangles.erase(soup.triangles.begin());  // {0, 2, 1}: half of the bottom
  const MeshDefects defects = soup.mesh().compute_defects();
  EXPECT_EQ(defects.open_edges, 3u);
  EXPECT_EQ(defects.non_manifold_edges, 0u);
  EXPECT_EQ(defects.flipped_edges, 0u);
  EXPECT_FALSE(defects.is_closed());
  const Vec3& at = defects.first_location;
  EXPECT_TRUE(at == (Vec3{0, -1, -1}) || at == (Vec3{1, 0, -1}) || at == (Vec3{0, 0, -1}))
      << at.x << " " << at.y << " " << at.z;
  expect_encloses_nothing(soup.mesh(), "not watertight: 3 open, 0 non-manifold and 0 wrongly");
  expect_encloses_nothing(soup.mesh(), "-1] meters");
}

TEST(TriangleMesh, CountsFlippedEdges) {
  Soup soup = make_box({1, 1, 1});
  std::swap(soup.triangles[3][0], soup.triangles[3][1]);
  const MeshDefects defects = soup.mesh().compute_defects();
  EXPECT_EQ(defects.open_edges, 0u);
  EXPECT_EQ(defects.non_manifold_edges, 0u);
  EXPECT_EQ(defects.flipped_edges, 3u);
  expect_encloses_nothing(soup.mesh(), "3 wrongly oriented");
}

TEST(TriangleMesh, CountsNonManifoldEdges) {
  // Two boxes that share one edge of four triangles.
  const Soup soup = together(make_box({1, 1, 1}), moved(make_box({1, 1, 1}), {2, 2, 0}));
  const MeshDefects defects = soup.mesh().compute_defects();
  EXPECT_EQ(defects.open_edges, 0u);
  EXPECT_EQ(defects.non_manifold_edges, 1u);
  EXPECT_EQ(defects.flipped_edges, 0u);
  EXPECT_EQ(defects.first_location, (Vec3{1, 1, 0}));
  expect_encloses_nothing(soup.mesh(), "1 non-manifold");
}

TEST(TriangleMesh, AFinOfThreeTrianglesAtOneEdgeIsNonManifold) {
  Soup soup = make_box({1, 1, 1});
  soup.vertices.push_back({5, 0, 0});
  soup.triangles.push_back({0, 1, 8});
  const MeshDefects defects = soup.mesh().compute_defects();
  EXPECT_EQ(defects.open_edges, 2u);
  EXPECT_EQ(defects.non_manifold_edges, 1u);
}

TEST(TriangleMesh, ATriangleGivenTwiceIsFound) {
  Soup soup = make_box({1, 1, 1});
  soup.triangles.push_back(soup.triangles[4]);
  const MeshDefects defects = soup.mesh().compute_defects();
  EXPECT_EQ(defects.non_manifold_edges, 3u);
  expect_encloses_nothing(soup.mesh(), "3 non-manifold");
}

TEST(TriangleMesh, DefectsOfATangleAreThoseOfEachOfItsEdges) {
  Random random(58);
  Soup soup;
  for (int i = 0; i < 40; ++i) soup.vertices.push_back(random.in_box({-1, -1, -1}, {1, 1, 1}));
  while (soup.triangles.size() < 300) {
    const auto vertex = [&] { return static_cast<std::uint32_t>(random.below(40)); };
    soup.triangles.push_back({vertex(), vertex(), vertex()});
  }
  const TriangleMesh mesh = soup.mesh();
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<bool>> edges;
  for (const Triangle& t : mesh.triangles()) {
    for (std::size_t side = 0; side < 3; ++side) {
      const auto [low, high] = std::minmax(t[side], t[(side + 1) % 3]);
      edges[{low, high}].push_back(low == t[side]);
    }
  }
  MeshDefects expected;
  for (const auto& [ends, forward] : edges) {
    const bool was_closed = expected.is_closed();
    expected.open_edges += forward.size() == 1;
    expected.non_manifold_edges += forward.size() > 2;
    expected.flipped_edges += forward.size() == 2 && forward[0] == forward[1];
    if (was_closed && !expected.is_closed()) {
      expected.first_location = 0.5 * (mesh.vertices()[ends.first] + mesh.vertices()[ends.second]);
    }
  }
  const MeshDefects defects = mesh.compute_defects();
  EXPECT_GT(expected.open_edges, 10u);
  EXPECT_GT(expected.non_manifold_edges, 10u);
  EXPECT_GT(expected.flipped_edges, 10u);
  EXPECT_EQ(defects.open_edges, expected.open_edges);
  EXPECT_EQ(defects.non_manifold_edges, expected.non_manifold_edges);
  EXPECT_EQ(defects.flipped_edges, expected.flipped_edges);
  EXPECT_EQ(defects.first_location, expected.first_location);
}

TEST(TriangleMesh, RefusesToEncloseInsideOut) {
  expect_encloses_nothing(inverted(make_box({0.5, 0.5, 0.5})).mesh(),
                          "inside out: its volume is -1");
}

TEST(TriangleMesh, RefusesToEncloseAFlatBody) {
  // Both sides of one square.
  const Soup sheet{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                   {{0, 1, 2}, {0, 2, 3}, {0, 2, 1}, {0, 3, 2}}};
  const TriangleMesh flat = sheet.mesh();
  EXPECT_FALSE(check_encloses_volume(flat));

  // The same, made of different triangles on its two sides, so that each edge has two.
  const Soup pillow{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                    {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}};
  EXPECT_TRUE(pillow.mesh().compute_defects().is_closed());
  expect_encloses_nothing(pillow.mesh(), "encloses no volume");

  // Slanted, so that its bounding box is not flat.
  const Soup slanted = transformed(pillow, Pose{Random(6).rotation(), {1, 2, 3}});
  expect_encloses_nothing(slanted.mesh(), "encloses no volume");
  expect_encloses_nothing(inverted(slanted).mesh(), "encloses no volume");
}

TEST(TriangleMesh, TakesThinBodies) {
  EXPECT_TRUE(check_encloses_volume(make_box({1.0, 1.0, 1e-6}).mesh()));
  EXPECT_TRUE(check_encloses_volume(make_wedge(1.0, 1e-6, 0.1).mesh()));
  const Pose turned{Random(7).rotation(), {}};
  EXPECT_TRUE(check_encloses_volume(transformed(make_box({1.0, 1.0, 1e-6}), turned).mesh()));
}

TEST(TriangleMesh, TakesHollowAndSeparateBodies) {
  const Soup hollow = together(make_box({1, 1, 1}), inverted(make_box({0.5, 0.5, 0.5})));
  EXPECT_TRUE(check_encloses_volume(hollow.mesh()));
  EXPECT_NEAR(hollow.mesh().compute_volume(), 7.0, 1e-13);
  const Soup pair = together(make_box({1, 1, 1}), moved(make_box({1, 1, 1}), {5, 0, 0}));
  EXPECT_TRUE(check_encloses_volume(pair.mesh()));
}

TEST(TriangleMesh, AreaAndVolumeAreInvariantUnderRigidMotion) {
  Random random(8);
  const Soup soup = make_blob(0.1, 2);
  const TriangleMesh still = soup.mesh();
  for (int i = 0; i < 50; ++i) {
    const TriangleMesh mesh = transformed(soup, random.pose(1.0)).mesh();
    EXPECT_NEAR(mesh.compute_area(), still.compute_area(), 1e-13);
    EXPECT_NEAR(mesh.compute_volume(), still.compute_volume(), 1e-14);
  }
}

}  // namespace
}  // namespace voxshell::triangle_mesh_test
