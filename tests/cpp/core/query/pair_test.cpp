#include "voxshell/pair.h"

#include <cmath>
#include <string>
#include <variant>

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "support/pairs.h"
#include "support/random.h"

namespace voxshell::pair_test {
namespace {

using namespace test_support;

void expect_refused(const Result<PairRole>& decided, const std::string& reason) {
  ASSERT_FALSE(decided) << "accepted, but expected: " << reason;
  EXPECT_EQ(decided.error().code, ErrorCode::kInvalidArgument);
  EXPECT_NE(decided.error().message.find(reason), std::string::npos) << decided.error().message;
}

Role role_of(const Participant& a, const Participant& b, ShellChoice choice) {
  return decide_role(a, b, choice)->role;
}

TEST(Fewest, IsTheBodyWithFewerPointsAndAOfEquals) {
  const PointShell few = make_shell(make_box({1, 1, 1}), 0.5);
  const PointShell many = make_shell(make_box({1, 1, 1}), 0.25);
  const Field field = SphereField{};
  ASSERT_LT(few.size(), many.size());
  EXPECT_EQ(role_of({&field, &few}, {&field, &many}, ShellChoice::kFewest), Role::kA);
  EXPECT_EQ(role_of({&field, &many}, {&field, &few}, ShellChoice::kFewest), Role::kB);
  EXPECT_EQ(role_of({&field, &few}, {&field, &few}, ShellChoice::kFewest), Role::kA);
}

TEST(Fewest, IsTheFinerOneWhereItFitsBetweenThePointsOfTheOther) {
  const Field cube = make_grid(make_box({0.25, 0.25, 0.25}), 0.02);
  const PointShell on_cube = make_shell(make_box({0.25, 0.25, 0.25}), 0.02);
  const auto takes_the_cube = [&](const Soup& mesh, double spacing) {
    const Field ground = make_grid(mesh, spacing);
    const PointShell on_ground = make_shell(mesh, spacing);
    EXPECT_LT(on_ground.size(), on_cube.size());
    const Participant fine{&cube, &on_cube};
    const Participant coarse{&ground, &on_ground};
    const bool is_cube = role_of(fine, coarse, ShellChoice::kFewest) == Role::kA;
    EXPECT_EQ(role_of(coarse, fine, ShellChoice::kFewest) == Role::kB, is_cube);
    return is_cube;
  };
  EXPECT_TRUE(takes_the_cube(make_box({5, 5, 1}), 0.8));
  EXPECT_FALSE(takes_the_cube(make_box({1, 1, 0.5}), 0.2));
}

TEST(Role, IsOfTheOneThatHasAShell) {
  const PointShell shell = make_shell(make_box({1, 1, 1}), 0.5);
  const Field field = SphereField{};
  for (const ShellChoice choice : {ShellChoice::kAutomatic, ShellChoice::kFewest}) {
    EXPECT_EQ(role_of({&field, &shell}, {&field}, choice), Role::kA);
    EXPECT_EQ(role_of({&field}, {&field, &shell}, choice), Role::kB);
  }
}

TEST(Role, IsOfTheBodyAskedFor) {
  const PointShell few = make_shell(make_box({1, 1, 1}), 0.5);
  const PointShell many = make_shell(make_box({1, 1, 1}), 0.25);
  const Field field = SphereField{};
  EXPECT_EQ(role_of({&field, &many}, {&field, &few}, ShellChoice::kA), Role::kA);
  EXPECT_EQ(role_of({&field, &few}, {&field, &many}, ShellChoice::kB), Role::kB);
  EXPECT_EQ(role_of({&field, &few}, {&field, &many}, ShellChoice::kBoth), Role::kBoth);
}

TEST(Role, RefusesABodyWithoutShell) {
  const PointShell shell = make_shell(make_box({1, 1, 1}), 0.5);
  const Field field = SphereField{};
  expect_refused(decide_role({&field}, {&field, &shell}, ShellChoice::kA), "body a has no");
  expect_refused(decide_role({&field, &shell}, {&field}, ShellChoice::kB), "body b has no");
  expect_refused(decide_role({&field}, {&field, &shell}, ShellChoice::kBoth), "body a has no");
  expect_refused(decide_role({&field}, {&field}, ShellChoice::kAutomatic), "neither body");
}

/// A body of which everything is measured to be as said.
class Measured {
 public:
  Measured(double half, double spacing, const Accuracy& accuracy)
      : field_(make_grid(make_box({half, half, half}), 0.25 * half)),
        shell_(make_shell(make_box({half, half, half}), spacing)),
        accuracy_(accuracy),
        thickness_(2.0 * half) {}

  operator Participant() const { return {&field_, &shell_, &accuracy_, thickness_}; }

 private:
  Field field_;
  PointShell shell_;
  Accuracy accuracy_;
  double thickness_;
};

Accuracy smooth(double gap) {
  return {.distance = {},
          .normal = {},
          .coverage = {},
          .gap = gap,
          .is_sharp = false,
          .curvature = 1.0};
}

Accuracy sharp(double gap) {
  Accuracy accuracy = smooth(gap);
  accuracy.is_sharp = true;
  accuracy.curvature = 0.0;
  return accuracy;
}

/// The role in both orders, which must agree.
PairRole decide(const Participant& a, const Participant& b) {
  const PairRole pair = *decide_role(a, b, ShellChoice::kAutomatic);
  const PairRole turned = *decide_role(b, a, ShellChoice::kAutomatic);
  EXPECT_EQ(pair.miss, turned.miss);
  EXPECT_EQ(pair.miss_of_a, turned.miss_of_b);
  EXPECT_EQ(pair.miss_of_b, turned.miss_of_a);
  EXPECT_EQ(pair.thickness, turned.thickness);
  EXPECT_EQ(pair.side, turned.side);
  EXPECT_EQ(pair.wall, turned.wall);
  EXPECT_EQ(pair.asks(PairBody::kA), turned.asks(PairBody::kB));
  EXPECT_EQ(pair.asks(PairBody::kB), turned.asks(PairBody::kA));
  return pair;
}

TEST(AutomaticRole, IsTheOnlyOneThatMissesLittle) {
  // What is sharp enters between the points of the other as deep as they are apart.
  const Measured fine(0.5, 0.25, sharp(0.001));
  const Measured coarse(0.5, 0.5, sharp(0.02));
  const PairRole pair = decide(fine, coarse);
  EXPECT_EQ(pair.role, Role::kA);
  EXPECT_DOUBLE_EQ(pair.miss, 0.001);
  EXPECT_DOUBLE_EQ(pair.miss_of_b, 0.02);
}

TEST(AutomaticRole, IsTheCheaperWhereBothMissLittle) {
  const Measured few(0.5, 0.5, sharp(0.002));
  const Measured many(0.5, 0.25, sharp(0.001));
  EXPECT_EQ(decide(few, many).role, Role::kA);
}

TEST(AutomaticRole, IsBothWhereNeitherIsEnough) {
  // A smooth body comes less deep between points than a sharp one.
  const Measured ball(0.5, 0.25, smooth(0.2));
  const Measured cube(0.5, 0.5, sharp(0.3));
  const PairRole pair = decide(ball, cube);
  EXPECT_EQ(pair.role, Role::kBoth);
  EXPECT_DOUBLE_EQ(pair.miss_of_a, 0.2);
  EXPECT_DOUBLE_EQ(pair.miss_of_b, 0.5 * 0.3 * 0.3);
  EXPECT_DOUBLE_EQ(pair.miss, 0.5 * 0.3 * 0.3);
}

TEST(AutomaticRole, CountsCoverageOfTheShellAndErrorOfTheField) {
  Accuracy a = sharp(0.001);
  a.coverage.worst = 0.002;
  a.distance.worst = 0.1;
  Accuracy b = sharp(0.001);
  b.coverage.worst = 0.2;
  b.distance.worst = 0.0005;
  const PairRole pair = decide(Measured(0.5, 0.25, a), Measured(0.5, 0.5, b));
  EXPECT_EQ(pair.role, Role::kA);
  EXPECT_DOUBLE_EQ(pair.miss, 0.002 + 0.0005 + 0.001);
}

TEST(AutomaticRole, IsNotOfTheLargerBodyAloneInWhichTheOtherCouldHide) {
  const Measured small(0.25, 0.05, sharp(0.0001));
  const Measured large(1.0, 0.5, sharp(0.0001));
  const PairRole pair = decide(large, small);
  ASSERT_LT(pair.miss_of_a, kMissedByOne * pair.thickness);
  EXPECT_EQ(pair.role, Role::kB);
}

TEST(AutomaticRole, MeasuresByTheSmallerBody) {
  EXPECT_EQ(decide(Measured(0.25, 0.25, sharp(0.1)), Measured(1.0, 0.5, sharp(0.1))).thickness,
            0.5);
}

TEST(AutomaticRole, NamesTheSmallerBodysSideAndTheThinnerWall) {
  const Measured small(0.25, 0.25, sharp(0.1));
  const Measured large(1.0, 0.5, sharp(0.1));
  Participant hollow = large;
  hollow.thickness = 0.01;
  const PairRole pair = decide(small, hollow);
  EXPECT_EQ(pair.thickness, 0.5);
  EXPECT_EQ(pair.side, 0.5);
  EXPECT_EQ(pair.wall, 0.01);
  Participant thin = small;
  thin.thickness = 0.02;
  EXPECT_EQ(decide(thin, large).wall, 0.02);
  EXPECT_EQ(decide(thin, large).side, 0.5);
}

TEST(AutomaticRole, TakesTheWorstCaseWhereNothingWasMeasured) {
  const Field field = make_grid(make_box({1, 1, 1}), 0.25);
  const PointShell shell = make_shell(make_box({1, 1, 1}), 0.5);
  const PairRole pair = *decide_role({&field, &shell}, {&field, &shell}, ShellChoice::kAutomatic);
  EXPECT_EQ(pair.role, Role::kBoth);
  EXPECT_GT(pair.miss_of_a, std::sqrt(3.0) * 0.5);
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

TEST(InnerContact, IsOfAPlaceInsideTheOther) {
  const Field ball = SphereField{0.2};
  const Field box = BoxField{{1, 1, 1}};
  const PointShell on_ball = make_shell(make_icosphere(0.2, 2), 0.02);
  const Vec3f middle{};
  const Participant inner{.field = &ball, .shell = &on_ball, .inner_point = &middle};
  Random random(141);
  for (int i = 0; i < 100; ++i) {
    const Pose inside{random.rotation(), random.in_cube(0.79)};
    const auto found = find_inner_contact(inner, box, inside, 0.0f);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->id, on_ball.size());
    EXPECT_EQ(found->point, middle);
    const auto at = static_cast<Vec3f>(inside.translation);
    EXPECT_FLOAT_EQ(found->depth, -std::get<BoxField>(box).distance(at));
    EXPECT_NEAR(length(static_cast<Vec3>(found->normal)), 1.0, 1e-6);
    EXPECT_FALSE(find_inner_contact(inner, box, inside, -found->depth));
    EXPECT_FALSE(find_inner_contact(inner, box, {{}, 2.2 * random.direction()}, 0.5f));
  }
  EXPECT_FALSE(find_inner_contact({&ball, &on_ball}, box, {}, 0.0f));
}

}  // namespace
}  // namespace voxshell::pair_test
