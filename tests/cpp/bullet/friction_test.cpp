#include <cmath>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/world.h"

namespace voxshell::bullet::friction_test {
namespace {

using namespace test_support;

enum class Ground { kPlane, kBox, kModel };

class Slope : public testing::TestWithParam<Ground> {};

INSTANTIATE_TEST_SUITE_P(Grounds, Slope,
                         testing::Values(Ground::kPlane, Ground::kBox, Ground::kModel));

/// How far a cube slides within a second where gravity leans by `tangent`, friction 0.5.
double slide(Ground ground, double tangent) {
  const double angle = std::atan(tangent);
  TestWorld world({}, {9.81 * std::sin(angle), 0, -9.81 * std::cos(angle)});
  btCollisionShape* shape = nullptr;
  double drop = 0.0;
  static const auto long_slab =
      build_model(voxshell::test_support::make_box({0.8, 0.2, 0.05}), 0.02);
  switch (ground) {
    case Ground::kPlane:
      shape = &world.make<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0));
      break;
    case Ground::kBox:
      shape = &world.make<btBoxShape>(to_bullet(Vec3{2, 2, 0.05}));
      drop = 0.05;
      break;
    case Ground::kModel:
      shape = &world.make<ModelShape>(long_slab);
      drop = 0.05;
      break;
  }
  world.add(*shape, 0, {{}, {0, 0, -drop}}).setFriction(1);
  static const auto tile = build_model(voxshell::test_support::make_box({0.1, 0.1, 0.02}), 0.01);
  btRigidBody& body = world.add_model(tile, 1, {{}, {-0.4, 0, 0.02}});
  body.setFriction(scalar(0.5));
  body.setActivationState(DISABLE_DEACTIVATION);
  world.step(200);
  return static_cast<double>(body.getWorldTransform().getOrigin().x()) + 0.4;
}

TEST_P(Slope, ATileSticksBelowTheCoulombAngle) { EXPECT_LT(slide(GetParam(), 0.5 * 0.95), 0.002); }

TEST_P(Slope, ATileSlidesAboveTheCoulombAngle) {
  for (const double excess : {1.05, 1.3}) {
    const double angle = std::atan(0.5 * excess);
    const double expected = 0.5 * 9.81 * (std::sin(angle) - 0.5 * std::cos(angle));
    constexpr double kFraction = kIsDouble ? 0.15 : 0.2;
    EXPECT_NEAR(slide(GetParam(), 0.5 * excess), expected, kFraction * expected);
  }
}

}  // namespace
}  // namespace voxshell::bullet::friction_test
