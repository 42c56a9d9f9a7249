// What SolvedMotionSearch finds, in a world that solves steps again.

#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/world.h"
#include "voxshell/bullet/checked_motion.h"
#include "voxshell/bullet/coulomb_solver.h"

namespace voxshell::bullet::solved_motion_search_test {
namespace {

using namespace test_support;
using voxshell::test_support::inverted;
using voxshell::test_support::make_box;
using voxshell::test_support::make_icosphere;
using voxshell::test_support::together;

constexpr double kHalfRoom = 0.05;  // meters
constexpr double kRadius = 0.015;
constexpr double kTimeStep = 1.0 / 60.0;

/// A ball in the middle of a room of one model. Weightless.
template <class World>
class Room {
 public:
  Room(double restitution, const Vec3& velocity) : world_({}, {}) {
    const auto cube = [](double half) { return make_box({half, half, half}); };
    const Soup walls = together(cube(kHalfRoom + 0.005), inverted(cube(kHalfRoom)));
    btRigidBody& room = world_.add_model(build_by_tolerance(walls), 0);
    ball_ = &world_.add_model(build_by_tolerance(make_icosphere(kRadius, 3)), 1);
    for (btRigidBody* const body : {&room, ball_}) body->setRestitution(scalar(restitution));
    ball_->setLinearVelocity(to_bullet(velocity));
  }

  void step(int count) { world_.step(count, kTimeStep); }
  /// How far the ball is beyond the walls, at most, meters.
  double outside() const {
    const btVector3 place = ball_->getWorldTransform().getOrigin().absolute();
    return static_cast<double>(place[place.maxAxis()]) + kRadius - kHalfRoom;
  }
  double speed() const { return static_cast<double>(ball_->getLinearVelocity().length()); }
  std::size_t count_points() { return world_.points().size(); }
  void remove_ball() { world_.world.removeRigidBody(ball_); }

 private:
  WorldOf<World, CoulombSolver> world_;
  btRigidBody* ball_ = nullptr;
};

// The room and the ball are one pair, which has contacts with the first wall that is hit.
TEST(SolvedMotionSearch, FindsOtherWallsOfABodyThatIsTouched) {
  for (const double restitution : {0.0, 0.5, 0.9}) {
    Room<CheckedMotionWorld<>> room(restitution, {4, 1, 0});
    double outside = 0.0;
    for (int i = 0; i < 20; ++i) {
      room.step(1);
      outside = std::fmax(outside, room.outside());
    }
    EXPECT_LT(outside, 2e-4) << restitution;
    EXPECT_LE(room.speed(), std::sqrt(17.0) * 1.001) << restitution;
  }
}

TEST(SolvedMotionSearch, KeepsTheSpeedOfWhatIsStoppedBeforeItsNextRebound) {
  Room<CheckedMotionWorld<>> room(1.0, {5, 0, 0});
  for (int i = 0; i < 10; ++i) {
    room.step(1);
    EXPECT_LT(room.outside(), 2e-4) << i;
    EXPECT_NEAR(room.speed(), 5, 0.01) << i;
  }
}

TEST(SolvedMotionSearch, ForgetsContactsOfBodiesThatAreRemoved) {
  Room<CheckedMotionWorld<>> room(0.9, {4, 1, 0});
  room.step(1);
  EXPECT_GT(room.count_points(), 0u);
  room.remove_ball();
  EXPECT_EQ(room.count_points(), 0u);
  room.step(1);
}

}  // namespace
}  // namespace voxshell::bullet::solved_motion_search_test
