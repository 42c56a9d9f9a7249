#include "voxshell/batch.h"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "support/pairs.h"
#include "support/random.h"

namespace voxshell::batch_test {
namespace {

using namespace test_support;

/// More than one task's worth, and not a whole number of them.
std::vector<Pose> make_poses(const Field& field, const PointShell& shell, Random& random) {
  std::vector<Pose> poses;
  for (int i = 0; i < 205; ++i) {
    poses.push_back(make_pose_at(field, shell, random.uniform(-0.1, 0.1), random));
  }
  return poses;
}

TEST(Batch, IsItsPosesOneByOneOnAnyNumberOfThreads) {
  Random random(230);
  QueryScratch scratch;
  for (const PointShell& shell : shells()) {
    for (const Field& field : {fields()[0], fields()[3], fields()[4]}) {
      const std::vector<Pose> poses = make_poses(field, shell, random);
      for (const ContactOptions options :
           {ContactOptions{}, ContactOptions{.margin = 0.01f, .max_points = 7}}) {
        for (const unsigned threads : {1u, 2u, 7u}) {
          const auto batch = find_contacts_batch(field, shell, poses, options, threads);
          const auto touches = collides_batch(field, shell, poses, options.margin, threads);
          ASSERT_TRUE(batch);
          ASSERT_TRUE(touches);
          ASSERT_EQ(batch->offsets.size(), poses.size() + 1);
          ASSERT_EQ(touches->size(), poses.size());
          ASSERT_EQ(batch->offsets.front(), 0u);
          ASSERT_EQ(batch->offsets.back(), batch->contacts.size());
          std::size_t colliding = 0;
          for (std::size_t i = 0; i < poses.size(); ++i) {
            const auto alone = find_contacts(field, shell, poses[i], options, scratch);
            const auto begin = batch->contacts.begin();
            ASSERT_TRUE(std::equal(alone.begin(), alone.end(),
                                   begin + static_cast<std::ptrdiff_t>(batch->offsets[i]),
                                   begin + static_cast<std::ptrdiff_t>(batch->offsets[i + 1])));
            ASSERT_EQ((*touches)[i], alone.empty() ? 0 : 1);
            colliding += !alone.empty();
          }
          EXPECT_GT(colliding, 50u);
          EXPECT_LT(colliding, 180u);
        }
      }
    }
  }
}

TEST(Batch, OfNoPosesIsEmpty) {
  const auto batch = find_contacts_batch(fields()[0], shells()[0], {}, {});
  ASSERT_TRUE(batch);
  EXPECT_EQ(batch->offsets, std::vector<std::size_t>{0});
  EXPECT_TRUE(batch->contacts.empty());
  const auto touches = collides_batch(fields()[0], shells()[0], {}, 0.0f);
  ASSERT_TRUE(touches);
  EXPECT_TRUE(touches->empty());
}

TEST(Batch, StopsWhereProgressSaysSo) {
  Random random(231);
  const std::vector<Pose> poses = make_poses(fields()[5], shells()[0], random);
  for (const unsigned threads : {1u, 7u}) {
    int asked = 0;
    const auto stop = [&](std::string_view, double) {
      ++asked;
      return false;
    };
    const auto batch = find_contacts_batch(fields()[5], shells()[0], poses, {}, threads, stop);
    ASSERT_FALSE(batch);
    EXPECT_EQ(batch.error().code, ErrorCode::kCanceled);
    EXPECT_EQ(asked, 1);
    const auto touches = collides_batch(fields()[5], shells()[0], poses, 0.0f, threads, stop);
    ASSERT_FALSE(touches);
    EXPECT_EQ(touches.error().code, ErrorCode::kCanceled);
    EXPECT_EQ(asked, 2);
  }
}

TEST(Batch, ReportsItsEnd) {
  Random random(232);
  const std::vector<Pose> poses = make_poses(fields()[5], shells()[0], random);
  double last = 0.0;
  const auto listen = [&](std::string_view stage, double fraction) {
    EXPECT_FALSE(stage.empty());
    EXPECT_GE(fraction, last);
    last = fraction;
    return true;
  };
  ASSERT_TRUE(find_contacts_batch(fields()[5], shells()[0], poses, {}, 2, listen));
  EXPECT_EQ(last, 1.0);
}

}  // namespace
}  // namespace voxshell::batch_test
