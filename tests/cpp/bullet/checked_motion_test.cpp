#include "voxshell/bullet/checked_motion.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/world.h"
#include "voxshell/bullet/coulomb_solver.h"

namespace voxshell::bullet::checked_motion_test {
namespace {

using namespace test_support;

constexpr double kRate = 60.0;
constexpr Vec3 kHalfBar{0.2, 0.01, 0.01};
constexpr double kGap = 0.005;  // between the bar and the wall, meters

template <class World>
using Weightless = WorldOf<World, CoulombSolver>;

/// A bar beside a wall, which a torque turns from rest. The deepest place of its end in the wall
/// within 0.1 s, meters. `is_model` tells what the wall is.
template <class World>
double depth_of_turned_bar(bool is_model) {
  Weightless<World> world({}, {});
  const Vec3 half_wall{0.5, 0.05, 0.5};
  const Pose pose{{}, {0, kHalfBar.y + kGap + half_wall.y, 0}};
  if (is_model) {
    world.add_model(build_by_tolerance(half_wall), 0, pose);
  } else {
    world.add(world.template make<btBoxShape>(to_bullet(half_wall)), 0, pose);
  }
  btRigidBody& bar = world.add_model(build_by_tolerance(kHalfBar), 1);
  double deepest = 0.0;
  for (int i = 0; i < 6; ++i) {
    bar.applyTorque(btVector3(0, 0, 2));
    world.step(1, 1.0 / kRate);
    for (const double x : {-kHalfBar.x, kHalfBar.x}) {
      const btVector3 corner = bar.getWorldTransform() * to_bullet(Vec3{x, kHalfBar.y, 0});
      deepest = std::max(deepest, static_cast<double>(corner.y()) - kHalfBar.y - kGap);
    }
  }
  return deepest;
}

TEST(CheckedMotion, StopsWhatATorqueTurnsIntoAWall) {
  for (const bool is_model : {true, false}) {
    EXPECT_LT(depth_of_turned_bar<CheckedMotionWorld<>>(is_model), 1e-4) << is_model;
    EXPECT_GT(depth_of_turned_bar<btDiscreteDynamicsWorld>(is_model), 3e-3) << is_model;
  }
}

template <class World>
std::vector<double> heights_of_falling_cube() {
  Weightless<World> world;
  world.add_model(build_by_tolerance({0.3, 0.3, 0.05}), 0, {{}, {0, 0, -0.05}});
  btRigidBody& cube = world.add_model(build_by_tolerance({0.05, 0.05, 0.05}), 1, {{}, {0, 0, 0.2}});
  std::vector<double> heights;
  for (int i = 0; i < 60; ++i) {
    world.step(1, 1.0 / kRate);
    heights.push_back(height(cube));
  }
  return heights;
}

TEST(CheckedMotion, LeavesWhatWasExpectedAsItIs) {
  EXPECT_EQ(heights_of_falling_cube<CheckedMotionWorld<>>(),
            heights_of_falling_cube<btDiscreteDynamicsWorld>());
}

// A torque turns the bar into the wall, so that the step is solved twice. The wall has no friction,
// and leaves what a force adds along it.
TEST(CheckedMotion, KeepsForcesAndTheirFactors) {
  for (const btVector3& factor : {btVector3(1, 1, 1), btVector3(0, 1, scalar(0.5))}) {
    Weightless<CheckedMotionWorld<>> world({}, {});
    const Vec3 half_wall{0.5, 0.05, 0.5};
    world.add_model(build_by_tolerance(half_wall), 0,
                    {{}, {0, kHalfBar.y + kGap + half_wall.y, 0}});
    btRigidBody& bar = world.add_model(build_by_tolerance(kHalfBar), 1);
    bar.setLinearFactor(factor);
    bar.applyTorque(btVector3(0, 0, 2));
    bar.applyCentralForce(btVector3(30, 0, 6));
    world.step(1, 1.0 / kRate);
    ASSERT_LT(bar.getAngularVelocity().z(), 2);  // 2.5 rad/s without the wall
    EXPECT_NEAR(bar.getLinearVelocity().x(), 0.5 * static_cast<double>(factor.x()), 1e-5);
    EXPECT_NEAR(bar.getLinearVelocity().z(), 0.1 * static_cast<double>(factor.z()), 1e-5);
  }
}

}  // namespace
}  // namespace voxshell::bullet::checked_motion_test
