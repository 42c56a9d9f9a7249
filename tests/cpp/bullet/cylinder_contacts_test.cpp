#include "cylinder_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "contact_search.h"
#include "support/models.h"
#include "support/random.h"
#include "support/two_bodies.h"
#include "support/world.h"

namespace voxshell::bullet::cylinder_contacts_test {
namespace {

using namespace test_support;
using voxshell::test_support::make_cylinder;
using voxshell::test_support::Random;

constexpr double kPi = 3.141592653589793;
constexpr double kRadius = 0.02;
constexpr double kHalfLength = 0.035;
constexpr double kBarRadius = 0.05;
constexpr double kTroughRadius = 0.06;

std::shared_ptr<const Model> fine(const Soup& soup) {
  return *Model::build(soup.mesh(), {.tolerance = 1e-4, .threads = 1});
}

/// Along z.
std::shared_ptr<const Model> bar() {
  static const auto model = fine(make_cylinder(kBarRadius, 0.4, 64));
  return model;
}

/// Half of a pipe along z, open toward +y.
std::shared_ptr<const Model> trough() {
  static const auto model = [] {
    constexpr std::uint32_t kSides = 32;
    std::vector<std::array<double, 2>> outline;
    const auto add = [&](double radius, std::uint32_t i) {
      const double angle = -kPi * i / kSides;
      outline.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    };
    for (std::uint32_t i = 0; i <= kSides; ++i) add(1.5 * kTroughRadius, kSides - i);
    for (std::uint32_t i = 0; i <= kSides; ++i) add(kTroughRadius, i);
    std::vector<std::array<std::uint32_t, 3>> caps;
    for (std::uint32_t i = 0; i < kSides; ++i) {
      const std::uint32_t inner = 2 * kSides + 1 - i;
      caps.push_back({i, i + 1, inner});
      caps.push_back({i + 1, inner - 1, inner});
    }
    return fine(voxshell::test_support::make_prism(outline, caps, -0.2, 0.2));
  }();
  return model;
}

/// From the z axis to a direction.
Pose along(const Vec3& direction, const Vec3& middle) {
  const Vec3 beside = std::abs(direction.x) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 x = normalized(cross(beside, direction));
  const Vec3 y = cross(direction, x);
  return {{{x.x, y.x, direction.x}, {x.y, y.y, direction.y}, {x.z, y.z, direction.z}}, middle};
}

/// A cylinder or capsule on a model whose frame is the world's.
struct On {
  On(const std::shared_ptr<const Model>& model, const Pose& pose, bool is_capsule = false,
     double radius = kRadius)
      : ground(world.add_model(model, 0)),
        body(world.add(is_capsule ? static_cast<btCollisionShape&>(world.make<btCapsuleShapeZ>(
                                        scalar(radius), scalar(2.0 * kHalfLength)))
                                  : static_cast<btCollisionShape&>(world.make<btCylinderShapeZ>(
                                        to_bullet(Vec3{radius, radius, kHalfLength}))),
                       1, pose)) {}

  const std::vector<Contact>& find(ContactSearch& search) {
    TwoBodies bodies(ground, body);
    const PairStep step = bodies.step();
    search.find_near({}, bodies.pair, step.margin, &step, Wanted::kAll);
    return search.contacts();
  }
  std::vector<Contact> find() {
    ContactSearch search;
    return find(search);
  }

  TestWorld world;
  btRigidBody& ground;
  btRigidBody& body;
};

TEST(CylinderContacts, AcrossABarAreOneWhereTheTwoAxesAreNearest) {
  Random random(3);
  for (int i = 0; i < 300; ++i) {
    const double around = random.uniform(0.0, 2.0 * kPi);
    const double across = random.uniform(0.8, kPi - 0.8);
    const double depth = random.uniform(-2e-5, 5e-5);
    const Vec3 up{std::cos(around), std::sin(around), 0.0};
    const Vec3 aside{-up.y, up.x, 0.0};
    const Vec3 axis = std::cos(across) * Vec3{0, 0, 1} + std::sin(across) * aside;
    const Vec3 touching =
        (kBarRadius + kRadius - depth) * up + Vec3{0, 0, random.uniform(-0.1, 0.1)};
    On on(bar(), along(axis, touching + random.uniform(-0.02, 0.02) * axis), i % 2 == 0);
    const auto contacts = on.find();
    ASSERT_EQ(contacts.size(), 1u) << "case " << i;
    // The smooth surface of the bar's facets is a cylinder but for a thousandth of its radius.
    EXPECT_NEAR(contacts[0].depth, depth, 5e-5) << "case " << i;
    EXPECT_LT(length(static_cast<Vec3>(contacts[0].normal) + up), 5e-3) << "case " << i;
    const Vec3 place = static_cast<Vec3>(contacts[0].point);
    EXPECT_LT(std::hypot(dot(place, aside), place.z - touching.z), 5e-4) << "case " << i;
  }
}

// The higher end had none, so that the two sank in turn.
TEST(CylinderContacts, InATroughAreAtBothEndsHoweverItLeans) {
  for (const bool is_capsule : {false, true}) {
    for (const double lean : {0.0, 0.002, 0.02}) {
      const Vec3 axis{0, std::sin(lean), std::cos(lean)};
      const double sunk = 1e-3;
      On on(trough(), along(axis, {0, -(kTroughRadius - kRadius + sunk), 0}), is_capsule);
      const auto contacts = on.find();
      ASSERT_EQ(contacts.size(), 2u) << lean;
      for (const Contact& contact : contacts) {
        const auto place = static_cast<Vec3>(contact.point);
        EXPECT_NEAR(std::abs(place.z), kHalfLength, 6e-4) << lean;
        EXPECT_NEAR(place.x, 0.0, 1e-4) << lean;
        const double higher = std::sin(lean) * std::copysign(kHalfLength, place.z);
        EXPECT_NEAR(contact.depth, sunk - higher, 5e-5) << lean;
      }
    }
  }
}

TEST(CylinderContacts, KeepTheirIdsAsTheBodyRolls) {
  On on(trough(), along({0, 0, 1}, {0, -(kTroughRadius - kRadius), 0}));
  ContactSearch search;
  std::vector<std::uint32_t> ids;
  for (double angle = -0.5; angle < 0.5; angle += 0.02) {
    const double way = kTroughRadius - kRadius;
    on.body.setWorldTransform(
        to_bullet(along({0, 0, 1}, {way * std::sin(angle), -way * std::cos(angle), 0})));
    const auto& contacts = on.find(search);
    ASSERT_EQ(contacts.size(), 2u) << angle;
    if (ids.empty()) ids = {contacts[0].id, contacts[1].id};
    EXPECT_EQ(contacts[0].id, ids[0]) << angle;
    EXPECT_EQ(contacts[1].id, ids[1]) << angle;
    for (const Contact& contact : contacts) {
      EXPECT_TRUE(std::ranges::binary_search(search.exact(), contact.id));
      EXPECT_NEAR(dot(static_cast<Vec3>(contact.normal), {std::sin(angle), -std::cos(angle), 0}),
                  1.0, 1e-4);
    }
  }
}

// No one place faces the other.
TEST(CylinderContacts, OfAPegThatFitsAreAllAround) {
  On on(trough(), along({0, 0, 1}, {0, 0, 0}), /*is_capsule=*/false, kTroughRadius - 2e-5);
  const auto contacts = on.find();
  for (const double angle : {-2.9, -2.2, -1.6, -1.0, -0.3}) {
    const Vec3 toward{std::cos(angle), std::sin(angle), 0.0};
    const auto is_there = [&](const Contact& contact) {
      return dot(static_cast<Vec3>(contact.normal), toward) > 0.9;
    };
    EXPECT_GE(std::ranges::count_if(contacts, is_there), 2) << angle;
  }
}

}  // namespace
}  // namespace voxshell::bullet::cylinder_contacts_test
