#include "voxshell/pair.h"

#include <string>

#include <gtest/gtest.h>

#include "support/pairs.h"

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

}  // namespace
}  // namespace voxshell
