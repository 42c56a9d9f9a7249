#include "voxshell/pair.h"

#include <string>

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "support/pairs.h"
#include "support/random.h"

namespace voxshell {
namespace {

using namespace test_support;

void expect_refused(const Result<PairBody>& chosen, const std::string& reason) {
  ASSERT_FALSE(chosen) << "accepted, but expected: " << reason;
  EXPECT_EQ(chosen.error().code, ErrorCode::kInvalidArgument);
  EXPECT_NE(chosen.error().message.find(reason), std::string::npos) << chosen.error().message;
}

TEST(ChooseShell, AutomaticTakesTheBodyWithFewerPointsAndAOfEquals) {
  const PointShell few = make_shell(make_box({1, 1, 1}), 0.5);
  const PointShell many = make_shell(make_box({1, 1, 1}), 0.25);
  const Field field = SphereField{};
  ASSERT_LT(few.size(), many.size());
  EXPECT_EQ(*choose_shell({&field, &few}, {&field, &many}, ShellChoice::kAutomatic), PairBody::kA);
  EXPECT_EQ(*choose_shell({&field, &many}, {&field, &few}, ShellChoice::kAutomatic), PairBody::kB);
  EXPECT_EQ(*choose_shell({&field, &few}, {&field, &few}, ShellChoice::kAutomatic), PairBody::kA);
}

TEST(ChooseShell, AutomaticTakesTheFinerOneWhereItFitsBetweenThePointsOfTheOther) {
  const Field cube = make_grid(make_box({0.25, 0.25, 0.25}), 0.02);
  const PointShell on_cube = make_shell(make_box({0.25, 0.25, 0.25}), 0.02);
  const auto takes_the_cube = [&](const Soup& mesh, double spacing) {
    const Field ground = make_grid(mesh, spacing);
    const PointShell on_ground = make_shell(mesh, spacing);
    EXPECT_LT(on_ground.size(), on_cube.size());
    const Participant fine{&cube, &on_cube};
    const Participant coarse{&ground, &on_ground};
    const bool is_cube = *choose_shell(fine, coarse, ShellChoice::kAutomatic) == PairBody::kA;
    EXPECT_EQ(*choose_shell(coarse, fine, ShellChoice::kAutomatic) == PairBody::kB, is_cube);
    return is_cube;
  };
  EXPECT_TRUE(takes_the_cube(make_box({5, 5, 1}), 0.8));
  EXPECT_FALSE(takes_the_cube(make_box({1, 1, 0.5}), 0.2));
}

TEST(ChooseShell, AutomaticTakesTheOneThatHasAShell) {
  const PointShell shell = make_shell(make_box({1, 1, 1}), 0.5);
  const Field field = SphereField{};
  EXPECT_EQ(*choose_shell({&field, &shell}, {&field}, ShellChoice::kAutomatic), PairBody::kA);
  EXPECT_EQ(*choose_shell({&field}, {&field, &shell}, ShellChoice::kAutomatic), PairBody::kB);
}

TEST(ChooseShell, TakesTheBodyAskedFor) {
  const PointShell few = make_shell(make_box({1, 1, 1}), 0.5);
  const PointShell many = make_shell(make_box({1, 1, 1}), 0.25);
  const Field field = SphereField{};
  EXPECT_EQ(*choose_shell({&field, &many}, {&field, &few}, ShellChoice::kA), PairBody::kA);
  EXPECT_EQ(*choose_shell({&field, &few}, {&field, &many}, ShellChoice::kB), PairBody::kB);
}

TEST(ChooseShell, RefusesABodyWithoutShell) {
  const PointShell shell = make_shell(make_box({1, 1, 1}), 0.5);
  const Field field = SphereField{};
  expect_refused(choose_shell({&field}, {&field, &shell}, ShellChoice::kA), "body a has no");
  expect_refused(choose_shell({&field, &shell}, {&field}, ShellChoice::kB), "body b has no");
  expect_refused(choose_shell({&field}, {&field}, ShellChoice::kAutomatic), "neither body");
}

TEST(Enclosed, IsAShellInsideTheOthersField) {
  const Field ball = SphereField{0.2};
  const Field box = BoxField{{1, 1, 1}};
  const PointShell on_ball = make_shell(make_icosphere(0.2, 2), 0.02);
  const PointShell on_box = make_shell(make_box({1, 1, 1}), 0.25);
  const Participant inner{&ball, &on_ball};
  const Participant outer{&box, &on_box};
  Random random(140);
  for (int i = 0; i < 100; ++i) {
    const Pose inside{random.rotation(), random.in_cube(0.79)};
    EXPECT_TRUE(is_enclosed(inner, outer, inside));
    EXPECT_FALSE(is_enclosed(outer, inner, inside.inverse()));
    const Pose outside{random.rotation(), 2.2 * random.direction()};
    EXPECT_FALSE(is_enclosed(inner, outer, outside));
  }
  // On the surface is not inside.
  const Pose shifted{{}, Vec3{1, 0, 0} - static_cast<Vec3>(on_ball.points()[0])};
  EXPECT_FALSE(is_enclosed(inner, outer, shifted));
}

TEST(Enclosed, NeedsTwoShells) {
  const Field ball = SphereField{0.2};
  const Field box = BoxField{{1, 1, 1}};
  const PointShell shell = make_shell(make_icosphere(0.2, 1), 0.1);
  EXPECT_FALSE(is_enclosed({&ball}, {&box, &shell}, {}));
  EXPECT_FALSE(is_enclosed({&ball, &shell}, {&box}, {}));
  EXPECT_TRUE(is_enclosed({&ball, &shell}, {&box, &shell}, {}));
}

}  // namespace
}  // namespace voxshell
