#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "voxshell/bucket_points.h"
#include "voxshell/cache_lines.h"
#include "voxshell/progress.h"
#include "voxshell/result.h"
#include "voxshell/vector.h"

namespace voxshell {

namespace simd {
struct TreeView;
}

struct Sphere {
  Vec3f center{};
  float radius = 0.0f;
};

/// The half-open range of point ids of one cluster.
struct PointRange {
  std::uint32_t begin;
  std::uint32_t end;

  std::uint32_t size() const { return end - begin; }
};

/// A point-sphere tree: nested clusters of a point shell, each with the minimal sphere that
/// encloses its points. Branching factor 4 (thesis, section 5.3); levels count from the root = 1,
/// so level L has at most 4^(L-1) clusters.
///
/// The points lie in tree order, in buckets of kBucketPoints, so a formula gives the range of ids
/// of a cluster: of b buckets, cluster i of m on a level covers [floor(b i / m), floor(b (i + 1) /
/// m)). Queries walk eight clusters at a time: every third level of the binary tree that the same
/// formula gives for m = 2, 4, 8, ...
class PointSphereTree {
 public:
  static constexpr std::uint32_t kBranching = 4;
  static constexpr std::uint32_t kBucketPoints = BucketPoints::kEach;
  static constexpr int kMaxLevel = 12;  ///< 4^11 = 4,194,304 clusters

  PointSphereTree() = default;

  /// Puts `order` (point indices) into tree order and encloses each cluster. Deterministic for any
  /// number of threads (0: one per core). Returns a tree without points if `progress` asked to
  /// stop. `normals` of the points, if given, make queries against planes faster.
  static PointSphereTree build(std::span<const Vec3f> points, std::vector<std::uint32_t>& order,
                               const Progress& progress = {}, unsigned threads = 0,
                               std::span<const Vec3f> normals = {});

  /// Builds a tree from the results of spheres() and blocks() for these points. Checks the number
  /// of spheres, that values are finite, and that each sphere encloses its points. Error:
  /// kInvalidArgument.
  static Result<PointSphereTree> from_parts(std::span<const Vec3f> points,
                                            std::vector<Sphere> spheres, std::vector<float> blocks);

  std::uint32_t point_count() const { return point_count_; }
  std::uint32_t bucket_count() const { return bucket_count_; }
  BucketPoints points() const { return {bucket_points_.data(), point_count_}; }

  /// Levels with spheres: those with a bucket for each cluster.
  int level_count() const { return level_count_; }

  static std::uint64_t cluster_count(int level) { return std::uint64_t{1} << (2 * (level - 1)); }

  /// Points of cluster `index` on `level`; defined to kMaxLevel. Beyond level_count() clusters may
  /// be empty.
  PointRange cluster_points(int level, std::uint64_t index) const {
    return points_between(2 * (level - 1), index);
  }

  /// The cluster on `level` that holds point `id`: the segment of a contact.
  std::uint32_t segment(std::uint32_t id, int level) const {
    const std::uint64_t scaled = (std::uint64_t{id / kBucketPoints} + 1) << (2 * (level - 1));
    return static_cast<std::uint32_t>((scaled - 1) / bucket_count_);
  }

  /// One sphere per cluster; level 1 to level_count().
  std::span<const Sphere> spheres(int level) const {
    return std::span(spheres_).subspan((cluster_count(level) - 1) / 3, cluster_count(level));
  }

  /// The spheres of all levels, from the root on.
  std::span<const Sphere> spheres() const { return spheres_; }
  /// The spheres that queries walk; see simd/tree_view.h.
  std::span<const float> blocks() const { return blocks_; }

  std::size_t nbytes() const;
  simd::TreeView view() const;

 private:
  /// Points of cluster `index` of 2^depth.
  PointRange points_between(int depth, std::uint64_t index) const {
    return {first_point(depth, index), first_point(depth, index + 1)};
  }
  std::uint32_t first_point(int depth, std::uint64_t index) const {
    const std::uint64_t point = kBucketPoints * ((bucket_count_ * index) >> depth);
    return point < point_count_ ? static_cast<std::uint32_t>(point) : point_count_;
  }

  /// All that follows from the number of points.
  explicit PointSphereTree(std::uint32_t point_count);
  int walk_level_count() const;
  /// Of the walk's level, from 0 on.
  int walk_depth(int level) const { return depth_ - 3 * (walk_level_count() - 1 - level); }
  std::size_t sphere_count() const { return (cluster_count(level_count_ + 1) - 1) / 3; }
  std::size_t block_count() const;
  void fill_buckets(std::span<const Vec3f> points);

  friend class TreeBuilder;

  std::uint64_t serial_ = 0;
  std::uint32_t point_count_ = 0;
  std::uint32_t bucket_count_ = 0;
  int level_count_ = 0;
  int depth_ = 0;  ///< the walk ends at 2^depth_ clusters of at most two buckets
  using Floats = std::vector<float, LineAllocator<float>>;
  std::vector<Sphere> spheres_;  ///< level by level
  Floats blocks_;                ///< the walk's spheres; see simd/tree_view.h
  Floats bucket_points_;         ///< the points, bucket by bucket
};

}  // namespace voxshell
