#include "voxshell/bullet/seams.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <memory>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/world.h"
#include "voxshell/bullet/seamless_world.h"

namespace voxshell::bullet::seams_test {
namespace {

using namespace test_support;

constexpr double kHalf = 0.05;
constexpr double kTile = 0.4;  // length of a tile's side, meters
constexpr Vec3 kHalfTile{0.5 * kTile, 0.5 * kTile, 0.025};
constexpr double kRates[] = {1000.0, 200.0, 60.0, 30.0};

using Seamless = WorldOf<SeamlessWorld<>, btSequentialImpulseConstraintSolver>;

const std::shared_ptr<const Model>& cube_model() {
  static const auto model = build_by_tolerance({kHalf, kHalf, kHalf});
  return model;
}

const std::shared_ptr<const Model>& tile_model() {
  static const auto model = build_by_tolerance(kHalfTile);
  return model;
}

enum class Tiles { kModels, kBoxes };

template <class World>
btRigidBody& add_tile(World& world, Tiles tiles, const Vec3& top, double mass = 0.0) {
  const Pose pose{{}, top - Vec3{0, 0, kHalfTile.z}};
  if (tiles == Tiles::kModels) return world.add_model(tile_model(), mass, pose);
  return world.add(world.template make<btBoxShape>(to_bullet(kHalfTile)), mass, pose);
}

/// A cube that stands on the first tile and is then pushed toward the origin.
template <class World>
btRigidBody& push_cube(World& world, double rate, double speed, double heading, double turn = 0.0) {
  const Vec3 ahead{std::cos(heading), std::sin(heading), 0};
  const Matrix3 turned{
      {std::cos(turn), -std::sin(turn), 0}, {std::sin(turn), std::cos(turn), 0}, {0, 0, 1}};
  btRigidBody& cube =
      world.add_model(cube_model(), 1, {turned, Vec3{0.0013, 0.0007, kHalf} - 0.12 * ahead});
  cube.setActivationState(DISABLE_DEACTIVATION);
  world.step(static_cast<int>(std::max(0.05 * rate, 3.0)), 1.0 / rate);
  cube.setLinearVelocity(to_bullet(speed * ahead));
  return cube;
}

/// What the user sees of a body that crosses a seam.
void expect_unnoticed(Seamless& world, double rate, double speed, double heading, double turn) {
  SCOPED_TRACE(testing::Message() << rate << " Hz, " << speed << " m/s, heading " << heading
                                  << ", turn " << turn);
  btRigidBody& cube = push_cube(world, rate, speed, heading, turn);
  const btQuaternion start = cube.getWorldTransform().getRotation();
  double hop = 0.0;
  double angle = 0.0;
  for (int i = 0; i < static_cast<int>(0.24 / speed * rate); ++i) {
    world.step(1, 1.0 / rate);
    hop = std::max(hop, std::abs(height(cube) - kHalf));
    angle = std::max(angle, static_cast<double>(
                                start.angleShortestPath(cube.getWorldTransform().getRotation())));
  }
  const Vec3 ahead{std::cos(heading), std::sin(heading), 0};
  EXPECT_NEAR(dot(from_bullet(cube.getLinearVelocity()), ahead), speed, 0.02 * speed);
  EXPECT_LT(hop, 3e-4);
  EXPECT_LT(angle, std::numbers::pi / 180.0);
}

// The side of the second tile was a wall: a cube ended at -0.4 to 0.3 of its speed, 18 mm up.
TEST(Seams, OfTwoTilesAreNotNoticed) {
  for (const Tiles tiles : {Tiles::kModels, Tiles::kBoxes}) {
    for (const double rate : kRates) {
      for (const double speed : {0.3, 1.0, 3.0}) {
        if (rate > 500.0 && speed < 0.5) continue;  // takes long
        for (const double heading : {0.0, 0.5}) {
          for (const bool is_reversed : {false, true}) {
            Seamless world;
            const double first = is_reversed ? 0.5 : -0.5;
            add_tile(world, tiles, {first * kTile, 0, 0});
            add_tile(world, tiles, {-first * kTile, 0, 0});
            expect_unnoticed(world, rate, speed, heading, 0.3);
          }
        }
      }
    }
  }
}

TEST(Seams, OfFourTilesAreNotNoticed) {
  for (const Tiles tiles : {Tiles::kModels, Tiles::kBoxes}) {
    for (const double rate : kRates) {
      for (const double heading : {0.17, 0.785}) {
        Seamless world;
        for (const double x : {-0.5, 0.5}) {
          for (const double y : {-0.5, 0.5}) add_tile(world, tiles, {x * kTile, y * kTile, 0});
        }
        expect_unnoticed(world, rate, 1.0, heading, 0.0);
      }
    }
  }
}

TEST(Seams, OfCompoundsAreNotNoticed) {
  for (const double rate : kRates) {
    Seamless world;
    for (const double x : {-0.5, 0.5}) {
      auto& compound = world.make<btCompoundShape>();
      btTransform down = btTransform::getIdentity();
      down.setOrigin(to_bullet(Vec3{0, 0, -kHalfTile.z}));
      compound.addChildShape(down, &world.make<btBoxShape>(to_bullet(kHalfTile)));
      world.add(compound, 0, {{}, {x * kTile, 0, 0}});
    }
    expect_unnoticed(world, rate, 1.0, 0.1, 0.0);
  }
}

TEST(Seams, LetTilesDifferInHeightByATenthOfAMillimeter) {
  for (const double rate : kRates) {
    for (const double step : {1e-6, 1e-4}) {
      Seamless world;
      add_tile(world, Tiles::kBoxes, {-0.5 * kTile, 0, 0});
      add_tile(world, Tiles::kBoxes, {0.5 * kTile, 0, step});
      expect_unnoticed(world, rate, 1.0, 0.1, 0.0);
    }
  }
}

TEST(Seams, AreNotStepsOfTwoMillimeters) {
  for (const Tiles tiles : {Tiles::kModels, Tiles::kBoxes}) {
    for (const double rate : kRates) {
      Seamless world;
      add_tile(world, tiles, {-0.5 * kTile, 0, 0});
      add_tile(world, tiles, {0.5 * kTile, 0, 0.002});
      const btRigidBody& cube = push_cube(world, rate, 1.0, 0.0);
      world.step(static_cast<int>(0.2 * rate), 1.0 / rate);
      EXPECT_LT(cube.getLinearVelocity().x(), 0.5) << rate << " Hz";
    }
  }
}

// As high as the ground's end, below the ground, and with its foot at the ground's level.
TEST(Seams, AreNotWalls) {
  for (const double foot : {-0.05, 0.0}) {
    for (const double rate : kRates) {
      Seamless world;
      add_tile(world, Tiles::kModels, {0, 0, 0});
      const Vec3 half{0.05, 0.2, 0.1};
      world.add(world.make<btBoxShape>(to_bullet(half)), 0,
                {{}, {0.5 * kTile + half.x, 0, foot + half.z}});
      btRigidBody& cube = push_cube(world, rate, 1.0, 0.0);
      world.step(static_cast<int>(0.5 * rate), 1.0 / rate);
      EXPECT_LT(cube.getWorldTransform().getOrigin().x(), 0.5 * kTile - kHalf + 1e-3);
      EXPECT_NEAR(cube.getLinearVelocity().x(), 0.0, 0.01);
      EXPECT_NEAR(height(cube), kHalf, 3e-4);
    }
  }
}

/// The contacts of a cube in front of the second of two tiles, sideways ones only.
std::size_t count_sideways(double gap, bool is_corrected) {
  WorldOf<btDiscreteDynamicsWorld, btSequentialImpulseConstraintSolver> world;
  add_tile(world, Tiles::kBoxes, {-0.5 * kTile, 0, 0});
  add_tile(world, Tiles::kBoxes, {0.5 * kTile + gap, 0, 0});
  btRigidBody& cube = world.add_model(cube_model(), 1, {{}, {-kHalf + gap - 0.003, 0, kHalf}});
  cube.setLinearVelocity(btVector3(1, 0, 0));
  world.world.getDispatchInfo().m_timeStep = scalar(1.0 / 60.0);
  world.world.performDiscreteCollisionDetection();
  Seams seams;
  if (is_corrected) seams.correct(world.dispatcher, 1.0 / 60.0);
  return static_cast<std::size_t>(std::ranges::count_if(world.points(), [](const auto* point) {
    return std::abs(point->m_normalWorldOnB.x()) > scalar(0.9);
  }));
}

TEST(Seams, MayBeWideGaps) {
  const std::size_t at_seam = count_sideways(0.0, false);
  ASSERT_GT(at_seam, 0u);
  EXPECT_EQ(count_sideways(0.0, true), 0u);
  const std::size_t at_gap = count_sideways(0.005, false);
  ASSERT_GT(at_gap, 0u);
  // A body that is flush with the faces on both sides passes. The rest are guards.
  EXPECT_LT(count_sideways(0.005, true), at_gap / 2);
}

TEST(Seams, OfOneBodyWithAnotherChangeNothing) {
  WorldOf<btDiscreteDynamicsWorld, btSequentialImpulseConstraintSolver> world;
  add_tile(world, Tiles::kModels, {0, 0, 0});
  world.add_model(cube_model(), 1, {{}, {0.5 * kTile, 0, kHalf - 0.001}});
  world.world.performDiscreteCollisionDetection();
  const auto normals = [&] {
    std::vector<btVector3> all;
    for (const btManifoldPoint* point : world.points()) all.push_back(point->m_normalWorldOnB);
    return all;
  };
  const auto before = normals();
  ASSERT_FALSE(before.empty());
  Seams().correct(world.dispatcher, 1.0 / 60.0);
  EXPECT_EQ(normals(), before);
}

TEST(Seams, GiveTheSameBitsInEveryRun) {
  const auto run = [] {
    Seamless world;
    for (const double x : {-0.5, 0.5}) add_tile(world, Tiles::kModels, {x * kTile, 0, 0});
    const btRigidBody& cube = push_cube(world, 60.0, 1.0, 0.2, 0.4);
    world.step(15, 1.0 / 60.0);
    return cube.getWorldTransform();
  };
  EXPECT_EQ(run(), run());
}

// The faces in front of three bricks are in one plane, and contacts at its corners were taken for
// those of a seam there: an upper brick sank by 0.1 mm between two lower ones.
TEST(Seams, FlushBricksCarryAnotherByTheirCorners) {
  Seamless world;
  const auto brick = build_by_tolerance({0.1, 0.05, 0.03});
  world.add_model(tile_model(), 0, {{}, {0, 0, -kHalfTile.z}});
  std::vector<btRigidBody*> bricks;
  for (const Vec3& at : {Vec3{-0.1, 0, 0.03}, Vec3{0.1, 0, 0.03}, Vec3{0, 0, 0.09}}) {
    bricks.push_back(&world.add_model(brick, 1, {{}, at}));
    bricks.back()->setActivationState(DISABLE_DEACTIVATION);
  }
  world.step(1, 1.0 / 200.0);
  int carrying = 0;
  for (int i = 0; i < world.dispatcher.getNumManifolds(); ++i) {
    const btPersistentManifold& manifold = *world.dispatcher.getManifoldByIndexInternal(i);
    if (manifold.getBody0() != bricks[2] && manifold.getBody1() != bricks[2]) continue;
    carrying += manifold.getNumContacts();
  }
  EXPECT_EQ(carrying, 8);
  world.step(100, 1.0 / 200.0);
  EXPECT_NEAR(height(*bricks[2]), 0.09, 5e-6);
}

}  // namespace
}  // namespace voxshell::bullet::seams_test
