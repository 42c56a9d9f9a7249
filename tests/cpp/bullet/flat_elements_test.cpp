#include "flat_elements.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "support/models.h"
#include "support/world.h"
#include "voxshell/contacts.h"

namespace voxshell::bullet::flat_elements_test {
namespace {

using namespace test_support;
using voxshell::test_support::make_box;

constexpr double kMargin = 2e-4;
constexpr double kSunk = 1e-4;

/// What of a slab touches a body that stands on it, before and after.
struct Touching {
  Touching(const Model& slab, const Field& field, double radius, const Pose& slab_from_body,
           float margin = static_cast<float>(kMargin)) {
    const Pose body_from_slab = slab_from_body.inverse();
    QueryScratch scratch;
    const auto found =
        find_contacts(field, slab.shell(), body_from_slab, {.margin = margin}, scratch);
    before.assign(found.begin(), found.end());
    after = before;
    FlatElements().align(after, field, slab.shell(), slab.grid(), body_from_slab,
                         {radius, kMargin, 0.0});
  }

  std::vector<Contact> before;
  std::vector<Contact> after;
};

bool is_upright(const Contact& contact) { return contact.normal.z < -0.9999f; }

// Points of a ground near the lower edge of a box had the normal of its side, or one aslant where
// the box's field rounds its edges off, and a box that slid stopped at them.
TEST(FlatElements, OfAGroundCarryABoxUpToItsEdges) {
  const auto rounded = build_model(make_box({0.05, 0.05, 0.05}), 0.008);
  for (const Field& box : {Field(BoxField{{0.05, 0.05, 0.05}}), rounded->field()}) {
    int aslant = 0;
    for (double shift = 0.0; shift < 0.01; shift += 2.3e-5) {
      const Touching touching(*slab_model(), box, 0.087, {{}, {shift, 0, 0.05 - kSunk}});
      EXPECT_GT(touching.after.size(), 20u);
      for (const Contact& contact : touching.before) aslant += is_upright(contact) ? 0 : 1;
      for (const Contact& contact : touching.after) {
        EXPECT_TRUE(is_upright(contact)) << contact.point.x - static_cast<float>(shift);
        EXPECT_LT(contact.depth, 1.01 * kSunk);
      }
    }
    EXPECT_GT(aslant, 10);
  }
}

// The slab's own field is not 0 at its points, but wrong by up to 0.8 micrometers.
TEST(FlatElements, AtDepthsBelowErrorsOfFieldsCarryABoxUpright) {
  const auto slab = build_by_tolerance({0.5, 0.5, 0.025});
  const auto box = build_model(make_box({0.05, 0.05, 0.05}), 0.005);
  int aslant = 0;
  for (double shift = 0.0; shift < 0.01; shift += 2.3e-5) {
    for (const double sunk : {1e-8, 1e-7, 1e-6}) {
      const Touching touching(*slab, box->field(), 0.087, {{}, {shift, 0, 0.075 - sunk}});
      for (const Contact& contact : touching.before) aslant += is_upright(contact) ? 0 : 1;
      for (const Contact& contact : touching.after) {
        EXPECT_TRUE(is_upright(contact)) << contact.point.x - static_cast<float>(shift);
      }
    }
  }
  EXPECT_GT(aslant, 10);
}

TEST(FlatElements, BesideABoxAreNotContacts) {
  const Field box = BoxField{{0.05, 0.05, 0.05}};
  int beside = 0;
  for (double shift = 0.0; shift < 0.01; shift += 2.3e-5) {
    const Touching touching(*slab_model(), box, 0.087, {{}, {shift, 0, 0.05 - kSunk}});
    for (const Contact& contact : touching.before) {
      beside += std::abs(static_cast<double>(contact.point.x) - shift) > 0.05 ? 1 : 0;
    }
    for (const Contact& contact : touching.after) {
      EXPECT_LT(std::abs(static_cast<double>(contact.point.x) - shift), 0.0501);
    }
  }
  EXPECT_GT(beside, 10);
}

// Places a few micrometers beside a rim, where face_elements() had given them a depth, kept normals
// aslant: a cube that slid over a slab of 1 m at 60 Hz turned by more than a degree.
TEST(FlatElements, AHairBesideARimCarryABoxUpright) {
  const Field box = BoxField{{0.05, 0.05, 0.05}};
  const PointShell& shell = slab_model()->shell();
  // The point that is nearest to the middle of the slab's top.
  std::uint32_t id = 0;
  for (std::uint32_t i = 0; i < shell.size(); ++i) {
    if (length(shell.points()[i]) < length(shell.points()[id])) id = i;
  }
  ASSERT_GT(shell.normals()[id].z, 0.99f);
  const auto place = static_cast<Vec3>(shell.points()[id]);
  const Pose slab_from_box{{}, place + Vec3{0.05 + 3e-6, 0, 0.05}};
  std::vector<Contact> contacts{{id, 5e-7f, shell.points()[id], normalized(Vec3f{0.02f, 0, -1})}};
  FlatElements().align(contacts, box, shell, slab_model()->grid(), slab_from_box.inverse(),
                       {0.087, kMargin, 0.0});
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_TRUE(is_upright(contacts[0])) << contacts[0].normal.z;
  EXPECT_GT(contacts[0].depth, 0.0f);
}

// A ball that dropped straight on a ground left sideways, as its facets are aslant.
TEST(FlatElements, OfAGroundCarryABallUpright) {
  const Touching touching(*slab_model(), ball_model()->field(), kBallRadius,
                          {{}, {0.002, 0.003, kBallRadius - 0.002}});
  ASSERT_GT(touching.after.size(), 0u);
  for (const Contact& contact : touching.after) {
    EXPECT_TRUE(is_upright(contact));
    EXPECT_LT(contact.depth, 0.002 + 1e-5);
  }
}

TEST(FlatElements, OfBentSurfacesKeepTheFieldsNormal) {
  const Field box = BoxField{{0.3, 0.3, 0.3}};
  const Touching touching(*ball_model(), box, kBallRadius,
                          {{}, {0, 0, -0.3 - kBallRadius + 0.002}});
  EXPECT_GT(touching.before.size(), 3u);
  EXPECT_EQ(touching.after, touching.before);
}

TEST(FlatElements, NearTheirOwnEdgeKeepTheFieldsNormal) {
  // A box beside a slab, its side 0.1 mm inside the slab's.
  const Field box = BoxField{{0.05, 0.05, 0.2}};
  const Touching touching(*slab_model(), box, 0.2, {{}, {0.35 - kSunk, 0, 0}});
  ASSERT_FALSE(touching.after.empty());
  for (const Contact& contact : touching.after) {
    if (static_cast<double>(contact.depth) <= 0.0) continue;
    EXPECT_GT(std::abs(contact.normal.x), 0.99f) << contact.point.z;
  }
}

}  // namespace
}  // namespace voxshell::bullet::flat_elements_test
