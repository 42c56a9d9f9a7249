#include "failed_slides.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "contact_constants.h"

namespace voxshell::bullet::failed_slides_test {
namespace {

constexpr double kRadius = 0.05;
constexpr double kFar = kFailsAgainOfRadius * kRadius;
constexpr std::uint32_t kFailed = 7;

const std::vector<Contact> kContacts{{kFailed, 0.0f, {0.02f, 0.0f, 0.0f}, {0.0f, 0.0f, 1.0f}}};

Pose turned_about_z(double angle) {
  Pose pose;
  pose.rotation.row_x = {std::cos(angle), -std::sin(angle), 0.0};
  pose.rotation.row_y = {std::sin(angle), std::cos(angle), 0.0};
  return pose;
}

/// Of a slide that failed at the origin.
FailedSlides failed_at_origin() {
  FailedSlides slides;
  slides.begin(kContacts, {}, kRadius, /*forgets=*/true);
  slides.add(kFailed);
  return slides;
}

bool fails_again_at(const Pose& pose, bool forgets = false) {
  FailedSlides slides = failed_at_origin();
  slides.begin(kContacts, pose, kRadius, forgets);
  return slides.fails_again(kFailed);
}

TEST(FailedSlides, FailAgainWhereTheBodiesAre) {
  EXPECT_TRUE(fails_again_at({}));
  EXPECT_TRUE(fails_again_at({{}, {0.9 * kFar, 0, 0}}));
  EXPECT_TRUE(fails_again_at(turned_about_z(0.5 * kFailsAgainOfRadius)));
}

TEST(FailedSlides, AreTriedOnceTheBodiesHaveMoved) {
  EXPECT_FALSE(fails_again_at({{}, {1.1 * kFar, 0, 0}}));
  EXPECT_FALSE(fails_again_at(turned_about_z(1.1 * kFailsAgainOfRadius)));
}

TEST(FailedSlides, AreForgottenWithTheirSurfaces) {
  EXPECT_FALSE(fails_again_at({}, /*forgets=*/true));
}

TEST(FailedSlides, AreOfTheirElementsAlone) {
  FailedSlides slides = failed_at_origin();
  slides.begin(kContacts, {}, kRadius, /*forgets=*/false);
  EXPECT_FALSE(slides.fails_again(kFailed + 1));
}

TEST(FailedSlides, CountMotionFromWhereTheyFailed) {
  FailedSlides slides = failed_at_origin();
  int steps = 0;
  Pose pose;
  do {
    pose.translation.x += 0.3 * kFar;
    slides.begin(kContacts, pose, kRadius, /*forgets=*/false);
    ++steps;
  } while (slides.fails_again(kFailed) && steps < 10);
  EXPECT_EQ(steps, 4);
}

}  // namespace
}  // namespace voxshell::bullet::failed_slides_test
