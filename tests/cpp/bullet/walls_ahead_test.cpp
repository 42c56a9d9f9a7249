#include "walls_ahead.h"

#include <vector>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/two_bodies.h"

namespace voxshell::bullet::walls_ahead_test {
namespace {

using namespace test_support;
using voxshell::test_support::make_l_shape;

constexpr double kSide = 0.1;
constexpr double kHalf = 0.02;
constexpr double kStep = 1.0 / 100.0;

/// A box on the lower arm of an L, from whose upper arm its side is 3 cm away.
struct Slide {
  explicit Slide(const Vec3& velocity, double lift = 0.0)
      : box(world.add(world.make<btBoxShape>(to_bullet(Vec3{kHalf, kHalf, kHalf})), 1,
                      {{}, {kSide + 0.03 + kHalf, kSide + kHalf + lift, 0.5 * kSide}})),
        bodies(world.add_model(build_by_tolerance(make_l_shape(kSide)), 0), box) {
    box.setLinearVelocity(to_bullet(velocity));
    step = bodies.step(kStep);
    find_features(bodies.pair, features);
    append_feature_contacts(features, bodies.pair, 1e-4, contacts);
    touching = contacts.size();
    append_walls_ahead(step, features, contacts);
  }

  TestWorld world{{}, {0, 0, 0}};
  btRigidBody& box;
  TwoBodies bodies;
  PairStep step{};
  std::vector<Feature> features;
  std::vector<Contact> contacts;
  std::size_t touching = 0;
};

TEST(WallsAhead, AreMetByAllCornersThatSlideIntoThem) {
  const Slide slide({-10, 0, 0});  // 10 cm in the step
  ASSERT_EQ(slide.features.size(), 16U);
  ASSERT_EQ(slide.touching, 4U);
  ASSERT_EQ(slide.contacts.size(), 8U);
  int front = 0;
  for (std::size_t i = slide.touching; i < slide.contacts.size(); ++i) {
    const Contact& contact = slide.contacts[i];
    const Feature& feature = slide.features[contact.id - kFirstFeature];
    EXPECT_GE(contact.id, kFirstFeature + 8);
    EXPECT_NEAR(contact.normal.x, -1.0f, 1e-3f);
    EXPECT_NEAR(contact.depth, kSide - feature.place.x, 1e-4);
    // A quarter as high as the middle.
    EXPECT_NEAR(feature.place.y, kSide + 0.25 * kHalf, 1e-5);
    front += feature.place.x < kSide + 0.031 ? 1 : 0;
  }
  EXPECT_EQ(front, 2);
}

TEST(WallsAhead, AreNoFartherThanTheStepLeads) {
  EXPECT_EQ(Slide({-5, 0, 0}).contacts.size(), 6U);    // the rear is 2 cm short of the wall
  EXPECT_EQ(Slide({-2.5, 0, 0}).contacts.size(), 4U);  // so is all of it
  EXPECT_EQ(Slide({10, 0, 0}).contacts.size(), 4U);
}

TEST(WallsAhead, AreForWhatTouchesSomethingElse) {
  EXPECT_EQ(Slide({-10, 0, 0}, 0.01).contacts.size(), 0U);
}

}  // namespace
}  // namespace voxshell::bullet::walls_ahead_test
