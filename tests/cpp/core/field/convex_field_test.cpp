#include "voxshell/convex_field.h"

#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "support/random.h"
#include "voxshell/box_field.h"

namespace voxshell::convex_field_test {
namespace {

using namespace test_support;

void expect_error(const Soup& soup, ErrorCode code, const std::string& reason) {
  const auto field = ConvexField::create(soup.mesh());
  ASSERT_FALSE(field) << "accepted, but expected: " << reason;
  EXPECT_EQ(field.error().code, code);
  EXPECT_NE(field.error().message.find(reason), std::string::npos) << field.error().message;
}

ConvexField create(const Soup& soup) {
  auto field = ConvexField::create(soup.mesh());
  EXPECT_TRUE(field) << field.error().message;
  if (!field) std::abort();
  return *std::move(field);
}

/// Four triangles for each.
Soup refined(const Soup& soup) {
  Soup finer;
  for (const auto& [a, b, c] : soup.triangles) {
    const auto first = static_cast<std::uint32_t>(finer.vertices.size());
    const Vec3 p = soup.vertices[a];
    const Vec3 q = soup.vertices[b];
    const Vec3 r = soup.vertices[c];
    for (const Vec3& v : {p, q, r, 0.5 * (p + q), 0.5 * (q + r), 0.5 * (r + p)}) {
      finer.vertices.push_back(v);
    }
    for (const auto& [i, j, k] : {Triangle{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}) {
      finer.triangles.push_back({first + i, first + j, first + k});
    }
  }
  return finer;
}

TEST(ConvexField, IsABoxWhereItsNearestPointIsOnAFace) {
  const Vec3 half{0.3, 0.1, 0.7};
  const ConvexField convex = create(make_box(half));
  const BoxField box{half};
  Random random(31);
  int on_a_face = 0;
  int beyond_edges = 0;
  for (int i = 0; i < 20'000; ++i) {
    const Vec3 p = random.in_cube(1.0);
    const auto pf = static_cast<Vec3f>(p);
    const int outside =
        (std::abs(p.x) > half.x) + (std::abs(p.y) > half.y) + (std::abs(p.z) > half.z);
    if (outside <= 1) {
      EXPECT_NEAR(convex.distance(pf), box.distance(pf), 2e-7f);
      ++on_a_face;
    } else {
      EXPECT_LE(convex.distance(pf), box.distance(pf) + 2e-7f);
      EXPECT_GT(convex.distance(pf), 0.0f);
      ++beyond_edges;
    }
  }
  EXPECT_GT(on_a_face, 1'000);
  EXPECT_GT(beyond_edges, 1'000);
}

TEST(ConvexField, HasNegativeDistancesInsideAndPositiveOnesOutside) {
  // A ball of flat facets: between its inscribed and its circumscribed sphere it may be either.
  const ConvexField ball = create(make_icosphere(1.0, 2));
  EXPECT_EQ(ball.face_count(), 320u);
  Random random(32);
  const double inscribed = -static_cast<double>(ball.distance({0, 0, 0}));
  EXPECT_GT(inscribed, 0.97);
  for (int i = 0; i < 2'000; ++i) {
    const Vec3 direction = random.direction();
    EXPECT_LT(ball.distance(static_cast<Vec3f>(0.999 * inscribed * direction)), 0.0f);
    EXPECT_GT(ball.distance(static_cast<Vec3f>(1.001 * direction)), 0.0f);
  }
}

TEST(ConvexField, IsNearerToTheTruthBeyondEdgesByTangentsAndTheSameInside) {
  const Vec3 half{0.3, 0.1, 0.7};
  const Vec3 tangents[] = {normalized(Vec3{1, 1, 0}), normalized(Vec3{1, 1, 1})};
  const auto mesh = make_box(half).mesh();
  const ConvexField plain = *ConvexField::create(mesh);
  const ConvexField touched = *ConvexField::create(mesh, tangents);
  const auto at = [](const ConvexField& field, const Vec3& p) {
    return field.distance(static_cast<Vec3f>(p));
  };
  for (const Vec3& tangent : tangents) {
    const Vec3 beyond = half + 0.2 * tangent;
    EXPECT_LT(at(plain, beyond), 0.15f);
    EXPECT_NEAR(at(touched, tangent.z == 0.0 ? Vec3{beyond.x, beyond.y, 0.2} : beyond), 0.2, 1e-6);
  }
  Random random(32);
  for (int i = 0; i < 5000; ++i) {
    const Vec3 p = random.in_cube(1.0);
    const float distance = at(plain, p);
    if (distance < 0.0f) {
      EXPECT_EQ(at(touched, p), distance);
    }
    EXPECT_GE(at(touched, p), distance);
    EXPECT_LE(at(touched, p), BoxField{half}.distance(static_cast<Vec3f>(p)) + 1e-6f);
  }
}

TEST(ConvexField, MergesTrianglesOfOneFace) {
  Random random(33);
  for (int i = 0; i < 10; ++i) {
    const Soup soup = transformed(refined(refined(make_box({0.3, 0.1, 0.7}))), random.pose(1.0));
    const ConvexField field = create(soup);
    EXPECT_EQ(field.face_count(), 6u);
    // No vertex stands out of it.
    for (const Vec3& v : soup.vertices) EXPECT_LE(field.distance(static_cast<Vec3f>(v)), 4e-7f);
  }
  EXPECT_EQ(create(make_corner_tetrahedron(2.0)).face_count(), 4u);
}

TEST(ConvexField, TakesMeshesRoundedToSinglePrecision) {
  Random random(34);
  for (int i = 0; i < 10; ++i) {
    Soup soup = transformed(refined(make_box({0.3, 0.1, 0.7})), {random.rotation(), {}});
    for (Vec3& v : soup.vertices) v = static_cast<Vec3>(static_cast<Vec3f>(v));
    EXPECT_EQ(create(soup).face_count(), 6u);
  }
}

TEST(ConvexField, GradientIsTheNormalOfTheDecidingFace) {
  const ConvexField box = create(make_box({1, 2, 3}));
  EXPECT_EQ(box.gradient({0.9f, 0, 0}), (Vec3f{1, 0, 0}));
  EXPECT_EQ(box.gradient({0, -5, 0}), (Vec3f{0, -1, 0}));
  EXPECT_EQ(box.gradient({2, 2, -9}), (Vec3f{0, 0, -1}));
  EXPECT_EQ(box.reach(), std::sqrt(14.0));
}

TEST(ConvexField, RefusesWhatIsNotConvexAndSaysByHowMuch) {
  expect_error(make_l_shape(0.3), ErrorCode::kInvalidMesh, "not convex: vertex [");
  expect_error(make_l_shape(0.3), ErrorCode::kInvalidMesh, "stands 0.3 m out of the plane");
  expect_error(make_torus(0.4, 0.1, 20, 10), ErrorCode::kInvalidMesh, "not convex");
  expect_error(together(make_box({1, 1, 1}), moved(make_box({1, 1, 1}), {5, 0, 0})),
               ErrorCode::kInvalidMesh, "stands 5 m out of the plane");
  expect_error(together(make_box({1, 1, 1}), make_box({0.5, 0.5, 0.5})), ErrorCode::kInvalidMesh,
               "stands 0.5 m out of the plane");
  // A dent of a tenth of a millimeter in a body of a meter.
  Soup dented = refined(make_box({0.5, 0.5, 0.5}));
  for (Vec3& v : dented.vertices) {
    if (v == Vec3{0, 0, 0.5}) v.z -= 1e-4;
  }
  expect_error(dented, ErrorCode::kInvalidMesh, "not convex");
}

TEST(ConvexField, RefusesOpenInvertedAndFlatMeshes) {
  Soup open = make_box({1, 1, 1});
  open.triangles.pop_back();
  expect_error(open, ErrorCode::kInvalidMesh, "not watertight: 3 open");
  expect_error(inverted(make_box({1, 1, 1})), ErrorCode::kInvalidMesh, "inside out");
  expect_error(make_box({1, 1, 1e-6}), ErrorCode::kInvalidMesh, "too flat");
}

TEST(ConvexField, RefusesMoreFacesThanItsLimit) {
  EXPECT_EQ(create(make_icosphere(1.0, 3)).face_count(), 1280u);
  expect_error(make_icosphere(1.0, 4), ErrorCode::kTooLarge, "more than 4096 faces");
}

}  // namespace
}  // namespace voxshell::convex_field_test
