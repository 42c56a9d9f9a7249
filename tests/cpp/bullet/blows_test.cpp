#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/world.h"
#include "voxshell/bullet/checked_motion.h"
#include "voxshell/bullet/coulomb_solver.h"

namespace voxshell::bullet::blows_test {
namespace {

using namespace test_support;

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
  WorldOf<CheckedMotionWorld<>, CoulombSolver> world_;
  std::vector<btRigidBody*> balls_;
};

constexpr double kSamplesOfBall = 2e-3;  // normals of a ball's samples lean a little

TEST(Blows, PassThroughARow) {
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
TEST(Blows, GoBackAndForth) {
  for (const double rate : {200.0, 60.0, 30.0}) {
    Row row({3, 1, 3});
    for (int i = 0; i < 20; ++i) row.step(rate);
    EXPECT_NEAR(row.speed(0), -0.125, kSamplesOfBall) << rate;
    EXPECT_NEAR(row.speed(1), 0.5625, kSamplesOfBall) << rate;
    EXPECT_NEAR(row.speed(2), 0.9375, kSamplesOfBall) << rate;
  }
}

TEST(Blows, AddUpInWhatContactsReport) {
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
}  // namespace voxshell::bullet::blows_test
