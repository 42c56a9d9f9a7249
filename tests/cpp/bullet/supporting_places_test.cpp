#include "supporting_places.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace voxshell::bullet::supporting_places_test {
namespace {

constexpr Vec3 kUp{0, 0, 1};
constexpr double kAside = 1e-3;  // meters

SupportingPlaces corners_of_square() {
  SupportingPlaces places;
  for (const double x : {-0.1, 0.1}) {
    for (const double y : {-0.1, 0.1}) places.now.push_back({{x, y, 0}, kUp, 0.0});
  }
  return places;
}

bool can_support(SupportingPlaces places, std::vector<SupportingPlace> before) {
  places.before = std::move(before);
  return places.can_support(kAside);
}

TEST(SupportingPlaces, SupportWhatTheySpan) {
  for (int i = 0; i < 100; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 100;
    const double to_side = 0.1 / std::max(std::abs(std::cos(angle)), std::abs(std::sin(angle)));
    const auto at = [&](double distance) {
      return std::vector<SupportingPlace>{
          {{distance * std::cos(angle), distance * std::sin(angle), 0.03}, kUp, 2.0}};
    };
    EXPECT_TRUE(can_support(corners_of_square(), at(0.999 * to_side))) << angle;
    EXPECT_TRUE(can_support(corners_of_square(), at(to_side + 0.9 * kAside))) << angle;
    EXPECT_FALSE(can_support(corners_of_square(), at(to_side + 2.0 * kAside))) << angle;
  }
}

TEST(SupportingPlaces, SupportWhatPushedInTheirMiddle) {
  // Each of the two is outside.
  EXPECT_TRUE(
      can_support(corners_of_square(), {{{-0.3, 0, 0}, kUp, 1.0}, {{0.3, 0, 0}, kUp, 1.0}}));
  EXPECT_FALSE(
      can_support(corners_of_square(), {{{-0.3, 0, 0}, kUp, 1.0}, {{0.3, 0, 0}, kUp, 3.0}}));
}

TEST(SupportingPlaces, InARowSupportWhatIsOnIt) {
  SupportingPlaces row;
  for (const double x : {-0.1, 0.0, 0.1}) row.now.push_back({{x, 0.5 * x, 0}, kUp, 0.0});
  EXPECT_TRUE(can_support(row, {{{0.06, 0.03, 0}, kUp, 1.0}}));
  EXPECT_FALSE(can_support(row, {{{0.06, 0.04, 0}, kUp, 1.0}}));
  EXPECT_FALSE(can_support(row, {{{0.12, 0.06, 0}, kUp, 1.0}}));
}

TEST(SupportingPlaces, SupportInEachDirection) {
  const Vec3 left{-0.8, 0, 0.6};
  const Vec3 right{0.8, 0, 0.6};
  SupportingPlaces groove;
  groove.now = {{{0.1, 0, 0}, left, 0.0}};
  EXPECT_TRUE(can_support(groove, {{{0.1, 0, 0}, left, 1.0}}));
  EXPECT_FALSE(can_support(groove, {{{0.1, 0, 0}, left, 1.0}, {{-0.1, 0, 0}, right, 1.0}}));
  groove.now.push_back({{-0.1, 0, 0}, right, 0.0});
  EXPECT_TRUE(can_support(groove, {{{0.1, 0, 0}, left, 1.0}, {{-0.1, 0, 0}, right, 1.0}}));
  // What pushed by a twentieth of the rest supports nothing.
  EXPECT_TRUE(can_support(groove, {{{0.1, 0, 0}, left, 1.0}, {{0.5, 0, 0}, kUp, 0.05}}));
}

TEST(SupportingPlaces, NothingIsSupportedByNoPlaces) {
  EXPECT_TRUE(can_support({}, {}));
  EXPECT_FALSE(can_support({}, {{{0, 0, 0}, kUp, 1.0}}));
}

}  // namespace
}  // namespace voxshell::bullet::supporting_places_test
