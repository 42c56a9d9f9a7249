#include "facing_normals.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "support/brick.h"
#include "voxshell/contacts.h"

namespace voxshell::bullet::facing_normals_test {
namespace {

using namespace test_support;

constexpr double kReach = 1e-4;
constexpr double kSunk = 2e-6;

/// A brick flush on a box of the same size, sunk into it by `sunk`, with reach to spare.
std::vector<Contact> find_on_box(double sunk) {
  const Field box = BoxField{kBrickHalf};
  const Pose box_from_brick{{}, {0, 0, 2.0 * kBrickHalf.z - sunk}};
  QueryScratch scratch;
  const auto found =
      find_contacts(box, brick_model()->shell(), box_from_brick, {.margin = 2e-4f}, scratch);
  return {found.begin(), found.end()};
}

std::vector<Contact> face(std::vector<Contact> contacts, double sunk, double reach) {
  const Field box = BoxField{kBrickHalf};
  const Pose box_from_brick{{}, {0, 0, 2.0 * kBrickHalf.z - sunk}};
  face_elements(contacts, box, brick_model()->shell(), box_from_brick, reach, 0.0);
  return contacts;
}

// Of places along the rim of a face, the field said that the side was nearer: no depth, and a push
// aside.
TEST(FacingNormals, CarryABrickUpToTheRim) {
  const std::vector<Contact> found = find_on_box(kSunk);
  const auto is_upright = [](const Contact& contact) { return contact.normal.z > 0.99f; };
  ASSERT_GT(std::ranges::count_if(found, [&](const Contact& c) { return !is_upright(c); }), 10);
  int below = 0;
  for (const Contact& contact : face(found, kSunk, kReach)) {
    if (brick_model()->shell().normal_of(contact.id).z > -0.5f) continue;  // of an upright edge
    ++below;
    EXPECT_GT(contact.normal.z, 0.9999f) << contact.id;
    EXPECT_NEAR(contact.depth, kSunk, 1e-7) << contact.id;
  }
  EXPECT_GT(below, 50);
}

TEST(FacingNormals, LeaveWhatIsDeeperThanEightReaches) {
  constexpr double kDeep = 20 * kReach;
  const std::vector<Contact> found = find_on_box(kDeep);
  const std::vector<Contact> faced = face(found, kDeep, kReach);
  ASSERT_EQ(faced.size(), found.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (static_cast<double>(found[i].depth) > 8 * kReach) {
      EXPECT_EQ(faced[i], found[i]);
    }
  }
}

TEST(FacingNormals, WithoutAReachStayAsTheyAre) {
  const std::vector<Contact> found = find_on_box(0.0);
  EXPECT_EQ(face(found, 0.0, 0.0), found);
}

}  // namespace
}  // namespace voxshell::bullet::facing_normals_test
