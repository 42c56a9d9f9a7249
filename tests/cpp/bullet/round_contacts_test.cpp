#include "round_contacts.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "support/models.h"
#include "voxshell/box_field.h"
#include "voxshell/contacts.h"
#include "voxshell/plane_field.h"

namespace voxshell::bullet::round_contacts_test {
namespace {

using namespace test_support;
using voxshell::test_support::make_box;
using voxshell::test_support::make_cylinder;
using voxshell::test_support::make_icosphere;

constexpr double kMargin = 2e-4;
constexpr float kReach = 2e-3f;

std::shared_ptr<const Model> fine(const Soup& soup) {
  static constexpr double kTolerance = 1e-4;
  return *Model::build(soup.mesh(), {.tolerance = kTolerance, .threads = 1});
}

/// What of a body touches the half-space below z = 0.
std::vector<Contact> touching(const Model& model, const Pose& plane_from_body) {
  static const Field plane = PlaneField{{0, 0, 1}, 0.0};
  QueryScratch scratch;
  const auto found =
      find_contacts(plane, model.shell(), plane_from_body, {.margin = kReach}, scratch);
  return {found.begin(), found.end()};
}

void slide(RoundContacts& round, std::vector<Contact>& contacts, const Model& model,
           const Pose& plane_from_body, const Turning& turning = {}) {
  const Field plane = PlaneField{{0, 0, 1}, 0.0};
  round.slide(contacts, model, SmoothField(plane), plane_from_body, {0.1, kMargin, 0.0}, turning,
              -kReach);
}

Pose lying(double angle, double height) {
  return {
      {{1, 0, 0}, {0, std::cos(angle), -std::sin(angle)}, {0, std::sin(angle), std::cos(angle)}},
      {0, 0, height}};
}

TEST(RoundContacts, OfABallAreOneBelowItsMiddle) {
  const auto ball = fine(make_icosphere(0.1, 4));
  for (double angle = 0.0; angle < 1.5; angle += 0.07) {
    const Pose pose = lying(angle, 0.1);
    auto contacts = touching(*ball, pose);
    ASSERT_GT(contacts.size(), 3u);
    RoundContacts round;
    slide(round, contacts, *ball, pose);
    ASSERT_EQ(contacts.size(), 1u) << angle;
    const Vec3 place = pose.transform_point(static_cast<Vec3>(contacts[0].point));
    EXPECT_LT(std::hypot(place.x, place.y), 2e-4) << angle;
    EXPECT_NEAR(place.z, 0.0, 5e-6) << angle;
    EXPECT_NEAR(contacts[0].depth, -place.z, 1e-8);
  }
}

TEST(RoundContacts, OfALeaningPoleAreOnTheEdgeAndSquareToThePole) {
  constexpr double kLean = 0.01;
  constexpr double kRadius = 0.02;
  constexpr double kEdge = 0.1;
  constexpr float kFar = 5e-3f;
  const auto pole = fine(make_cylinder(kRadius, 0.6, 64));
  const Field block = BoxField{{kEdge, kEdge, kEdge}};
  for (const double turn : {0.0, 0.03, 0.07}) {
    const double c = std::cos(kLean);
    const double s = std::sin(kLean);
    const Matrix3 turned{
        {std::cos(turn), -std::sin(turn), 0}, {std::sin(turn), std::cos(turn), 0}, {0, 0, 1}};
    // Along x, lower on that side, so that it touches the edge there.
    const double height = kEdge + (kEdge + kRadius * s) / c * s + kRadius * c;
    const Pose pose{Matrix3{{-s, 0, c}, {0, 1, 0}, {-c, 0, -s}} * turned, {0, 0, height}};
    QueryScratch scratch;
    const auto found = find_contacts(block, pole->shell(), pose, {.margin = kFar}, scratch);
    std::vector<Contact> contacts(found.begin(), found.end());
    RoundContacts round;
    round.slide(contacts, *pole, SmoothField(block), pose, {0.1, kMargin, 0.0}, {}, -kFar);
    const auto on_edge = [&](const Contact& contact) {
      const Vec3 place = pose.transform_point(static_cast<Vec3>(contact.point));
      return std::abs(place.x - kEdge) < 2e-4;
    };
    const auto reached = std::ranges::find_if(contacts, on_edge);
    ASSERT_NE(reached, contacts.end()) << turn;
    EXPECT_NEAR(reached->normal.z, 0.0, 1e-4) << turn;
    EXPECT_NEAR(reached->depth, 0.0, 1e-5) << turn;
  }
}

TEST(RoundContacts, KeepTheirIdsAsTheBodyRolls) {
  const auto ball = fine(make_icosphere(0.1, 4));
  RoundContacts round;
  auto first = touching(*ball, lying(0.0, 0.1));
  slide(round, first, *ball, lying(0.0, 0.1));
  for (double angle = 0.0; angle < 1.0; angle += 0.02) {
    auto contacts = touching(*ball, lying(angle, 0.1));
    slide(round, contacts, *ball, lying(angle, 0.1));
    ASSERT_EQ(contacts.size(), 1u);
    EXPECT_EQ(contacts[0].id, first[0].id) << angle;
  }
}

TEST(RoundContacts, OfACylinderLieAlongALine) {
  const auto cylinder = fine(make_cylinder(0.05, 0.2, 64));
  const Pose pose = lying(0.5 * 3.141592653589793, 0.05);
  auto contacts = touching(*cylinder, pose);
  RoundContacts round;
  slide(round, contacts, *cylinder, pose);
  double least = 1.0;
  double most = -1.0;
  for (const Contact& contact : contacts) {
    const Vec3 place = pose.transform_point(static_cast<Vec3>(contact.point));
    EXPECT_NEAR(place.x, 0.0, 2e-4);
    least = std::min(least, place.y);
    most = std::max(most, place.y);
  }
  EXPECT_NEAR(least, -0.1, 1e-3);
  EXPECT_NEAR(most, 0.1, 1e-3);
}

TEST(RoundContacts, OfAFacetedBodyStayWhereTheyAre) {
  const auto box = fine(make_box({0.1, 0.1, 0.1}));
  const auto before = touching(*box, lying(0.0, 0.1));
  auto contacts = before;
  RoundContacts round;
  slide(round, contacts, *box, lying(0.0, 0.1));
  EXPECT_EQ(contacts, before);
}

// Their normals became zero, and the poses of what they touched no numbers.
TEST(RoundContacts, InAFieldWithoutGradientStayWhereTheyAre) {
  const auto ball = fine(make_icosphere(0.1, 4));
  const auto before = touching(*ball, lying(0.3, 0.1));
  ASSERT_FALSE(before.empty());
  auto contacts = before;
  const Field none = PlaneField{{0, 0, 0}, 0.0};
  RoundContacts().slide(contacts, *ball, SmoothField(none), lying(0.3, 0.1), {0.1, kMargin, 0.0},
                        {}, -kReach);
  EXPECT_EQ(contacts, before);
}

// The belly of an egg on its side: turned far enough within the step, its end goes lower.
TEST(RoundContacts, OfABodyThatTurnsFastStay) {
  Soup egg = make_icosphere(0.1, 4);
  for (Vec3& v : egg.vertices) v.x *= 1.5;
  const auto model = fine(egg);
  const Pose pose = lying(0.0, 0.1);
  auto still = touching(*model, pose);
  auto turning = still;
  RoundContacts round;
  slide(round, still, *model, pose);
  EXPECT_EQ(still.size(), 1u);
  RoundContacts other;
  slide(other, turning, *model, pose, {{}, {0, 0.5, 0}, {}});
  EXPECT_GT(turning.size(), 1u);
}

}  // namespace
}  // namespace voxshell::bullet::round_contacts_test
