#include "resting_patch.h"

#include <array>

#include <gtest/gtest.h>

namespace voxshell::bullet::resting_patch_test {
namespace {

constexpr double kBand = 1e-4;

Contact contact(std::uint32_t id, float depth) { return {id, depth, {}, {}}; }

TEST(RestingPatch, TakesPointsWithinTheBandAsNearAsTheNearest) {
  RestingPatch patch;
  std::array contacts{contact(1, -5e-5f), contact(4, 2e-6f), contact(9, -2e-4f)};
  patch.settle(contacts, {}, 0.0, kBand);
  EXPECT_EQ(contacts[0].depth, 0.0f);
  EXPECT_EQ(contacts[1].depth, 2e-6f);   // in touch: as it is
  EXPECT_EQ(contacts[2].depth, -2e-4f);  // beyond the band
}

TEST(RestingPatch, LeavesTheNearestItsGap) {
  RestingPatch patch;
  std::array contacts{contact(1, -3e-5f), contact(4, -2e-5f)};
  patch.settle(contacts, {}, 0.0, kBand);
  EXPECT_NEAR(contacts[0].depth, -2e-5f, 1e-10);
  EXPECT_EQ(contacts[1].depth, -2e-5f);
}

TEST(RestingPatch, CountsMarginsAsPartOfTheBodies) {
  RestingPatch patch;
  std::array contacts{contact(1, -0.00105f), contact(4, -0.001f)};
  patch.settle(contacts, {}, 0.001, kBand);
  EXPECT_NEAR(contacts[0].depth, -0.001f, 1e-9);
}

TEST(RestingPatch, PullsPointsBackToWhereTheyHeld) {
  RestingPatch patch;
  std::array first{contact(1, -5e-5f), contact(4, 0.0f)};
  patch.settle(first, {}, 0.0, kBand);
  std::array tipped{contact(1, -4e-5f), contact(4, 0.0f)};
  patch.settle(tipped, {}, 0.0, kBand);
  EXPECT_NEAR(tipped[0].depth, 1e-5f,
              2e-7);  // has come 10 um nearer, of which it forgets a hundredth
}

TEST(RestingPatch, KnowsPointsAgainAmongOthers) {
  RestingPatch patch;
  std::array first{contact(1, -5e-5f), contact(4, 0.0f), contact(9, -3e-5f), contact(12, -3e-5f)};
  patch.settle(first, {}, 0.0, kBand);
  std::array tipped{contact(4, 0.0f), contact(6, -2e-5f), contact(9, -2e-5f)};
  patch.settle(tipped, {}, 0.0, kBand);
  EXPECT_EQ(tipped[0].depth, 0.0f);
  EXPECT_EQ(tipped[1].depth, 0.0f);
  EXPECT_NEAR(tipped[2].depth, 1e-5f, 2e-7);
}

TEST(RestingPatch, HoldsForAWhileBeyondTheBand) {
  for (const auto& [gap, holds] : {std::pair(-1.9e-4f, true), std::pair(-2.1e-4f, false)}) {
    RestingPatch patch;
    std::array first{contact(1, -9.9e-5f), contact(4, 0.0f)};
    patch.settle(first, {}, 0.0, kBand);
    std::array tipped{contact(1, gap), contact(4, 0.0f)};
    patch.settle(tipped, {}, 0.0, kBand);
    if (holds) {
      EXPECT_NEAR(tipped[0].depth, -9e-5f, 1e-6);  // its lift stays within the band
    } else {
      EXPECT_EQ(tipped[0].depth, gap);
    }
  }
}

TEST(RestingPatch, ForgetsPointsThatCarryNothingAndBodiesThatMove) {
  RestingPatch patch;
  const auto tip = [&] {
    std::array tipped{contact(1, -4e-5f), contact(4, 0.0f)};
    patch.settle(tipped, {}, 0.0, kBand);
    return tipped[0].depth;
  };
  std::array first{contact(1, -5e-5f), contact(4, 0.0f)};
  patch.settle(first, {}, 0.0, kBand);
  patch.keep(std::array{contact(4, 0.0f)});
  EXPECT_EQ(tip(), 0.0f);

  first = {contact(1, -5e-5f), contact(4, 0.0f)};
  patch.settle(first, {}, 0.0, kBand);
  patch.release();
  EXPECT_EQ(tip(), 0.0f);
}

}  // namespace
}  // namespace voxshell::bullet::resting_patch_test
