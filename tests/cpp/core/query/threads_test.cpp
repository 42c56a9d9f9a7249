#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "support/pairs.h"
#include "support/random.h"
#include "voxshell/contacts.h"
#include "voxshell/contacts_flat.h"

namespace voxshell::threads_test {
namespace {

using namespace test_support;

TEST(Threads, EightAskOneModelAtOnceAndGetTheSameAnswers) {
  Random random(120);
  const PointShell& shell = shells()[0];
  const Field& field = fields()[0];
  std::vector<Pose> poses;
  std::vector<std::vector<Contact>> expected;
  std::size_t contacts = 0;
  for (int i = 0; i < 200; ++i) {
    poses.push_back(make_pose_at(field, shell, random.uniform(-0.1, 0.01), random));
    expected.push_back(find_contacts_flat(field, shell, poses.back()));
    contacts += expected.back().size();
  }
  ASSERT_GT(contacts, 5000u);

  std::atomic<int> wrong{0};
  {
    std::vector<std::jthread> threads;
    for (std::size_t t = 0; t < 8; ++t) {
      threads.emplace_back([&, t] {
        QueryScratch scratch;
        for (std::size_t i = 0; i < poses.size(); ++i) {
          // Each in an order of its own.
          const std::size_t k = (i * (2 * t + 1) + 17 * t) % poses.size();
          const auto found = find_contacts(field, shell, poses[k], {}, scratch);
          wrong += !std::equal(found.begin(), found.end(), expected[k].begin(), expected[k].end());
          wrong += collides(field, shell, poses[k]) == expected[k].empty();
        }
      });
    }
  }
  EXPECT_EQ(wrong, 0);
}

}  // namespace
}  // namespace voxshell::threads_test
