#include "parting_planes.h"

#include <vector>

#include <gtest/gtest.h>

#include "support/world.h"

namespace voxshell::bullet::parting_planes_test {
namespace {

using namespace test_support;

constexpr Vec3 kUp{0, 0, 1};

TEST(PartingPlanes, CountTheContactsThatTouch) {
  std::vector<Plane> planes;
  for (const double x : {-1.0, 0.0, 1.0}) add_plane({{x, 0, 0}, kUp, 0.0, false}, 0.01, planes);
  add_plane({{0, 0, 0}, kUp, 0.02, false}, 0.01, planes);        // does not touch
  add_plane({{0, 0, 0.5}, kUp, 0.0, false}, 0.01, planes);       // another height
  add_plane({{1, 0, 0}, {-1, 0, 0}, 0.0, false}, 0.01, planes);  // another normal
  ASSERT_EQ(planes.size(), 3);
  EXPECT_EQ(planes[0].count, 3);
  EXPECT_EQ(planes[1].count, 1);
  EXPECT_EQ(planes[2].count, 1);
}

/// A box of 1 m that lies on another one, flush on the side x = 0.5; a contact at that edge, whose
/// normal is level.
class OnFlushBoxes : public testing::Test {
 protected:
  std::optional<Seam> find(const Vec3& normal) {
    const Touch touch{{0.5, 0, 0}, normal, 0.0, false};
    return find_parting(touch, {true, touch.on_other(), {}}, planes_, 0.5, above_, below_);
  }

  TestWorld world_;
  btCollisionShape& cube_ = world_.make<btBoxShape>(btVector3(0.5, 0.5, 0.5));
  Neighbor above_{world_.add(cube_, 1, {{}, {0, 0, 0.5}}), 0.01};
  Neighbor below_{world_.add(cube_, 0, {{}, {0, 0, -0.5}}), 0.01};
  std::vector<Plane> planes_{{kUp, {0, 0, 0}, 4}};
};

TEST_F(OnFlushBoxes, ALevelContactIsRemoved) {
  const auto seam = find({1, 0, 0});
  ASSERT_TRUE(seam);
  EXPECT_FALSE(seam->supports);
}

TEST_F(OnFlushBoxes, OneThatLeansIsTurned) {
  const auto seam = find(normalized(Vec3{0.5, 0, 1}));
  ASSERT_TRUE(seam);
  EXPECT_TRUE(seam->supports);
  EXPECT_EQ(seam->normal, kUp);
  EXPECT_EQ(seam->gap, 0.0);
}

TEST_F(OnFlushBoxes, OneWithThePlanesNormalStays) { EXPECT_FALSE(find(kUp)); }

TEST_F(OnFlushBoxes, OneOfAPlaneOfMoreContactsStays) {
  const Vec3 level{1, 0, 0};
  planes_.insert(planes_.begin(), {level, {0.5, 0, 0}, 5});
  EXPECT_FALSE(find(level));
}

}  // namespace
}  // namespace voxshell::bullet::parting_planes_test
