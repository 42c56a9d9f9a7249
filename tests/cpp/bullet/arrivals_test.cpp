#include "arrivals.h"

#include <cstdint>
#include <variant>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/random.h"
#include "support/two_bodies.h"
#include "support/world.h"
#include "voxshell/contacts_flat.h"

namespace voxshell::bullet::arrivals_test {
namespace {

using namespace test_support;
using voxshell::test_support::Random;

constexpr double kReach = 1e-3;

/// Whether a point of the shell is in the field, or nearly, at some time of a motion.
bool touches_on_the_way(const TwoBodies& bodies, const PairStep& step, std::uint32_t id,
                        const Motion& a, const Motion& b) {
  constexpr int kTimes = 20;
  const auto point = static_cast<Vec3>(bodies.pair.shell().points()[id]);
  for (int i = 0; i <= kTimes; ++i) {
    const Pose pose = step.field_from_shell_after(1.0 * i / kTimes, a, b);
    const auto place = static_cast<Vec3f>(pose.transform_point(point));
    const float distance =
        std::visit([&](const auto& field) { return field.distance(place); }, bodies.pair.field());
    if (static_cast<double>(distance) <= 0.0) return true;
  }
  return false;
}

TEST(Arrivals, HoldEveryPointThatTouchesAtSomeTimeOfTheStep) {
  Random random(8);
  int touching = 0;
  int arriving = 0;
  int points = 0;
  for (int i = 0; i < 60; ++i) {
    TestWorld world;
    const Pose low_pose = random.pose(0.0);
    Pose high_pose = random.pose(0.0);
    high_pose.translation = {0, 0, random.uniform(0.1, 0.2)};
    btRigidBody& low = world.add_model(torus_model(), i % 2 == 0 ? 0 : 1, low_pose);
    btRigidBody& high = world.add_model(blob_model(), 1, high_pose);
    high.setLinearVelocity(to_bullet(Vec3{0, 0, -random.uniform(1.0, 10.0)}));
    high.setAngularVelocity(to_bullet(random.uniform(0.0, 20.0) * random.direction()));
    if (i % 2 == 1) low.setLinearVelocity(to_bullet(random.uniform(0.0, 5.0) * random.direction()));
    const TwoBodies bodies(low, high);
    const PairStep step = bodies.step();
    const Arrivals arrivals(step, /*is_of_field=*/false, kReach);
    const Motion still;
    for (std::uint32_t id = 0; id < bodies.pair.shell().size(); id += 3) {
      const bool touches =
          touches_on_the_way(bodies, step, id, step.motion_a, step.motion_b) ||
          (i % 2 == 1 && (touches_on_the_way(bodies, step, id, step.motion_a, still) ||
                          touches_on_the_way(bodies, step, id, still, step.motion_b)));
      const bool arrives =
          arrives_flat(bodies.pair.field(), bodies.pair.shell(), id, arrivals.all());
      EXPECT_FALSE(touches && !arrives) << "fall " << i << ", point " << id;
      touching += touches ? 1 : 0;
      arriving += arrives ? 1 : 0;
      ++points;
    }
  }
  EXPECT_GT(touching, points / 50);
  EXPECT_LT(arriving, points / 2);
}

TEST(Arrivals, LookFromEitherSide) {
  TestWorld world;
  btRigidBody& low = world.add_model(torus_model(), 1);
  btRigidBody& high = world.add_model(blob_model(), 1, {{}, {0, 0, 0.2}});
  high.setLinearVelocity({0, 0, -5});
  const TwoBodies bodies(low, high);
  const PairStep step = bodies.step();
  const Arrivals first(step, false, kReach);
  const Arrivals second(step, true, kReach);
  ASSERT_EQ(first.all().size(), second.all().size());
  for (std::size_t i = 0; i < first.all().size(); ++i) {
    const Vec3 place{0.1, 0.2, 0.3};
    const Vec3 there = second.all()[i].field_from_shell.transform_point(
        first.all()[i].field_from_shell.transform_point(place));
    EXPECT_LT(length(there - place), 1e-9);
    EXPECT_EQ(first.all()[i].margin, second.all()[i].margin);
  }
}

}  // namespace
}  // namespace voxshell::bullet::arrivals_test
