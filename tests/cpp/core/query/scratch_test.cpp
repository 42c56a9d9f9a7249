#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "support/meshes.h"
#include "support/pairs.h"
#include "support/random.h"
#include "voxshell/contacts.h"
#include "voxshell/contacts_flat.h"
#include "voxshell/distance.h"
#include "voxshell/manifold.h"
#include "voxshell/wrench.h"

namespace voxshell::scratch_test {
namespace {

using namespace test_support;

/// Returns how many contacts there are.
std::size_t expect_equal_to_flat(const Field& field, const PointShell& shell, const Pose& pose,
                                 const ContactOptions& options, QueryScratch& scratch) {
  const auto found = find_contacts(field, shell, pose, options, scratch);
  const auto flat = find_contacts_flat(field, shell, pose, options);
  EXPECT_EQ(found.size(), flat.size());
  if (found.size() != flat.size()) return 0;
  for (std::size_t i = 0; i < flat.size(); ++i) {
    if (found[i] == flat[i]) continue;
    ADD_FAILURE() << "contact " << i << " differs";
    return 0;
  }
  return flat.size();
}

/// Turned by about `angle` about a random axis and moved by about `step`.
Pose nudged(const Pose& pose, double angle, double step, Random& random) {
  const Vec3 axis = random.direction();
  const double c = std::cos(angle);
  const double s = std::sin(angle);
  const auto row = [&](const Vec3& e) {
    return c * e + s * cross(e, axis) + ((1.0 - c) * dot(e, axis)) * axis;
  };
  const Matrix3 turn{row({1, 0, 0}), row({0, 1, 0}), row({0, 0, 1})};
  return {turn * pose.rotation, pose.translation + step * random.direction()};
}

TEST(Scratch, FollowsMotionsOfEverySpeed) {
  // Microns to centimeters a step, and pauses; back to the start now and then, to stay in touch.
  Random random(240);
  std::size_t contacts = 0;
  for (const PointShell& shell : shells()) {
    for (const Field& field : fields()) {
      QueryScratch scratch;
      const Pose start = make_pose_at(field, shell, -0.01, random);
      Pose pose = start;
      for (int i = 0; i < 300; ++i) {
        const double step = std::pow(10.0, random.uniform(-7.0, -2.0));
        if (i % 5 != 0) pose = nudged(pose, step, step, random);
        if (i % 50 == 49) pose = start;
        contacts += expect_equal_to_flat(field, shell, pose, {}, scratch);
        if (testing::Test::HasFailure()) return;
      }
    }
  }
  EXPECT_GT(contacts, 50'000u);
}

TEST(Scratch, FollowsSmallMotionsAtEveryMargin) {
  // Also beyond what large cells, bricks of planes and the grid's end are met at.
  Random random(246);
  std::size_t contacts = 0;
  for (const PointShell& shell : shells()) {
    for (const Field& field : fields()) {
      for (const float margin : {-0.02f, 0.01f, 0.1f, 0.4f}) {
        QueryScratch scratch;
        Pose pose = make_pose_at(field, shell, random.uniform(-0.1, 0.3), random);
        for (int i = 0; i < 40; ++i) {
          pose = nudged(pose, 1e-5, 1e-5, random);
          contacts += expect_equal_to_flat(field, shell, pose, {.margin = margin}, scratch);
          if (testing::Test::HasFailure()) return;
        }
      }
    }
  }
  EXPECT_GT(contacts, 50'000u);
}

TEST(Scratch, FollowsALongSteadySlide) {
  // The same small step again and again: what was skipped comes near by degrees.
  Random random(241);
  std::size_t contacts = 0;
  for (const PointShell& shell : shells()) {
    for (const Field& field : fields()) {
      for (const double step : {2e-5, 4e-4}) {
        QueryScratch scratch;
        Pose pose = make_pose_at(field, shell, 0.01, random);
        const Vec3 forth = (-step) * normalized(pose.translation);
        for (int i = 0; i < 300; ++i) {
          pose.translation += forth;
          contacts += expect_equal_to_flat(field, shell, pose, {}, scratch);
          if (testing::Test::HasFailure()) return;
        }
      }
    }
  }
  EXPECT_GT(contacts, 50'000u);
}

TEST(Scratch, FollowsARotationAboutAPointFarAway) {
  // The relative pose's translation is what a rotation about the field's origin mixes with.
  Random random(242);
  std::size_t contacts = 0;
  for (const PointShell& shell : shells()) {
    for (const Field& field : {fields()[3], Field(BoxField{{50, 50, 50}})}) {
      QueryScratch scratch;
      Pose pose = make_pose_at(field, shell, -0.02, random);
      for (int i = 0; i < 300; ++i) {
        const Pose turn = nudged({}, 1e-5, 0.0, random);
        pose = turn * pose;
        contacts += expect_equal_to_flat(field, shell, pose, {}, scratch);
        if (testing::Test::HasFailure()) return;
      }
    }
  }
  EXPECT_GT(contacts, 5'000u);
}

TEST(Scratch, ServesPairsByTurns) {
  Random random(243);
  QueryScratch scratch;
  std::vector<Pose> poses;
  for (const PointShell& shell : shells()) {
    for (const Field& field : fields()) {
      poses.push_back(make_pose_at(field, shell, random.uniform(-0.05, 0.005), random));
    }
  }
  std::size_t contacts = 0;
  for (int round = 0; round < 30; ++round) {
    std::size_t at = 0;
    for (const PointShell& shell : shells()) {
      for (const Field& field : fields()) {
        Pose& pose = poses[at++];
        for (int i = 0; i < 1 + round % 3; ++i) {
          pose = nudged(pose, 1e-5, 1e-5, random);
          contacts += expect_equal_to_flat(field, shell, pose, {}, scratch);
        }
        if (testing::Test::HasFailure()) return;
      }
    }
  }
  EXPECT_GT(contacts, 20'000u);
}

TEST(Scratch, SharesListsWithOthersByTurns) {
  Random random(251);
  QueryLists lists;
  struct Following {
    const PointShell* shell;
    const Field* field;
    Pose pose;
    QueryScratch scratch;
  };
  std::vector<Following> all;
  for (const PointShell& shell : shells()) {
    for (const Field& field : fields()) {
      all.push_back({&shell, &field,
                     make_pose_at(field, shell, random.uniform(-0.05, 0.005), random),
                     QueryScratch()});
    }
  }
  std::size_t contacts = 0;
  for (int round = 0; round < 60; ++round) {
    for (Following& each : all) {
      // Small steps leave survivors, larger ones none. Every other round moves nothing by as much
      // as float32 can tell.
      const double step = round % 5 == 0 ? 0.02 : 1e-5;
      const bool is_still = round % 4 > 1;
      each.pose = nudged(each.pose, is_still ? 1e-15 : 1e-5, is_still ? 1e-15 : step, random);
      each.scratch.borrow(lists);
      contacts += expect_equal_to_flat(*each.field, *each.shell, each.pose, {}, each.scratch);
      if (testing::Test::HasFailure()) return;
    }
  }
  EXPECT_GT(contacts, 20'000u);
}

TEST(Scratch, FollowsMarginsOfBodiesThatMoveTogether) {
  // At one pose, or at poses that are rounded to one.
  Random random(252);
  QueryLists lists;
  std::size_t contacts = 0;
  for (const PointShell& shell : shells()) {
    for (const Field& field : fields()) {
      QueryScratch scratch;
      Pose pose = make_pose_at(field, shell, -0.01, random);
      float margin = 1e-4f;
      for (int i = 0; i < 60; ++i) {
        if (i % 20 == 0) pose = nudged(pose, 1e-5, 1e-5, random);
        const bool grows = i % 20 < 14;
        margin *= grows ? 1.0f + static_cast<float>(random.uniform(0.0, 0.4)) : 0.7f;
        const ContactOptions some{.margin = margin, .max_points = 5};
        const ContactOptions all{.margin = i % 7 == 3 ? -0.5f * margin : margin};
        scratch.borrow(lists);
        contacts += expect_equal_to_flat(field, shell, pose, i % 11 == 5 ? some : all, scratch);
        if (testing::Test::HasFailure()) return;
      }
    }
  }
  EXPECT_GT(contacts, 20'000u);
}

TEST(Scratch, ServesMarginsByTurns) {
  Random random(244);
  QueryScratch scratch;
  const float infinity = std::numeric_limits<float>::infinity();
  const ContactOptions options[] = {{},
                                    {.margin = 0.02f},
                                    {.margin = 0.02f, .max_points = 5},
                                    {.margin = -0.01f},
                                    {0.0f, 3u},
                                    {.margin = 1e-6f},
                                    {.margin = infinity},
                                    {.margin = -infinity}};
  std::size_t contacts = 0;
  for (const PointShell& shell : shells()) {
    for (const Field& field : fields()) {
      Pose pose = make_pose_at(field, shell, -0.02, random);
      for (int i = 0; i < 60; ++i) {
        if (i % 3 == 0) pose = nudged(pose, 1e-5, 1e-5, random);
        contacts += expect_equal_to_flat(field, shell, pose,
                                         options[random.below(std::size(options))], scratch);
        if (testing::Test::HasFailure()) return;
      }
    }
  }
  EXPECT_GT(contacts, 50'000u);
}

TEST(Scratch, ServesOtherQueriesInBetween) {
  Random random(245);
  QueryScratch scratch;
  std::size_t contacts = 0;
  for (const PointShell& shell : shells()) {
    for (const Field& field : fields()) {
      Pose pose = make_pose_at(field, shell, -0.02, random);
      for (int i = 0; i < 60; ++i) {
        // Once more what was asked last, every other time.
        if (i % 2 == 0) pose = nudged(pose, 1e-5, 1e-5, random);
        contacts += expect_equal_to_flat(field, shell, pose, {}, scratch);
        if (testing::Test::HasFailure()) return;
        switch (random.below(8)) {
          case 0:
            find_contacts_within_budget(field, shell, pose, {}, 20, scratch);
            break;
          case 1:
            find_manifold(field, shell, pose, 0.0f, scratch);
            break;
          case 2:
            find_deepest_per_segment(field, shell, pose, 3, 0.0f, scratch);
            break;
          case 3:
            compute_wrench(field, shell, pose, 1.0, scratch);
            break;
          case 4:
            find_nearest(field, shell, pose, 1.0f, scratch);
            break;
          case 5:
            find_deepest_per_segment(field, shell, pose, 12, 0.0f, scratch);
            break;
          case 6:
            find_contacts(field, shell, pose, {.max_points = 3}, scratch);
            break;
          default:
            scratch = QueryScratch();
        }
      }
    }
  }
  EXPECT_GT(contacts, 20'000u);
}

TEST(Scratch, KeepsContactsApartFromTheDeepestOfTheirSegments) {
  // Regression: segments finer than buckets were chosen among the kept contacts, in place.
  Random random(248);
  QueryScratch scratch;
  const PointShell& shell = shells()[0];
  for (const Field& field : fields()) {
    const Pose pose = make_pose_at(field, shell, -0.1, random);
    const std::size_t all = find_contacts(field, shell, pose, {}, scratch).size();
    const std::size_t few = find_deepest_per_segment(field, shell, pose, 12, 0.0f, scratch).size();
    EXPECT_LT(few, all);
    EXPECT_EQ(expect_equal_to_flat(field, shell, pose, {}, scratch), all);
  }
}

TEST(Scratch, TakesPosesForOneThatDifferByLessThanTheyAreRoundedTo) {
  // Of a point in a box's plane of symmetry, the sign of a zero would say which side is out.
  const PointShell shell = make_shell(make_spike(0.4, 0.25), 0.1);  // its base is at z = 0
  const Field box = BoxField{{2.0, 2.0, 0.3}};
  QueryScratch scratch;
  std::vector<Contact> last;
  for (const double zero : {0.0, -0.0, 1e-12, -1e-12}) {
    const Pose pose{{{1, 0, 0}, {0, -1, 0}, {-0.0, -0.0, -1}}, {0, 0, zero}};
    expect_equal_to_flat(box, shell, pose, {}, scratch);
    const auto found = scratch.contacts();
    EXPECT_FALSE(found.empty());
    EXPECT_TRUE(last.empty() || std::ranges::equal(found, last));
    last.assign(found.begin(), found.end());
  }
}

Field make_field(int kind, double size) {
  if (kind == 0) return SphereField{size};
  if (kind == 1) return BoxField{{size, size, size}};
  if (kind == 2) return PlaneField{{0, 0, 1}, size};
  return make_grid(make_box({size, size, size}), 0.5 * size);
}

TEST(Scratch, NoticesAFieldThatTakesThePlaceOfAnother) {
  // Small and large by turns, at one address and in one pose, in which the small one just touches.
  Random random(246);
  Field field = PlaneField{};
  const PointShell& shell = shells()[2];
  const auto replace = [&](int kind, double size) {
    field = PlaneField{};  // frees a grid's arrays, so that the next one's may lie there
    field = make_field(kind, size);
  };
  for (int kind = 0; kind < 4; ++kind) {
    QueryScratch scratch;
    replace(kind, 0.2);
    const Pose pose = make_pose_at(field, shell, -0.01, random);
    std::size_t fewest = SIZE_MAX;
    std::size_t most = 0;
    for (int i = 0; i < 12; ++i) {
      replace(kind, i % 2 == 0 ? 0.2 : 0.3);
      const std::size_t contacts = expect_equal_to_flat(field, shell, pose, {}, scratch);
      EXPECT_EQ(expect_equal_to_flat(field, shell, pose, {}, scratch), contacts);
      fewest = std::min(fewest, contacts);
      most = std::max(most, contacts);
    }
    EXPECT_GT(most, 2 * fewest + 10);
  }
}

TEST(Scratch, NoticesAShellThatTakesThePlaceOfAnother) {
  // Of as many points, but on one side of the field or on the other.
  QueryScratch scratch;
  std::optional<PointShell> shell;
  const Field field = SphereField{0.2};
  for (int i = 0; i < 20; ++i) {
    shell.reset();
    const double x = i % 2 == 0 ? 0.2 : -0.2;
    shell.emplace(make_shell(moved(make_box({0.2, 0.2, 0.2}), {x, 0, 0}), 0.05));
    const std::size_t contacts = expect_equal_to_flat(field, *shell, {}, {}, scratch);
    EXPECT_EQ(expect_equal_to_flat(field, *shell, {}, {}, scratch), contacts);
    EXPECT_GT(contacts, 10u);
    EXPECT_LT(contacts, shell->size() / 2);
  }
}

}  // namespace
}  // namespace voxshell::scratch_test
