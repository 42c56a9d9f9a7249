#include "voxshell/bullet/coulomb_solver.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/world.h"

namespace voxshell::bullet::coulomb_solver_test {
namespace {

using namespace test_support;

using CoulombWorld = WorldOf<btDiscreteDynamicsWorld, CoulombSolver>;

constexpr double kGravity = 9.81;  // m/s2
constexpr int kTwoDirections =
    SOLVER_USE_2_FRICTION_DIRECTIONS | SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION;

enum class Shape { kBulletBox, kCube, kTorus };
enum class Ground { kPlane, kSlab, kBulletBox };

Vec3 heading(double degrees) {
  const double angle = degrees * std::numbers::pi / 180.0;
  return {std::cos(angle), std::sin(angle), 0.0};
}

/// A body that lies on a ground, z up, whose gravity may lean toward `along`.
struct Slide {
  CoulombWorld world;
  btRigidBody& body;

  Slide(Shape shape, Ground ground, double friction, const Vec3& along)
      : body(add_body(shape, along)) {
    world.world.getSolverInfo().m_solverMode |= kTwoDirections;
    world.world.getSolverInfo().m_numIterations = 50;
    add_ground(ground).setFriction(1);
    body.setFriction(scalar(friction));
    body.setActivationState(DISABLE_DEACTIVATION);
  }

  btRigidBody& add_body(Shape shape, const Vec3& along) {
    const Vec3 start = -0.3 * along;
    switch (shape) {
      case Shape::kBulletBox:
        return world.add(world.make<btBoxShape>(to_bullet(Vec3{0.1, 0.1, 0.1})), 1,
                         {{}, start + Vec3{0, 0, 0.1}});
      case Shape::kCube:
        static const auto cube = build_by_tolerance({0.1, 0.1, 0.1});
        return world.add_model(cube, 1, {{}, start + Vec3{0, 0, 0.1}});
      case Shape::kTorus:
        break;
    }
    return world.add_model(torus_model(), 1, {{}, start + Vec3{0, 0, 0.03}});
  }

  btRigidBody& add_ground(Ground ground) {
    if (ground == Ground::kPlane) {
      return world.add(world.make<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0);
    }
    if (ground == Ground::kBulletBox) {
      return world.add(world.make<btBoxShape>(to_bullet(Vec3{0.8, 0.8, 0.05})), 0,
                       {{}, {0, 0, -0.05}});
    }
    static const auto slab = build_by_tolerance({0.8, 0.8, 0.05});
    return world.add_model(slab, 0, {{}, {0, 0, -0.05}});
  }

  /// Bullet's own boxes find their four points one a step.
  void settle(int rate) { world.step(rate / 5, 1.0 / rate); }

  void lean(const Vec3& along, double slope) {
    const Vec3 gravity = kGravity * (std::sin(slope) * along - std::cos(slope) * Vec3{0, 0, 1});
    world.world.setGravity(to_bullet(gravity));
  }

  double way_along(const Vec3& along) const {
    return dot(from_bullet(body.getWorldTransform().getOrigin()), along);
  }

  /// How far the body gets from `speed` until it stands, meters.
  double run_out(double speed, const Vec3& along, int rate) {
    settle(rate);
    const double start = way_along(along);
    body.setLinearVelocity(to_bullet(speed * along));
    world.step(rate / 2, 1.0 / rate);
    EXPECT_LT(body.getLinearVelocity().length(), scalar(0.01));
    return way_along(along) - start;
  }
};

/// What a body that loses friction * g / rate a step moves from `speed` on, meters.
double run_out(double speed, double friction, int rate) {
  double way = 0.0;
  while (speed > 0.0) {
    speed -= friction * kGravity / rate;
    way += std::max(speed, 0.0) / rate;
  }
  return way;
}

class Sliding : public testing::TestWithParam<std::tuple<Ground, int>> {
 protected:
  static constexpr double kHeadings[] = {0.0, 22.5, 45.0, 67.0};

  /// All of them where steps are few.
  static std::vector<double> headings(int rate) {
    if (rate <= 60) return {std::begin(kHeadings), std::end(kHeadings)};
    return {kHeadings[rate == 200 ? 1 : 2]};
  }
};

INSTANTIATE_TEST_SUITE_P(OnGrounds, Sliding,
                         testing::Combine(testing::Values(Ground::kPlane, Ground::kSlab),
                                          testing::Values(1000, 200, 60, 30)));

TEST_P(Sliding, IsAsFastAsCoulombSays) {
  const auto& [ground, rate] = GetParam();
  for (const double degrees : headings(rate)) {
    SCOPED_TRACE(degrees);
    const Vec3 along = heading(degrees);
    const double slope = 35.0 * std::numbers::pi / 180.0;
    Slide slide(Shape::kCube, ground, 0.5, along);
    slide.settle(rate);
    slide.lean(along, slope);
    const int steps = rate * 2 / 5;
    slide.world.step(steps, 1.0 / rate);
    const double expected =
        kGravity * (std::sin(slope) - 0.5 * std::cos(slope)) * steps / static_cast<double>(rate);
    const Vec3 velocity = from_bullet(slide.body.getLinearVelocity());
    EXPECT_NEAR(dot(velocity, along), expected, 0.05 * expected);
    EXPECT_NEAR(length(velocity), expected, 0.05 * expected);
  }
}

TEST_P(Sliding, StopsWhereCoulombSays) {
  const auto& [ground, rate] = GetParam();
  for (const double degrees : headings(rate)) {
    SCOPED_TRACE(degrees);
    const Vec3 along = heading(degrees);
    Slide slide(Shape::kCube, ground, 0.5, along);
    const double expected = run_out(1.0, 0.5, rate);
    EXPECT_NEAR(slide.run_out(1.0, along, rate), expected, 0.05 * expected);
  }
}

TEST(CoulombSolver, StopsBulletsOwnBoxInAnyDirection) {
  for (const double degrees : {0.0, 22.5, 45.0}) {
    SCOPED_TRACE(degrees);
    const Vec3 along = heading(degrees);
    Slide slide(Shape::kBulletBox, Ground::kBulletBox, 0.5, along);
    const double expected = run_out(1.0, 0.5, 200);
    EXPECT_NEAR(slide.run_out(1.0, along, 200), expected, 0.05 * expected);
  }
}

/// The modes of Bullet's solver, each of which has code of its own.
TEST(CoulombSolver, WorksInEverySolverMode) {
  constexpr int kInterleaved = SOLVER_INTERLEAVE_CONTACT_AND_FRICTION_CONSTRAINTS;
  for (const int mode : {0, kTwoDirections, kInterleaved, kTwoDirections | kInterleaved,
                         static_cast<int>(SOLVER_RANDMIZE_ORDER),
                         kTwoDirections | kInterleaved | SOLVER_RANDMIZE_ORDER}) {
    for (const int simd : {0, static_cast<int>(SOLVER_SIMD)}) {
      SCOPED_TRACE(std::to_string(mode) + (simd ? " SIMD" : ""));
      const Vec3 along = heading(30.0);
      Slide slide(Shape::kCube, Ground::kPlane, 0.5, along);
      slide.world.world.getSolverInfo().m_solverMode = SOLVER_USE_WARMSTARTING | mode | simd;
      const double expected = run_out(1.0, 0.5, 200);
      EXPECT_NEAR(slide.run_out(1.0, along, 200), expected, 0.05 * expected);
    }
  }
}

TEST(CoulombSolver, KeepsTheFrictionOfEveryPointWithinItsCone) {
  Slide slide(Shape::kCube, Ground::kPlane, 0.5, {});
  slide.settle(200);
  slide.body.setLinearVelocity(to_bullet(heading(30.0)));
  slide.body.setAngularVelocity(btVector3(0, 0, 3));
  int sliding = 0;
  int unloaded = 0;
  for (int i = 0; i < 10; ++i) {
    slide.world.step(1);
    for (const btManifoldPoint* point : slide.world.points()) {
      const double friction = std::hypot(static_cast<double>(point->m_appliedImpulseLateral1),
                                         static_cast<double>(point->m_appliedImpulseLateral2));
      const double bound = 0.5 * static_cast<double>(point->m_appliedImpulse);
      EXPECT_LE(friction, bound * (1.0 + 1e-5) + 1e-12);
      if (bound > 0.0 && friction > 0.999 * bound) ++sliding;
      if (bound == 0.0) ++unloaded;
    }
  }
  EXPECT_GT(sliding, 20);
  EXPECT_GT(unloaded, 20);
}

// The stock solver sets friction rows up without the torques of the step: such a box turned at
// torque / inertia * time step, 0.3 rad/s here.
TEST(CoulombSolver, HoldsABoxAgainstATorqueBelowFriction) {
  for (const Shape shape : {Shape::kBulletBox, Shape::kCube}) {
    Slide slide(shape, Ground::kPlane, 0.5, {});
    slide.settle(200);
    for (int i = 0; i < 200; ++i) {
      slide.body.applyTorque(btVector3(0, 0, scalar(0.3)));
      slide.world.step(1);
    }
    EXPECT_LT(slide.body.getAngularVelocity().length(), scalar(0.005));
  }
}

TEST(CoulombSolver, SlowsRollingByTheLeverWhateverTheWeight) {
  constexpr double kLever = 0.01;  // meters
  constexpr double kRadius = 0.1;  // meters
  for (const double mass : {1.0, 1000.0}) {
    SCOPED_TRACE(mass);
    CoulombWorld world;
    world.world.getSolverInfo().m_solverMode |= kTwoDirections;
    btRigidBody& ground =
        world.add(world.make<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0);
    ground.setFriction(1);
    btRigidBody& ball =
        world.add(world.make<btSphereShape>(scalar(kRadius)), mass, {{}, {0, 0, kRadius}});
    ball.setFriction(1);
    ball.setRollingFriction(scalar(kLever));
    ball.setActivationState(DISABLE_DEACTIVATION);
    world.step(20);
    const Vec3 along = heading(30.0);
    ball.setLinearVelocity(to_bullet(2.0 * along));
    ball.setAngularVelocity(to_bullet(2.0 / kRadius * Vec3{-along.y, along.x, 0.0}));
    world.step(200);
    const double lost = 5.0 / 7.0 * kLever * kGravity / kRadius;
    EXPECT_NEAR(dot(from_bullet(ball.getLinearVelocity()), along), 2.0 - lost, 0.05 * lost);
  }
}

// A body without moments of inertia to turn by made the stock solver's rolling rows infinite.
TEST(CoulombSolver, GivesNoRollingFrictionToABodyThatCannotTurn) {
  CoulombWorld world;
  btRigidBody& ground =
      world.add(world.make<btStaticPlaneShape>(btVector3(0, 0, 1), btScalar(0)), 0);
  ground.setFriction(1);
  btRigidBody& ball = world.add(world.make<btSphereShape>(scalar(0.1)), 1, {{}, {0, 0, 0.1}});
  ball.setMassProps(1, btVector3(0, 0, 0));
  ball.updateInertiaTensor();
  ball.setFriction(scalar(0.5));
  ball.setRollingFriction(scalar(0.01));
  ball.setActivationState(DISABLE_DEACTIVATION);
  ball.setLinearVelocity(btVector3(1, 0, 0));
  world.step(100);
  EXPECT_NEAR(height(ball), 0.1, 0.001);
  EXPECT_LT(ball.getLinearVelocity().length(), scalar(0.01));
}

TEST(CoulombSolver, HoldsBelowTheAngleOfFriction) {
  for (const auto& [shape, ground] :
       {std::pair(Shape::kCube, Ground::kSlab), std::pair(Shape::kTorus, Ground::kPlane)}) {
    SCOPED_TRACE(static_cast<int>(shape));
    const Vec3 along = heading(20.0);
    Slide slide(shape, ground, 0.5, along);
    slide.settle(200);
    slide.lean(along, std::atan(0.5 * 0.95));
    slide.world.step(100);
    const Vec3 start = from_bullet(slide.body.getWorldTransform().getOrigin());
    slide.world.step(600);
    const Vec3 end = from_bullet(slide.body.getWorldTransform().getOrigin());
    EXPECT_LT(length(end - start), kIsDouble ? 1e-5 : 1e-4);
  }
}

TEST(CoulombSolver, StepsTheSameWayOnEveryRun) {
  const auto run = [](int mode) {
    CoulombWorld world;
    world.world.getSolverInfo().m_solverMode |= mode;
    world.add_model(slab_model(), 0).setFriction(1);
    std::vector<const btRigidBody*> bodies;
    for (int i = 0; i < 4; ++i) {
      btRigidBody& body = world.add_model(i % 2 == 0 ? cube_model() : torus_model(), 1 + i,
                                          {{}, {0.02 * i, 0.01 * i, 0.15 + 0.22 * i}});
      body.setFriction(scalar(0.5));
      body.setAngularVelocity(btVector3(1, 2, 3));
      bodies.push_back(&body);
    }
    world.step(400);
    std::vector<btTransform> ends;
    for (const btRigidBody* body : bodies) ends.push_back(body->getWorldTransform());
    return ends;
  };
  for (const int mode : {0, kTwoDirections, kTwoDirections | SOLVER_RANDMIZE_ORDER}) {
    const auto first = run(mode);
    const auto second = run(mode);
    for (std::size_t i = 0; i < first.size(); ++i) EXPECT_TRUE(first[i] == second[i]) << mode;
  }
}

}  // namespace
}  // namespace voxshell::bullet::coulomb_solver_test
