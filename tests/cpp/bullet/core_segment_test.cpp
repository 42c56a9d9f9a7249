#include "core_segment.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <variant>
#include <vector>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/random.h"
#include "support/two_bodies.h"

namespace voxshell::bullet::core_segment_test {
namespace {

using namespace test_support;
using voxshell::test_support::Random;

constexpr double kThin = 0.001;       // radius or half side, meters
constexpr double kHalfLength = 0.25;  // longer than the cube's diagonal
constexpr double kHalfVoxel = 0.005;  // of cube_model()

using MakeShape = std::function<btConvexShape&(TestWorld&)>;

/// Long and thin, each along z.
std::vector<MakeShape> rods() {
  return {
      [](TestWorld& world) -> btConvexShape& {
        return world.make<btCapsuleShapeZ>(scalar(kThin), scalar(2 * kHalfLength));
      },
      [](TestWorld& world) -> btConvexShape& {
        return world.make<btCylinderShapeZ>(
            btVector3(scalar(kThin), scalar(kThin), scalar(kHalfLength)));
      },
      [](TestWorld& world) -> btConvexShape& {
        return world.make<btConeShapeZ>(scalar(kThin), scalar(2 * kHalfLength));
      },
      [](TestWorld& world) -> btConvexShape& {
        return world.make<btBoxShape>(
            btVector3(scalar(kThin), scalar(2 * kThin), scalar(kHalfLength)));
      },
  };
}

/// A pose in which z leads through the middle of two faces of the cube, a little aslant.
Pose through_faces(Random& random) {
  const Vec3 z = normalized(Vec3{random.uniform(-0.2, 0.2), random.uniform(-0.2, 0.2), 1.0});
  const Vec3 x = normalized(cross({0, 1, 0}, z));
  const Vec3 y = cross(z, x);
  return {{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}},
          {random.uniform(-0.03, 0.03), random.uniform(-0.03, 0.03), 0.0}};
}

TEST(CoreSegment, LiesInItsShapeWithItsBalls) {
  for (const MakeShape& make : rods()) {
    TestWorld world;
    const btRigidBody& cube = world.add_model(cube_model(), 0.0);
    const btRigidBody& rod = world.add(make(world), 1.0);
    const TwoBodies bodies(cube, rod);
    const auto core = core_segment_of(bodies.pair.field_side());
    ASSERT_TRUE(core);
    EXPECT_GT(length(core->to - core->from), 1.9 * kHalfLength);
    for (const double fraction : {0.0, 0.5, 1.0}) {
      const Vec3 place = core->from + fraction * (core->to - core->from);
      const double distance = std::visit(
          [&](const auto& field) {
            return static_cast<double>(field.distance(static_cast<Vec3f>(place)));
          },
          bodies.pair.field());
      EXPECT_LE(distance, -core->radius + 1e-6);
    }
    EXPECT_FALSE(core_segment_of(bodies.pair.shell_side()));
  }
}

TEST(CoreSegment, PiercesAtEveryPlaceOfAFace) {
  Random random(1);
  for (const MakeShape& make : rods()) {
    for (int i = 0; i < 50; ++i) {
      TestWorld world;
      const btRigidBody& cube = world.add_model(cube_model(), 0.0);
      const Pose pose = through_faces(random);
      const btRigidBody& rod = world.add(make(world), 1.0, pose);
      const TwoBodies bodies(cube, rod);
      const auto contact = find_piercing(bodies.pair, bodies.pair.field_from_shell(), 0.0);
      ASSERT_TRUE(contact);
      // The middle of the rod is as far inside as the nearest side of the cube is away.
      const double nearest =
          kCubeHalf - std::max(std::abs(pose.translation.x), std::abs(pose.translation.y));
      EXPECT_GT(static_cast<double>(contact->depth), nearest - kHalfVoxel);
      EXPECT_NEAR(static_cast<double>(length(static_cast<Vec3>(contact->normal))), 1.0, 1e-3);
      EXPECT_FALSE(find_piercing(bodies.pair, bodies.pair.field_from_shell(), 0.2));
    }
  }
}

TEST(CoreSegment, DoesNotPierceWhatIsBesideIt) {
  for (const MakeShape& make : rods()) {
    TestWorld world;
    const btRigidBody& cube = world.add_model(cube_model(), 0.0);
    const btRigidBody& rod = world.add(make(world), 1.0, {{}, {kCubeHalf + 1e-4, 0, 0}});
    const TwoBodies bodies(cube, rod);
    EXPECT_FALSE(find_piercing(bodies.pair, bodies.pair.field_from_shell(), 0.0));
  }
}

TEST(CoreSegment, BodiesThatPierceAModelLeaveItBySteps) {
  Random random(2);
  const auto cube = build_by_tolerance({kCubeHalf, kCubeHalf, kCubeHalf});
  for (const MakeShape& make : rods()) {
    TestWorld world({}, {});
    const btRigidBody& block = world.add_model(cube, 0.0);
    const btRigidBody& rod = world.add(make(world), 1.0, through_faces(random));
    EXPECT_TRUE(find_piercing(TwoBodies(block, rod).pair,
                              TwoBodies(block, rod).pair.field_from_shell(), 1e-3));
    world.step(400);
    const TwoBodies after(block, rod);
    EXPECT_FALSE(find_piercing(after.pair, after.pair.field_from_shell(), 1e-3));
  }
}

}  // namespace
}  // namespace voxshell::bullet::core_segment_test
