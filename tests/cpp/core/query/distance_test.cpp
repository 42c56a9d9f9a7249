#include "voxshell/distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "support/pairs.h"
#include "support/random.h"
#include "voxshell/contacts_flat.h"

namespace voxshell::distance_test {
namespace {

using namespace test_support;

constexpr float kAnywhere = std::numeric_limits<float>::infinity();

/// Ids ascend, so that the first of equals is the one with the smallest id.
std::optional<Contact> find_nearest_flat(const Field& field, const PointShell& shell,
                                         const Pose& pose, float max_distance) {
  std::optional<Contact> nearest;
  for (const Contact& c : find_contacts_flat(field, shell, pose, {.margin = max_distance})) {
    if (!nearest || c.depth > nearest->depth) nearest = c;
  }
  return nearest;
}

TEST(Nearest, IsTheFlatLoopsToTheBit) {
  Random random(200);
  QueryScratch scratch;
  int poses = 0;
  int apart = 0;
  int inside = 0;
  for (const PointShell& shell : shells()) {
    for (const Field& field : fields()) {
      for (int i = 0; i < 45; ++i) {
        const double clearance = i % 3 == 0   ? random.uniform(0.01, 2.0)
                                 : i % 3 == 1 ? random.uniform(-0.001, 0.001)
                                              : random.uniform(-0.3, -0.01);
        const Pose pose = make_pose_at(field, shell, clearance, random);
        const auto flat = find_nearest_flat(field, shell, pose, kAnywhere);
        ASSERT_TRUE(flat);
        ASSERT_EQ(find_nearest(field, shell, pose, kAnywhere, scratch), flat);
        ++poses;
        apart += flat->depth < -0.005f;
        inside += flat->depth > 0.005f;
      }
    }
  }
  EXPECT_GT(apart, 0.25 * poses);
  EXPECT_GT(inside, 0.25 * poses);
}

TEST(Nearest, IsLookedForBelowTheLargestDistanceOnly) {
  Random random(201);
  QueryScratch scratch;
  for (const PointShell& shell : shells()) {
    for (const Field& field : fields()) {
      for (const double clearance : {0.5, 0.03, -0.05}) {
        const Pose pose = make_pose_at(field, shell, clearance, random);
        const auto nearest = find_nearest(field, shell, pose, kAnywhere, scratch);
        ASSERT_TRUE(nearest);
        const float distance = -nearest->depth;
        EXPECT_FALSE(find_nearest(field, shell, pose, distance, scratch));
        EXPECT_FALSE(find_nearest(field, shell, pose, distance - 0.01f, scratch));
        EXPECT_FALSE(find_nearest(field, shell, pose, -kAnywhere, scratch));
        for (const float beyond : {std::nextafter(distance, kAnywhere), distance + 0.01f, 1e30f}) {
          EXPECT_EQ(find_nearest(field, shell, pose, beyond, scratch), nearest);
        }
      }
    }
  }
}

TEST(Nearest, OfEquallyNearPointsIsTheFirst) {
  const PointShell shell = make_shell(make_box({0.3, 0.3, 0.15}), 0.03);
  const Field floor = PlaneField{};
  QueryScratch scratch;
  for (const double height : {0.5, 0.15, 0.1, -0.4}) {
    const Pose pose{{}, {5, 6, height}};
    const auto nearest = find_nearest(floor, shell, pose, kAnywhere, scratch);
    ASSERT_TRUE(nearest);
    const auto all = find_contacts_flat(floor, shell, pose, {.margin = kAnywhere});
    const auto first = std::find_if(all.begin(), all.end(),
                                    [&](const Contact& c) { return c.depth == nearest->depth; });
    EXPECT_EQ(*first, *nearest);
    EXPECT_GT(std::count_if(all.begin(), all.end(),
                            [&](const Contact& c) { return c.depth == nearest->depth; }),
              100);
    EXPECT_NEAR(nearest->depth, 0.15 - height, 1e-6);
  }
}

TEST(Nearest, OfTwoBallsIsOnTheLineOfTheirCenters) {
  const PointShell ball = make_shell(make_icosphere(0.1, 4), 0.005);
  QueryScratch scratch;
  Random random(202);
  for (int i = 0; i < 50; ++i) {
    const Vec3 direction = random.direction();
    const double gap = random.uniform(-0.05, 1.0);
    const Pose pose{random.rotation(), (0.5 + gap) * direction};
    const auto nearest = find_nearest(SphereField{0.4}, ball, pose, kAnywhere, scratch);
    ASSERT_TRUE(nearest);
    const Vec3 place = pose.transform_point(static_cast<Vec3>(nearest->point));
    const double distance = -static_cast<double>(nearest->depth);
    EXPECT_NEAR(distance, length(place) - 0.4, 1e-6);
    // The ball's points are no farther than sqrt(3) spacings from any of its places.
    EXPECT_GE(distance, gap - 1e-3);
    EXPECT_LE(distance, gap + 1.74 * 0.005);
    EXPECT_GT(dot(normalized(place), direction), 0.97);
  }
}

TEST(Nearest, OfPosesThatAreNotNumbersIsNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  QueryScratch scratch;
  for (const Field& field : fields()) {
    EXPECT_FALSE(find_nearest(field, shells()[0], {{}, {0, nan, 0}}, kAnywhere, scratch));
  }
}

}  // namespace
}  // namespace voxshell::distance_test
