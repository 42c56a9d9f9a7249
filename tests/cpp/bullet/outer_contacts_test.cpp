#include "outer_contacts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace voxshell::bullet::outer_contacts_test {
namespace {

constexpr double kLeast = 1e-6;       // meters
constexpr double kTolerance = 0.012;  // of the size of a set of contacts
constexpr float kBand = 1e-5f;
constexpr Vec3f kUp{0, 0, 1};

Contact contact_at(double x, double y, double z = 0.0, const Vec3f& normal = kUp,
                   float depth = 0.0f) {
  return {0, depth, static_cast<Vec3f>(Vec3{x, y, z}), normal};
}

std::vector<Contact> numbered(std::vector<Contact> contacts) {
  for (std::uint32_t i = 0; Contact& contact : contacts) contact.id = 3 * i++;
  return contacts;
}

/// A square of n x n contacts, 0.1 m wide, about the origin, turned about z.
std::vector<Contact> square(int n, double turn = 0.0) {
  std::vector<Contact> contacts;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const double x = 0.1 * i / (n - 1) - 0.05;
      const double y = 0.1 * j / (n - 1) - 0.05;
      contacts.push_back(contact_at(std::cos(turn) * x - std::sin(turn) * y,
                                    std::sin(turn) * x + std::cos(turn) * y));
    }
  }
  return numbered(std::move(contacts));
}

std::vector<std::uint32_t> ids_of(const std::vector<Contact>& contacts) {
  std::vector<std::uint32_t> ids;
  for (const Contact& contact : contacts) ids.push_back(contact.id);
  return ids;
}

TEST(OuterContacts, OfASquareAreItsCorners) {
  for (const double turn : {0.0, 0.3, 0.785, 2.0}) {
    std::vector<Contact> contacts = square(9, turn);
    ASSERT_TRUE(leave_outer(kLeast, kBand, contacts));
    EXPECT_EQ(ids_of(contacts), (std::vector<std::uint32_t>{0, 3 * 8, 3 * 72, 3 * 80}));
  }
}

TEST(OuterContacts, OfACircleLoseNoMoreThanTheTolerance) {
  std::vector<Contact> contacts;
  for (int i = 0; i < 90; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 90;
    contacts.push_back(contact_at(0.05 * std::cos(angle), 0.05 * std::sin(angle)));
  }
  ASSERT_TRUE(leave_outer(kLeast, kBand, contacts));
  EXPECT_LE(contacts.size(), 36u);
  double turned = 0.0;
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const auto a = static_cast<Vec3>(contacts[i].point);
    const auto b = static_cast<Vec3>(contacts[(i + 1) % contacts.size()].point);
    EXPECT_GE(length(0.5 * (a + b)), 0.05 * (1.0 - kTolerance));
    turned += std::atan2(a.x * b.y - a.y * b.x, dot(a, b));
  }
  EXPECT_NEAR(turned, 2.0 * std::numbers::pi, 1e-6);  // all the way around
}

TEST(OuterContacts, SpanAllOthers) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> place(-1.0, 1.0);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<Contact> contacts;
    const int count = 1 + trial % 40;
    for (int i = 0; i < count; ++i) contacts.push_back(contact_at(place(random), place(random)));
    const std::vector<Contact> all = numbered(std::move(contacts));
    std::vector<Contact> outer = all;
    ASSERT_TRUE(leave_outer(kLeast, kBand, outer));
    EXPECT_TRUE(std::ranges::is_sorted(outer, {}, &Contact::id));
    for (int i = 0; i < 64; ++i) {
      const double angle = 2.0 * std::numbers::pi * i / 64;
      const auto reach = [&](const std::vector<Contact>& of) {
        double most = -10.0;
        for (const Contact& contact : of) {
          most = std::max(most, std::cos(angle) * static_cast<double>(contact.point.x) +
                                    std::sin(angle) * static_cast<double>(contact.point.y));
        }
        return most;
      };
      EXPECT_GE(reach(outer), reach(all) - kTolerance);
    }
  }
}

// With a tolerance relative to the body, a beam on narrow feet tipped at 0.8 of its slope.
TEST(OuterContacts, OfLongNarrowPatchesKeepWhatReachesOut) {
  std::vector<Contact> contacts;
  for (const double x : {-1.0, 0.0, 1.0}) {
    const double half = x == 0.0 ? 0.009 : 0.001;
    for (const double y : {-half, half}) contacts.push_back(contact_at(x, y));
  }
  contacts = numbered(std::move(contacts));
  ASSERT_TRUE(leave_outer(kLeast, kBand, contacts));
  EXPECT_EQ(contacts.size(), 6u);
}

TEST(OuterContacts, OfARowAreItsEnds) {
  std::vector<Contact> contacts;
  for (int i = 0; i < 20; ++i) contacts.push_back(contact_at(0.01 * i, 0.003 * i));
  contacts = numbered(std::move(contacts));
  ASSERT_TRUE(leave_outer(kLeast, kBand, contacts));
  EXPECT_EQ(ids_of(contacts), (std::vector<std::uint32_t>{0, 57}));
}

TEST(OuterContacts, OfOnePlaceAreOne) {
  std::vector<Contact> contacts = numbered({contact_at(1, 2), contact_at(1, 2), contact_at(1, 2)});
  ASSERT_TRUE(leave_outer(kLeast, kBand, contacts));
  EXPECT_EQ(contacts.size(), 1u);
}

TEST(OuterContacts, AreThoseOfEachPatch) {
  std::vector<Contact> contacts = square(5);
  for (Contact wall : square(5)) {
    wall.point = {wall.point.x, 0.2f, wall.point.y};
    wall.normal = {0, 1, 0};
    contacts.push_back(wall);
  }
  contacts = numbered(std::move(contacts));
  ASSERT_TRUE(leave_outer(kLeast, kBand, contacts));
  EXPECT_EQ(contacts.size(), 8u);
}

TEST(OuterContacts, OnARimHaveTheNormalOfThePatch) {
  std::vector<Contact> contacts = square(9);
  contacts[8].normal = static_cast<Vec3f>(normalized(Vec3{0.02, 0.01, 1}));
  ASSERT_TRUE(leave_outer(kLeast, kBand, contacts));
  ASSERT_EQ(ids_of(contacts), (std::vector<std::uint32_t>{0, 3 * 8, 3 * 72, 3 * 80}));
  for (const Contact& contact : contacts) EXPECT_EQ(contact.normal, kUp);
}

TEST(OuterContacts, OfTwoFacesOfAWedgeKeepTheirNormals) {
  std::vector<Contact> contacts = square(5);
  const auto leaning = static_cast<Vec3f>(normalized(Vec3{0.1, 0, 1}));
  for (Contact contact : square(5)) {
    contact.point.x += 0.1f;
    contact.normal = leaning;
    contacts.push_back(contact);
  }
  contacts = numbered(std::move(contacts));
  ASSERT_TRUE(leave_outer(kLeast, kBand, contacts));
  EXPECT_EQ(contacts.size(), 8u);
  EXPECT_EQ(contacts.front().normal, kUp);
  EXPECT_EQ(contacts.back().normal, leaning);
}

TEST(OuterContacts, AreAllWhereSurfacesAreCurved) {
  std::vector<Contact> contacts;
  for (int i = 0; i < 20; ++i) {
    const double angle = 0.05 * i;
    contacts.push_back(contact_at(std::sin(angle), 0, std::cos(angle),
                                  static_cast<Vec3f>(Vec3{std::sin(angle), 0, std::cos(angle)})));
  }
  EXPECT_FALSE(leave_outer(kLeast, kBand, contacts));
  EXPECT_EQ(contacts.size(), 20u);
}

TEST(OuterContacts, OfATiltedPatchAreItsCorners) {
  std::vector<Contact> contacts = square(9);
  for (Contact& contact : contacts) contact.depth = 0.01f * contact.point.x;
  ASSERT_TRUE(leave_outer(kLeast, kBand, contacts));
  EXPECT_EQ(contacts.size(), 4u);
}

TEST(OuterContacts, OfATiltedRowAreItsEnds) {
  std::vector<Contact> contacts;
  for (int i = 0; i < 20; ++i) {
    contacts.push_back(contact_at(0.01 * i, 0.003 * i, 0.0, kUp, 1e-3f * static_cast<float>(i)));
  }
  ASSERT_TRUE(leave_outer(kLeast, kBand, contacts));
  EXPECT_EQ(contacts.size(), 2u);
}

TEST(OuterContacts, AreAllWhereOneWithinIsDeeper) {
  std::vector<Contact> contacts = square(5);
  contacts[12].depth = 2.0f * kBand;
  EXPECT_FALSE(leave_outer(kLeast, kBand, contacts));
  EXPECT_EQ(contacts.size(), 25u);
  contacts[12].depth = 0.5f * kBand;
  EXPECT_TRUE(leave_outer(kLeast, kBand, contacts));
  EXPECT_EQ(contacts.size(), 4u);
}

}  // namespace
}  // namespace voxshell::bullet::outer_contacts_test
