#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "simd/tree_view.h"
#include "support/pairs.h"
#include "support/random.h"
#include "voxshell/contacts.h"
#include "voxshell/contacts_flat.h"

namespace voxshell::budget_test {
namespace {

using namespace test_support;

constexpr float kNothing = -std::numeric_limits<float>::infinity();

/// What a budget promises, against all contacts there are.
void expect_promises_kept(const BudgetedContacts& found, const std::vector<Contact>& all) {
  // All that was found is there, with the same bits and in order; the rest is not too deep.
  std::size_t at = 0;
  float deepest_missed = kNothing;
  for (const Contact& contact : all) {
    if (at < found.contacts.size() && found.contacts[at] == contact) {
      ++at;
    } else {
      deepest_missed = std::max(deepest_missed, contact.depth);
    }
  }
  ASSERT_EQ(at, found.contacts.size()) << "found what is no contact, or out of order";
  ASSERT_LE(deepest_missed, found.depth_bound);
  if (found.is_exact) {
    ASSERT_EQ(found.contacts.size(), all.size());
    ASSERT_EQ(found.depth_bound, kNothing);
  }
}

TEST(Budget, BoundsWhatItMisses) {
  Random random(220);
  QueryScratch scratch;
  constexpr std::size_t kBudgets[] = {0, 1, 10, 100, 1000};
  std::vector<int> exact(std::size(kBudgets));
  std::vector<int> found(std::size(kBudgets));
  int poses = 0;
  int colliding = 0;
  for (const PointShell& shell : shells()) {
    for (const Field& field : fields()) {
      for (int i = 0; i < 25; ++i) {
        // A third each apart, touching and deep; each with nine more about it.
        const double clearance = i % 3 == 0   ? random.uniform(0.005, 0.3)
                                 : i % 3 == 1 ? random.uniform(-0.01, 0.005)
                                              : random.uniform(-0.2, -0.01);
        const Pose start = make_pose_at(field, shell, clearance, random);
        for (int k = 0; k < 10; ++k) {
          Pose pose = start;
          pose.translation += random.in_cube(0.01 * k);
          const float margin = k % 4 == 3 ? 0.01f : 0.0f;
          const auto all = find_contacts_flat(field, shell, pose, {.margin = margin});
          ++poses;
          colliding += !all.empty();
          for (std::size_t b = 0; b < std::size(kBudgets); ++b) {
            const auto answer = find_contacts_within_budget(field, shell, pose, {.margin = margin},
                                                            kBudgets[b], scratch);
            expect_promises_kept(answer, all);
            if (testing::Test::HasFatalFailure()) return;
            // A node holds eight points.
            ASSERT_LE(answer.contacts.size(), 8 * kBudgets[b]);
            exact[b] += answer.is_exact;
            found[b] += !answer.contacts.empty();
          }
        }
      }
    }
  }
  EXPECT_EQ(poses, 10'000);
  EXPECT_GT(colliding, 0.4 * poses);
  EXPECT_LT(colliding, 0.8 * poses);
  EXPECT_EQ(exact[0], 0);
  EXPECT_LT(exact[2], 0.7 * poses) << "budgets that are never too small test nothing";
  EXPECT_GT(exact[2], 0.1 * poses);
  EXPECT_EQ(exact[4], poses);
  EXPECT_TRUE(std::is_sorted(exact.begin(), exact.end()));
  // What little work can do it puts where contacts may be.
  EXPECT_GT(found[2], 0.5 * colliding);
  EXPECT_GT(found[3], 0.9 * colliding);
}

TEST(Budget, WithoutEndFindsAllContacts) {
  Random random(221);
  QueryScratch scratch;
  std::size_t contacts = 0;
  for (const PointShell& shell : shells()) {
    for (const Field& field : fields()) {
      for (int i = 0; i < 10; ++i) {
        const Pose pose = make_pose_at(field, shell, random.uniform(-0.2, 0.05), random);
        const auto all = find_contacts_flat(field, shell, pose);
        const auto answer =
            find_contacts_within_budget(field, shell, pose, {}, SIZE_MAX / 2, scratch);
        EXPECT_TRUE(answer.is_exact);
        EXPECT_TRUE(
            std::equal(all.begin(), all.end(), answer.contacts.begin(), answer.contacts.end()));
        contacts += all.size();
      }
    }
  }
  EXPECT_GT(contacts, 10'000u);
}

TEST(Budget, OfOneNodeBoundsTheDepthByTheWholeShell) {
  const Field floor = PlaneField{};
  const PointShell shell = make_shell(make_box({0.3, 0.3, 0.15}), 0.03);
  QueryScratch scratch;
  const auto answer = find_contacts_within_budget(floor, shell, {{}, {0, 0, 0.1}}, {}, 1, scratch);
  EXPECT_FALSE(answer.is_exact);
  EXPECT_GE(answer.depth_bound, 0.05f);
  EXPECT_LT(answer.depth_bound, 0.5f);
  const auto apart = find_contacts_within_budget(floor, shell, {{}, {0, 0, 3}}, {}, 1, scratch);
  EXPECT_TRUE(apart.is_exact);
}

TEST(Budget, OfOneNodeBoundsTheDepthForTreesOfEveryDepth) {
  const Field floor = PlaneField{};
  QueryScratch scratch;
  std::set<std::int32_t> depths;
  for (const double spacing : {0.08, 0.055, 0.04, 0.028, 0.02}) {
    const PointShell shell = make_shell(make_box({0.3, 0.3, 0.15}), spacing);
    depths.insert(shell.tree().view().depth % 3);
    for (const std::size_t budget : {std::size_t{1}, std::size_t{2}}) {
      const auto answer =
          find_contacts_within_budget(floor, shell, {{}, {0, 0, 0.1}}, {}, budget, scratch);
      EXPECT_LT(answer.depth_bound, 0.5f) << spacing;
      const auto apart =
          find_contacts_within_budget(floor, shell, {{}, {0, 0, 3}}, {}, budget, scratch);
      EXPECT_TRUE(apart.is_exact) << spacing;
    }
  }
  EXPECT_EQ(depths.size(), 3u);
}

TEST(Budget, KeepsTheDeepestOfWhatItFinds) {
  Random random(222);
  QueryScratch scratch;
  const PointShell& shell = shells()[0];
  for (const Field& field : fields()) {
    const Pose pose = make_pose_at(field, shell, -0.1, random);
    for (const std::size_t budget : {std::size_t{20}, std::size_t{1000}}) {
      const auto answer = find_contacts_within_budget(field, shell, pose, {}, budget, scratch);
      std::vector<Contact> deepest(answer.contacts.begin(), answer.contacts.end());
      ASSERT_GT(deepest.size(), 5u);
      std::stable_sort(deepest.begin(), deepest.end(),
                       [](const Contact& a, const Contact& b) { return a.depth > b.depth; });
      deepest.resize(5);
      std::sort(deepest.begin(), deepest.end(),
                [](const Contact& a, const Contact& b) { return a.id < b.id; });
      const auto few =
          find_contacts_within_budget(field, shell, pose, {.max_points = 5}, budget, scratch);
      EXPECT_TRUE(
          std::equal(deepest.begin(), deepest.end(), few.contacts.begin(), few.contacts.end()));
    }
  }
}

}  // namespace
}  // namespace voxshell::budget_test
