#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "support/brick.h"
#include "support/models.h"
#include "support/world.h"

namespace voxshell::bullet::sliding_test {
namespace {

using namespace test_support;
using voxshell::test_support::make_box;

constexpr double kHalf = 0.05;
constexpr double kSpeed = 0.5;  // m/s
constexpr double kRates[] = {1000.0, 200.0, 60.0};

struct Cubes {
  const char* name;
  std::shared_ptr<const Model> model;
};

const std::vector<Cubes>& cubes() {
  static const std::vector<Cubes> all{
      {"by tolerance", build_by_tolerance({kHalf, kHalf, kHalf})},
      {"uniform", build_model(make_box({kHalf, kHalf, kHalf}), 0.005)}};
  return all;
}

/// A cube slides without friction on a slab of `length`, in a direction, from one end to the other.
void expect_straight(const std::shared_ptr<const Model>& slab, double length, const Cubes& cube,
                     double rate, double heading, double turn) {
  SCOPED_TRACE(testing::Message() << cube.name << ", slab of " << length << " m, " << rate
                                  << " Hz, heading " << heading << ", turn " << turn);
  TestWorld world;
  world.add_model(slab, 0, {{}, {0, 0, -0.025}});
  const Vec3 ahead{std::cos(heading), std::sin(heading), 0};
  const double way = 0.5 * length - 0.075;
  const Matrix3 turned{
      {std::cos(turn), -std::sin(turn), 0}, {std::sin(turn), std::cos(turn), 0}, {0, 0, 1}};
  btRigidBody& body = world.add_model(
      cube.model, 1, {turned, Vec3{0.0013, 0.0007, kHalf + 0.0005} - 0.9 * way * ahead});
  body.setActivationState(DISABLE_DEACTIVATION);
  world.step(static_cast<int>(0.1 * rate), 1.0 / rate);
  const btQuaternion start = body.getWorldTransform().getRotation();
  body.setLinearVelocity(to_bullet(kSpeed * ahead));
  const int steps = static_cast<int>(1.8 * way / kSpeed * rate);
  double hop = 0.0;
  for (int i = 0; i < steps; ++i) {
    world.step(1, 1.0 / rate);
    hop = std::max(hop, std::abs(height(body) - kHalf));
  }
  const double along = dot(from_bullet(body.getLinearVelocity()), ahead);
  const double angle =
      static_cast<double>(start.angleShortestPath(body.getWorldTransform().getRotation()));
  EXPECT_NEAR(along, kSpeed, 0.02 * kSpeed);
  EXPECT_LT(hop, 3e-4);
  EXPECT_LT(angle, std::numbers::pi / 180.0);
}

// A ground point took the slanted normal of the cube's lower edge: on a slab of 1 m, a cube that
// slid at 0.5 m/s ended at 0.1 to 0.4 m/s, hopped by 3 mm and turned by up to 150 degrees.
TEST(Sliding, WithoutFrictionOnOneFlatSlabGoesStraightOn) {
  for (const double length : {0.3, 0.5, 1.0}) {
    const Vec3 half{0.5 * length, 0.5 * length, 0.025};
    for (const auto& slab : {build_by_tolerance(half), build_model(make_box(half), 0.01)}) {
      for (const Cubes& cube : cubes()) {
        for (const double rate : kRates) {
          if (rate > 500.0 && length > 0.4) continue;  // takes long
          for (const double heading : {0.0, 10.0, 30.0, 45.0}) {
            const double radians = heading * std::numbers::pi / 180.0;
            expect_straight(slab, length, cube, rate, radians, heading == 30.0 ? 1.0 : 0.0);
          }
        }
      }
    }
  }
}

// Edges of the ground's end were as high as the cube's lower edge, and had the normal of its front:
// a cube that slid at 0.5 to 2 m/s was stopped there, or thrown up by 30 mm.
TEST(Sliding, GoesOnOverTheEndOfTheGround) {
  const auto ground = build_by_tolerance({0.25, 0.25, 0.025});
  for (const Cubes& cube : cubes()) {
    for (const double rate : kRates) {
      for (const double speed : {0.5, 1.0, 2.0}) {
        for (const double heading : {0.0, 0.3}) {
          TestWorld world;
          world.add_model(ground, 0, {{}, {-0.25, 0, -0.025}});
          btRigidBody& body =
              world.add_model(cube.model, 1, {{}, {-0.1987, 0.0007 - 0.1 * heading, kHalf}});
          body.setActivationState(DISABLE_DEACTIVATION);
          world.step(20, 1.0 / rate);
          const Vec3 ahead{std::cos(heading), std::sin(heading), 0};
          body.setLinearVelocity(to_bullet(speed * ahead));
          // Until half of it is over the end.
          while (body.getWorldTransform().getOrigin().x() < scalar(-0.005 - speed / rate)) {
            world.step(1, 1.0 / rate);
            const double along = dot(from_bullet(body.getLinearVelocity()), ahead);
            ASSERT_NEAR(along, speed, 0.02 * speed) << cube.name << ", " << rate << " Hz";
            ASSERT_LT(height(body), kHalf + 3e-4) << cube.name << ", " << rate << " Hz";
          }
        }
      }
    }
  }
}

// Points of the slab took the normals of the facets that they met.
TEST(Sliding, IsNotWhatABallDoesThatDropsStraight) {
  const Vec3 half{0.5, 0.5, 0.025};
  const auto slab = build_by_tolerance(half);
  for (const int subdivisions : {3, 4}) {
    const auto sphere = voxshell::test_support::make_icosphere(kHalf, subdivisions);
    const auto ball = *Model::build(sphere.mesh(), {.tolerance = 1e-4, .threads = 1});
    for (const double rate : kRates) {
      for (int place = 0; place < 6; ++place) {
        TestWorld world;
        world.add_model(slab, 0, {{}, {0, 0, -0.025}}).setRestitution(1);
        btRigidBody& body = world.add_model(
            ball, 1, {{}, {-0.3 + 0.117 * place, 0.2 - 0.083 * place, kHalf + 0.3}});
        body.setRestitution(scalar(0.9));
        for (int i = 0; i < static_cast<int>(rate) && !(body.getLinearVelocity().z() > 0); ++i) {
          world.step(1, 1.0 / rate);
        }
        ASSERT_GT(body.getLinearVelocity().z(), 1);
        const btVector3 v = body.getLinearVelocity();
        const double impact = std::sqrt(2 * 9.81 * 0.3);
        EXPECT_LT(std::hypot(v.x(), v.y()), 0.01 * impact) << rate << " Hz, place " << place;
      }
    }
  }
}

}  // namespace
}  // namespace voxshell::bullet::sliding_test
