#include "voxshell/point_sphere_tree.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "simd/tree_view.h"
#include "support/random.h"

namespace voxshell::point_sphere_tree_test {
namespace {

using test_support::Random;

constexpr std::uint32_t kCounts[] = {1, 2, 3, 7, 8, 9, 31, 32, 33, 799, 2049, 35'596};

std::vector<Vec3f> random_points(std::uint32_t count, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3f> points;
  for (std::uint32_t i = 0; i < count; ++i) {
    points.push_back(static_cast<Vec3f>(random.in_box({-1, -2, 3}, {1, 5, 4})));
  }
  return points;
}

struct BuiltTree {
  std::vector<Vec3f> points;         ///< as given
  std::vector<std::uint32_t> order;  ///< of `points` in the tree
  PointSphereTree tree;
};

BuiltTree build(std::vector<Vec3f> points) {
  BuiltTree built{std::move(points), {}, {}};
  built.order.resize(built.points.size());
  std::iota(built.order.begin(), built.order.end(), 0u);
  built.tree = PointSphereTree::build(built.points, built.order);
  return built;
}

double distance_between(const Vec3f& a, const Vec3f& b) {
  return length(static_cast<Vec3>(a) - static_cast<Vec3>(b));
}

TEST(PointSphereTree, OrderIsAPermutation) {
  for (const std::uint32_t count : kCounts) {
    BuiltTree built = build(random_points(count, 40));
    EXPECT_EQ(built.tree.point_count(), count);
    std::sort(built.order.begin(), built.order.end());
    for (std::uint32_t i = 0; i < count; ++i) ASSERT_EQ(built.order[i], i);
  }
}

TEST(PointSphereTree, ClustersOfALevelPartitionThePoints) {
  for (const std::uint32_t count : kCounts) {
    const PointSphereTree tree = build(random_points(count, 41)).tree;
    for (int level = 1; level <= 8; ++level) {
      std::uint32_t next = 0;
      for (std::uint64_t i = 0; i < PointSphereTree::cluster_count(level); ++i) {
        const PointRange range = tree.cluster_points(level, i);
        ASSERT_EQ(range.begin, next);
        ASSERT_GE(range.end, range.begin);
        next = range.end;
      }
      EXPECT_EQ(next, count);
    }
  }
}

TEST(PointSphereTree, FourChildrenMakeUpTheirParent) {
  for (const std::uint32_t count : kCounts) {
    const PointSphereTree tree = build(random_points(count, 42)).tree;
    for (int level = 1; level < PointSphereTree::kMaxLevel; ++level) {
      const std::uint64_t clusters = PointSphereTree::cluster_count(level);
      const std::uint64_t stride = std::max<std::uint64_t>(1, clusters / 5000);
      for (std::uint64_t i = 0; i < clusters; i += stride) {
        const PointRange parent = tree.cluster_points(level, i);
        EXPECT_EQ(tree.cluster_points(level + 1, 4 * i).begin, parent.begin);
        EXPECT_EQ(tree.cluster_points(level + 1, 4 * i + 3).end, parent.end);
      }
    }
  }
}

TEST(PointSphereTree, SegmentIsTheClusterThatHoldsAPoint) {
  for (const std::uint32_t count : kCounts) {
    const PointSphereTree tree = build(random_points(count, 43)).tree;
    for (int level = 1; level <= PointSphereTree::kMaxLevel; ++level) {
      std::uint32_t last = 0;
      for (std::uint32_t id = 0; id < count; ++id) {
        const std::uint32_t segment = tree.segment(id, level);
        ASSERT_LT(segment, PointSphereTree::cluster_count(level));
        ASSERT_GE(segment, last);
        const PointRange range = tree.cluster_points(level, segment);
        ASSERT_LE(range.begin, id) << count << " points, level " << level;
        ASSERT_GT(range.end, id) << count << " points, level " << level;
        last = segment;
      }
    }
  }
}

TEST(PointSphereTree, EveryLevelCountsFourTimesTheClusters) {
  EXPECT_EQ(PointSphereTree::cluster_count(1), 1u);
  EXPECT_EQ(PointSphereTree::cluster_count(2), 4u);
  EXPECT_EQ(PointSphereTree::cluster_count(5), 256u);
  EXPECT_EQ(PointSphereTree::cluster_count(PointSphereTree::kMaxLevel), 4'194'304u);
  const PointSphereTree tree = build(random_points(799, 44)).tree;
  EXPECT_EQ(tree.level_count(), 4);  // 64 clusters share 100 buckets; 256 could not
  for (int level = 1; level <= tree.level_count(); ++level) {
    EXPECT_EQ(tree.spheres(level).size(), PointSphereTree::cluster_count(level));
  }
}

TEST(PointSphereTree, ClustersWithSpheresShareTheBucketsEvenly) {
  for (const std::uint32_t count : kCounts) {
    const PointSphereTree tree = build(random_points(count, 45)).tree;
    EXPECT_EQ(tree.bucket_count(), (count + 7) / 8);
    for (int level = 1; level <= tree.level_count(); ++level) {
      const std::uint64_t clusters = PointSphereTree::cluster_count(level);
      const std::uint32_t fewest = tree.bucket_count() / static_cast<std::uint32_t>(clusters);
      EXPECT_GE(fewest, 1u);
      for (std::uint64_t i = 0; i < clusters; ++i) {
        const PointRange range = tree.cluster_points(level, i);
        EXPECT_EQ(range.begin % PointSphereTree::kBucketPoints, 0u);
        const std::uint32_t buckets = (range.size() + 7) / 8;
        EXPECT_GE(buckets, fewest);
        EXPECT_LE(buckets, fewest + 1);
      }
    }
  }
}

TEST(PointSphereTree, WalkEndsAtSlotsOfAtMostTwoFullBuckets) {
  for (const std::uint32_t count : kCounts) {
    const BuiltTree built = build(random_points(count, 50));
    const simd::TreeView view = built.tree.view();
    const std::uint64_t slots = std::uint64_t{1} << view.depth;
    EXPECT_LE(4 * built.tree.bucket_count(), 6 * slots);
    EXPECT_GE(4 * built.tree.bucket_count(), slots == 1 ? 4 : 3 * slots);
    for (std::uint32_t i = 0; i < count; ++i) {
      const float* bucket = view.buckets + i / 8 * simd::kBucketFloats;
      const Vec3f in_bucket{bucket[i % 8], bucket[8 + i % 8], bucket[16 + i % 8]};
      ASSERT_EQ(in_bucket, built.points[built.order[i]]);
    }
    for (std::uint32_t i = count; i % 8 != 0; ++i) {
      ASSERT_TRUE(std::isnan(view.buckets[i / 8 * simd::kBucketFloats + i % 8]));
    }
  }
}

TEST(PointSphereTree, SpheresOfTheWalkEncloseTheirPoints) {
  for (const std::uint32_t count : kCounts) {
    const BuiltTree built = build(random_points(count, 51));
    const simd::TreeView view = built.tree.view();
    for (int level = 0; level < view.level_count; ++level) {
      const int depth = view.depth - 3 * (view.level_count - 1 - level);
      const std::uint64_t clusters = std::uint64_t{1} << depth;
      std::uint64_t empty = 0;
      for (std::uint64_t i = 0; i < std::max<std::uint64_t>(clusters, 8); ++i) {
        const float* block =
            view.blocks + (view.first_block[level] + i / 8) * simd::kClusterBlockFloats;
        const Vec3f center{block[i % 8], block[8 + i % 8], block[16 + i % 8]};
        const float radius = block[24 + i % 8];
        const auto first = [&](std::uint64_t c) {
          return std::min<std::uint64_t>(count, 8 * ((view.bucket_count * c) >> depth));
        };
        if (i >= clusters || first(i) == first(i + 1)) {
          ASSERT_EQ(radius, simd::kNoSphere);
          ++empty;
          continue;
        }
        for (std::uint64_t id = first(i); id < first(i + 1); ++id) {
          ASSERT_LE(distance_between(built.points[built.order[id]], center),
                    static_cast<double>(radius));
        }
      }
      EXPECT_LE(4 * empty, std::max<std::uint64_t>(4 * 7, clusters));
    }
  }
}

TEST(PointSphereTree, IsTheSameOnAnyNumberOfThreads) {
  const std::vector<Vec3f> points = random_points(5003, 52);
  const BuiltTree one = build(points);
  for (const unsigned threads : {1u, 2u, 7u}) {
    std::vector<std::uint32_t> order(points.size());
    std::iota(order.begin(), order.end(), 0u);
    const PointSphereTree tree = PointSphereTree::build(points, order, {}, threads);
    EXPECT_EQ(order, one.order);
    ASSERT_EQ(tree.nbytes(), one.tree.nbytes());
    for (int level = 1; level <= tree.level_count(); ++level) {
      for (std::uint64_t i = 0; i < PointSphereTree::cluster_count(level); ++i) {
        EXPECT_EQ(tree.spheres(level)[i].center, one.tree.spheres(level)[i].center);
        EXPECT_EQ(tree.spheres(level)[i].radius, one.tree.spheres(level)[i].radius);
      }
    }
  }
}

TEST(PointSphereTree, SpheresEncloseTheirPointsAndAreNotLargerThanNeeded) {
  for (const std::uint32_t count : kCounts) {
    const BuiltTree built = build(random_points(count, 46));
    for (int level = 1; level <= built.tree.level_count(); ++level) {
      const auto spheres = built.tree.spheres(level);
      for (std::uint64_t i = 0; i < spheres.size(); ++i) {
        const PointRange range = built.tree.cluster_points(level, i);
        double farthest = 0.0;
        double widest = 0.0;
        for (std::uint32_t id = range.begin; id < range.end; ++id) {
          const Vec3f& p = built.points[built.order[id]];
          farthest = std::max(farthest, distance_between(p, spheres[i].center));
          widest = std::max(widest, distance_between(p, built.points[built.order[range.begin]]));
        }
        ASSERT_LE(farthest, static_cast<double>(spheres[i].radius));
        // Jung: the smallest sphere of points that are at most w apart has radius sqrt(3/8) w.
        ASSERT_LE(spheres[i].radius, std::sqrt(0.375) * 2.0 * widest + 1e-6);
        ASSERT_LE(static_cast<double>(spheres[i].radius), farthest * (1 + 3e-7) + 1e-30);
      }
    }
  }
}

TEST(PointSphereTree, SplitsAtTheMedianOfTheLongestAxis) {
  // Points along y: the four clusters below the root must be four stretches of y.
  std::vector<Vec3f> points;
  Random random(47);
  for (int i = 0; i < 400; ++i) {
    points.push_back(static_cast<Vec3f>(random.in_box({0, 0, 0}, {1, 100, 1})));
  }
  const BuiltTree built = build(points);
  float reached = -1.0f;
  for (std::uint64_t i = 0; i < 4; ++i) {
    const PointRange range = built.tree.cluster_points(2, i);
    float low = 1000.0f;
    float high = -1000.0f;
    for (std::uint32_t id = range.begin; id < range.end; ++id) {
      low = std::min(low, points[built.order[id]].y);
      high = std::max(high, points[built.order[id]].y);
    }
    EXPECT_GE(low, reached);
    reached = high;
  }
}

TEST(PointSphereTree, IsTheSameOnEveryBuildAndWithTies) {
  // A lattice, each place three times: all medians tie.
  std::vector<Vec3f> points;
  for (int copy = 0; copy < 3; ++copy) {
    for (int i = 0; i < 7; ++i) {
      for (int j = 0; j < 7; ++j) {
        for (int k = 0; k < 7; ++k) {
          points.push_back({static_cast<float>(i), static_cast<float>(j), static_cast<float>(k)});
        }
      }
    }
  }
  const BuiltTree first = build(points);
  const BuiltTree second = build(points);
  EXPECT_EQ(first.order, second.order);
  for (int level = 1; level <= first.tree.level_count(); ++level) {
    for (std::uint64_t i = 0; i < PointSphereTree::cluster_count(level); ++i) {
      EXPECT_EQ(first.tree.spheres(level)[i].center, second.tree.spheres(level)[i].center);
      EXPECT_EQ(first.tree.spheres(level)[i].radius, second.tree.spheres(level)[i].radius);
    }
  }
}

TEST(PointSphereTree, OrderDoesNotDependOnTheOrderGiven) {
  std::vector<Vec3f> lattice;
  for (int i = 0; i < 900; ++i) {
    lattice.push_back({static_cast<float>(i % 10), static_cast<float>(i / 10 % 10),
                       static_cast<float>(i / 100 % 3)});
  }
  // The lattice is full of ties, and each of its places is taken three times.
  for (const std::vector<Vec3f>& points : {random_points(799, 48), lattice}) {
    const BuiltTree built = build(points);
    std::vector<std::uint32_t> shuffled(points.size());
    std::iota(shuffled.begin(), shuffled.end(), 0u);
    Random random(49);
    for (std::size_t i = shuffled.size(); i > 1; --i) {
      std::swap(shuffled[i - 1], shuffled[random.below(i)]);
    }
    PointSphereTree::build(points, shuffled);
    EXPECT_EQ(shuffled, built.order);
  }
}

TEST(PointSphereTree, TakesPointsThatAllLieAtOnePlace) {
  const BuiltTree built = build(std::vector<Vec3f>(100, Vec3f{1, 2, 3}));
  for (const Sphere& sphere : built.tree.spheres(built.tree.level_count())) {
    EXPECT_EQ(sphere.center, (Vec3f{1, 2, 3}));
    EXPECT_LE(sphere.radius, 1e-30f);
  }
}

}  // namespace
}  // namespace voxshell::point_sphere_tree_test
