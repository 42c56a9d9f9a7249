#include "voxshell/bullet/checked_motion.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/world.h"
#include "voxshell/bullet/coulomb_solver.h"

namespace voxshell::bullet {
namespace {

using namespace test_support;

constexpr double kRate = 60.0;
constexpr Vec3 kHalfBar{0.2, 0.01, 0.01};
constexpr double kGap = 0.005;  // between the bar and the wall, metres

template <class World>
using Weightless = WorldOf<World, CoulombSolver>;

/// A bar beside a wall, which a torque turns from rest. The deepest place of its end in the wall
/// within 0.1 s, metres. `is_model` tells what the wall is.
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

/// Elastic balls in a row along x, a millimeter apart. The first one comes at 1 m/s.
class Row {
 public:
  explicit Row(const std::vector<double>& masses) : world_({}, {}) {
    double x = -0.03;
    const auto model = build_by_tolerance(voxshell::test_support::make_icosphere(kBallRadius, 4));
    for (const double mass : masses) {
      btRigidBody& ball = world_.add_model(model, mass, {{}, {x, 0, 0}});
      ball.setRestitution(1);
      ball.setDamping(0, 0);
      balls_.push_back(&ball);
      x = balls_.size() == 1 ? 2 * kBallRadius : x + 2 * kBallRadius + 0.001;
    }
    balls_[0]->setLinearVelocity({1, 0, 0});
  }

  void step(double rate) { world_.step(1, 1.0 / rate); }
  btRigidBody& ball(std::size_t i) { return *balls_[i]; }
  double speed(std::size_t i) const {
    return static_cast<double>(balls_[i]->getLinearVelocity().x());
  }
  /// Of all contacts of the first ball, along the row, N s.
  double impulse_on_first() {
    double sum = 0.0;
    for (int m = 0; m < world_.dispatcher.getNumManifolds(); ++m) {
      const btPersistentManifold& manifold = *world_.dispatcher.getManifoldByIndexInternal(m);
      if (manifold.getBody0() != balls_[0] && manifold.getBody1() != balls_[0]) continue;
      for (int i = 0; i < manifold.getNumContacts(); ++i) {
        const btManifoldPoint& point = manifold.getContactPoint(i);
        sum += static_cast<double>(point.m_appliedImpulse * btFabs(point.m_normalWorldOnB.x()));
      }
    }
    return sum;
  }

 private:
  Weightless<CheckedMotionWorld<>> world_;
  std::vector<btRigidBody*> balls_;
};

constexpr double kSamplesOfBall = 2e-3;  // normals of a ball's samples lean a little

TEST(CheckedMotion, PassesABlowOnThroughARow) {
  for (const double rate : {200.0, 60.0, 30.0}) {
    for (const bool sleeps : {false, true}) {
      Row row({1, 1, 1, 1, 1});
      if (sleeps) row.ball(1).forceActivationState(ISLAND_SLEEPING);
      for (int i = 0; i < 20; ++i) row.step(rate);
      EXPECT_NEAR(row.speed(4), 1, kSamplesOfBall) << rate << ' ' << sleeps;
      for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(row.speed(i), 0, kSamplesOfBall) << rate;
    }
  }
}

// The light ball between is thrown back and forth: blow by blow, 1/2 and 3/2 m/s, -3/4 and 3/4,
// -1/8 and 9/8, 9/16 and 15/16.
TEST(CheckedMotion, PassesBlowsBackAndForth) {
  for (const double rate : {200.0, 60.0, 30.0}) {
    Row row({3, 1, 3});
    for (int i = 0; i < 20; ++i) row.step(rate);
    EXPECT_NEAR(row.speed(0), -0.125, kSamplesOfBall) << rate;
    EXPECT_NEAR(row.speed(1), 0.5625, kSamplesOfBall) << rate;
    EXPECT_NEAR(row.speed(2), 0.9375, kSamplesOfBall) << rate;
  }
}

TEST(CheckedMotion, ReportsTheImpulsesOfAllBlows) {
  for (const double rate : {200.0, 60.0, 30.0}) {
    Row row({3, 1, 3});
    for (int i = 0; i < 20; ++i) {
      const double before = row.speed(0);
      row.step(rate);
      EXPECT_NEAR(row.impulse_on_first(), 3 * (before - row.speed(0)), kSamplesOfBall) << rate;
    }
  }
}

}  // namespace
}  // namespace voxshell::bullet
