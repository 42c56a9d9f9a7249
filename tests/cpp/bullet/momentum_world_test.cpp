#include "voxshell/bullet/momentum_world.h"

#include <cmath>
#include <numbers>

#include <BulletDynamics/ConstraintSolver/btPoint2PointConstraint.h>
#include <gtest/gtest.h>

#include "support/world.h"
#include "voxshell/bullet/coulomb_solver.h"

namespace voxshell::bullet::momentum_world_test {
namespace {

using namespace test_support;

using SpinWorld = WorldOf<MomentumWorld<>, CoulombSolver>;

/// A body that turns in a world without gravity.
struct Spin {
  SpinWorld world{{}, {0, 0, 0}};
  btRigidBody& body;

  Spin(const Vec3& inertia, const Vec3& angular_velocity)
      : body(world.add(world.make<btSphereShape>(scalar(0.1)), 1)) {
    body.setMassProps(1, to_bullet(inertia));
    body.updateInertiaTensor();
    body.setAngularVelocity(to_bullet(angular_velocity));
    body.setActivationState(DISABLE_DEACTIVATION);
  }

  Vec3 momentum() const {
    const btMatrix3x3& basis = body.getWorldTransform().getBasis();
    const btVector3 of_body = basis.transpose() * body.getAngularVelocity();
    return from_bullet(basis * (of_body / body.getInvInertiaDiagLocal()));
  }
  double energy() const { return 0.5 * dot(momentum(), from_bullet(body.getAngularVelocity())); }
  Vec3 axis(int column) const {
    return from_bullet(body.getWorldTransform().getBasis().getColumn(column));
  }
};

constexpr double kFraction = kIsDouble ? 1e-9 : 2e-3;  // of the start, after 6000 steps

TEST(MomentumWorld, KeepsEnergyAndMomentumOfATumblingBody) {
  for (const int rate : {1000, 200, 60}) {
    SCOPED_TRACE(rate);
    const double spin = 0.2 * rate;  // 0.2 rad a step
    Spin tumble({1.0, 2.0, 2.6}, {0.1 * spin, spin, 0.2 * spin});
    const Vec3 momentum = tumble.momentum();
    const double energy = tumble.energy();
    tumble.world.step(30 * rate, 1.0 / rate);
    EXPECT_NEAR(tumble.energy(), energy, 10 * kFraction * energy);
    EXPECT_LT(length(tumble.momentum() - momentum), 10 * kFraction * length(momentum));
  }
}

// The axis of a symmetric top without torques goes round the momentum at momentum / inertia.
TEST(MomentumWorld, TurnsASymmetricBodyRoundItsMomentum) {
  constexpr int kRate = 60;
  constexpr double kAcross = 2.0;
  constexpr double kAlong = 3.0;
  Spin top({kAcross, kAcross, kAlong}, {4.0, 0.0, 11.0});
  const Vec3 momentum = top.momentum();
  const Vec3 up = normalized(momentum);
  const Vec3 start = top.axis(2);
  constexpr int kSteps = 30 * kRate;
  top.world.step(kSteps, 1.0 / kRate);
  const double angle = length(momentum) / kAcross * kSteps / kRate;
  const Vec3 expected = std::cos(angle) * start + std::sin(angle) * cross(up, start) +
                        (1.0 - std::cos(angle)) * dot(up, start) * up;
  EXPECT_LT(length(top.axis(2) - expected), kIsDouble ? 1e-8 : 0.02);
}

// Half the time in two steps instead of one, and the same attitude.
TEST(MomentumWorld, DoesNotDependOnTheStep) {
  Spin fine({1.0, 2.0, 2.6}, {1.0, 11.0, 2.0});
  Spin coarse({1.0, 2.0, 2.6}, {1.0, 11.0, 2.0});
  fine.world.step(30 * 1000, 0.001);
  coarse.world.step(30 * 50, 0.02);
  EXPECT_LT(length(fine.axis(0) - coarse.axis(0)), kIsDouble ? 1e-7 : 0.1);
  EXPECT_LT(length(fine.axis(1) - coarse.axis(1)), kIsDouble ? 1e-7 : 0.1);
}

TEST(MomentumWorld, TurnsFasterThanBulletsEighthOfATurn) {
  Spin wheel({1.0, 1.0, 1.0}, {0.0, 0.0, 200.0});  // 2 rad a step
  wheel.world.step(100, 0.01);
  EXPECT_NEAR(wheel.axis(0).x, std::cos(200.0), kIsDouble ? 1e-9 : 1e-3);
}

TEST(MomentumWorld, LeavesWhatItCannotTurnToBullet) {
  Spin locked({0.0, 0.0, 1.0}, {0.0, 0.0, 3.0});
  locked.world.step(100, 0.01);
  EXPECT_NEAR(locked.axis(0).x, std::cos(3.0), 1e-4);
  Spin wild({1.0, 2.0, 3.0}, {1e9, 1e9, 1e9});
  wild.world.step(10, 0.01);
  EXPECT_NEAR(length(wild.axis(0)), 1.0, 1e-4);
}

// A top that spins fast about its upright axis, a tenth of a radian aslant, on a point.
TEST(MomentumWorld, LetsAHeavyTopPrecess) {
  constexpr double kArm = 0.05;       // meters from the point to the center of mass
  constexpr double kAlong = 2e-4;     // kg m2
  constexpr double kAcross = 1.5e-4;  // about the center of mass
  constexpr double kSpin = 200.0;     // rad/s
  constexpr double kTilt = 0.3;
  SpinWorld world({}, {0, 0, -9.81});
  world.world.getSolverInfo().m_numIterations = 50;
  const Vec3 axis{std::sin(kTilt), 0.0, std::cos(kTilt)};
  const Matrix3 rotation{{std::cos(kTilt), 0.0, std::sin(kTilt)},
                         {0.0, 1.0, 0.0},
                         {-std::sin(kTilt), 0.0, std::cos(kTilt)}};
  constexpr double kMass = 0.2;
  btRigidBody& top =
      world.add(world.make<btSphereShape>(scalar(0.02)), kMass, {rotation, kArm * axis});
  top.setMassProps(scalar(kMass), to_bullet(Vec3{kAcross, kAcross, kAlong}));
  top.updateInertiaTensor();
  top.setActivationState(DISABLE_DEACTIVATION);
  // Steady precession: of the two rates the slow one.
  const double across = kAcross + kMass * kArm * kArm;
  const double momentum = kAlong * kSpin;
  const double weight = kMass * 9.81 * kArm;
  const double a = (across - kAlong) * std::cos(kTilt);
  const double rate = (momentum - std::sqrt(momentum * momentum - 4.0 * a * weight)) / (2.0 * a);
  const Vec3 turn = rate * Vec3{0, 0, 1} + (kSpin - rate * std::cos(kTilt)) * axis;
  top.setAngularVelocity(to_bullet(turn));
  top.setLinearVelocity(to_bullet(cross(turn, kArm * axis)));
  btPoint2PointConstraint point(top, btVector3(0, 0, scalar(-kArm)));
  world.world.addConstraint(&point);
  double angle = 0.0;
  double before = 0.0;
  constexpr int kSteps = 2000;
  for (int i = 0; i < kSteps; ++i) {
    world.step(1, 0.001);
    const btVector3 place = top.getWorldTransform().getOrigin();
    const double now = std::atan2(static_cast<double>(place.y()), static_cast<double>(place.x()));
    angle += std::remainder(now - before, 2.0 * std::numbers::pi);
    before = now;
  }
  world.world.removeConstraint(&point);
  EXPECT_NEAR(angle, rate * kSteps / 1000.0, 0.03 * rate * kSteps / 1000.0);
  const btVector3 end = top.getWorldTransform().getBasis().getColumn(2);
  EXPECT_NEAR(std::acos(static_cast<double>(end.z())), kTilt, 0.02);
}

// Around a hinge that is no principal axis the bearing takes what the momentum does aside.
TEST(MomentumWorld, AWheelOutOfBalanceKeepsItsSpin) {
  const auto fraction_left = [](double spin) {
    Spin wheel({1.0, 2.0, 2.6}, {});
    const Matrix3 rotation{
        {std::cos(0.3), 0.0, std::sin(0.3)}, {0.0, 1.0, 0.0}, {-std::sin(0.3), 0.0, std::cos(0.3)}};
    wheel.body.setCenterOfMassTransform(to_bullet(Pose{rotation, {}}));
    wheel.body.setAngularVelocity(btVector3(0, 0, scalar(spin)));
    const btMatrix3x3 body_from_world = wheel.body.getWorldTransform().getBasis().transpose();
    btHingeConstraint hinge(wheel.body, btVector3(0, 0, 0), body_from_world * btVector3(0, 0, 1));
    wheel.world.world.addConstraint(&hinge);
    wheel.world.step(2000, 0.005);
    wheel.world.world.removeConstraint(&hinge);
    return static_cast<double>(wheel.body.getAngularVelocity().z()) / spin;
  };
  EXPECT_NEAR(fraction_left(2.5), 1.0, 0.001);
  EXPECT_NEAR(fraction_left(10.0), 1.0, 0.002);
  EXPECT_NEAR(fraction_left(40.0), 1.0, 0.05);
}

}  // namespace
}  // namespace voxshell::bullet::momentum_world_test
