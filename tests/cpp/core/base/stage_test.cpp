#include "base/stage.h"

#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

namespace voxshell::stage_test {
namespace {

TEST(Stage, ReportsTheFirstFractionAndTheEndButNotEveryFractionBetween) {
  std::vector<double> reported;
  const Progress progress = [&](std::string_view name, double fraction) {
    EXPECT_EQ(name, "work");
    reported.push_back(fraction);
    return true;
  };
  Stage stage(progress, "work");
  constexpr int kSteps = 10'000;
  for (int i = 0; i <= kSteps; ++i) stage.report(static_cast<double>(i) / kSteps);
  ASSERT_GE(reported.size(), 2u);
  EXPECT_EQ(reported.front(), 0.0);
  EXPECT_EQ(reported.back(), 1.0);
  EXPECT_LT(reported.size(), 1000u);
  EXPECT_FALSE(stage.stopped());
}

TEST(Stage, CountsFractionsWithinThePartThatIsSet) {
  std::vector<double> reported;
  const Progress progress = [&](std::string_view, double fraction) {
    reported.push_back(fraction);
    return true;
  };
  Stage stage(progress, "work");
  stage.set_part(0.5, 0.75);
  stage.report(1.0);
  stage.set_part(0.75, 1.0);
  stage.report(1.0);
  EXPECT_EQ(reported, (std::vector<double>{0.75, 1.0}));
}

TEST(Stage, StopsForGoodAndAsksNoMore) {
  int calls = 0;
  const Progress progress = [&](std::string_view, double) {
    ++calls;
    return false;
  };
  Stage stage(progress, "work");
  EXPECT_FALSE(stage.stopped());
  for (int i = 0; i < 3; ++i) stage.report(1.0);
  EXPECT_TRUE(stage.stopped());
  EXPECT_EQ(calls, 1);
}

TEST(Stage, RunsWithoutAnybodyWhoWatches) {
  const Progress nobody;
  Stage stage(nobody, "work");
  stage.report(1.0);
  EXPECT_FALSE(stage.stopped());
}

}  // namespace
}  // namespace voxshell::stage_test
