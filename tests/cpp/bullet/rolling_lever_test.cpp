#include "rolling_lever.h"

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace voxshell::bullet::rolling_lever_test {
namespace {

/// Of a still body of 0.1 m in radius: levers shorter than 1 cm count.
PairStep make_step() {
  PairStep step{};
  step.ball.radius = 0.1;
  step.is_still = true;
  step.rolls_at_rest = true;
  return step;
}

std::vector<Contact> contacts_at(const std::vector<Vec3f>& points) {
  std::vector<Contact> contacts;
  for (const Vec3f& point : points) {
    contacts.push_back({static_cast<std::uint32_t>(contacts.size()), 0.0f, point, {0, 0, 1}});
  }
  return contacts;
}

TEST(RollingLever, OfASmallPatchIsItsRadius) {
  const auto patch = contacts_at({{0, 0, 0}, {0.004f, 0, 0}, {0, 0.003f, 0}});
  EXPECT_NEAR(rolling_lever_of(make_step(), patch, {}), 0.004, 1e-6);
}

TEST(RollingLever, OfALongRowIsItsWidth) {
  const auto row = contacts_at({{0, 0, 0}, {0.05f, 0, 0}, {0.02f, 0.002f, 0}});
  EXPECT_NEAR(rolling_lever_of(make_step(), row, {}), 0.002, 1e-6);
}

TEST(RollingLever, OfAShortRowThatIsNotOfSamplesIsItsWidth) {
  const auto row = contacts_at({{0, 0, 0}, {0.004f, 0, 0}, {0.008f, 0, 0}});
  EXPECT_NEAR(rolling_lever_of(make_step(), row, {}), 0.008, 1e-6);
  EXPECT_EQ(rolling_lever_of(make_step(), row, std::vector<std::uint32_t>{0, 1, 2}), 0.0);
}

TEST(RollingLever, OfAWidePatchIsLeftToTheSolver) {
  const auto wide = contacts_at({{0, 0, 0}, {0.05f, 0, 0}, {0.02f, 0.03f, 0}});
  EXPECT_EQ(rolling_lever_of(make_step(), wide, {}), 0.0);
}

TEST(RollingLever, IsOfStillBodiesAlone) {
  const auto patch = contacts_at({{0, 0, 0}, {0.004f, 0, 0}});
  PairStep moving = make_step();
  moving.is_still = false;
  EXPECT_EQ(rolling_lever_of(moving, patch, {}), 0.0);
  PairStep refused = make_step();
  refused.rolls_at_rest = false;
  EXPECT_EQ(rolling_lever_of(refused, patch, {}), 0.0);
}

}  // namespace
}  // namespace voxshell::bullet::rolling_lever_test
