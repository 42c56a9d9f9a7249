#include "voxshell/point_sphere_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/serial.h"
#include "shell/enclosing_sphere.h"
#include "simd/tree_view.h"
#include "voxshell/bounds.h"
#include "voxshell/parallel.h"

namespace voxshell {

/// Builds on binary clusters: cluster i of 2^depth.
class TreeBuilder {
 public:
  TreeBuilder(std::span<const Vec3f> points, std::span<const Vec3f> normals,
              std::vector<std::uint32_t>& order, const Progress& progress, unsigned threads)
      : points_(points),
        normals_(normals),
        order_(order),
        progress_(progress),
        threads_(threads),
        tree_(static_cast<std::uint32_t>(order.size())) {}

  PointSphereTree build() {
    if (!sort_points() || !enclose_clusters()) return {};
    std::vector<Vec3f> sorted;
    sorted.reserve(order_.size());
    for (const std::uint32_t id : order_) sorted.push_back(points_[id]);
    tree_.fill_buckets(sorted);
    return std::move(tree_);
  }

 private:
  /// Puts the points of each bucket together. Subtrees of the upper levels are independent.
  bool sort_points() {
    constexpr int kSerialDepth = 4;
    const int serial = std::min(kSerialDepth, tree_.depth_);
    for (int depth = 0; depth < serial; ++depth) {
      const std::uint64_t clusters = std::uint64_t{1} << depth;
      if (!parallel_for(clusters, threads_, kStage, scaled(0.1 * depth / serial, 0.1 / serial),
                        [&](std::size_t i) { split_once(i, depth); })) {
        return false;
      }
    }
    return parallel_for(std::size_t{1} << serial, threads_, kStage, scaled(0.1, 0.2),
                        [&](std::size_t i) { split(i, serial); });
  }

  void split(std::uint64_t index, int depth) {
    const PointRange range = tree_.points_between(depth, index);
    if (range.size() <= PointSphereTree::kBucketPoints) {
      // A set has one order.
      std::sort(order_.begin() + range.begin, order_.begin() + range.end);
      return;
    }
    split_once(index, depth);
    split(2 * index, depth + 1);
    split(2 * index + 1, depth + 1);
  }

  /// Halves a cluster at the median along its longest axis. Ids settle ties, so the order is the
  /// same everywhere.
  void split_once(std::uint64_t index, int depth) {
    const PointRange range = tree_.points_between(depth, index);
    const std::uint32_t middle = tree_.first_point(depth + 1, 2 * index + 1);
    if (middle == range.begin || middle == range.end) return;
    Bounds bounds;
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      bounds.extend(static_cast<Vec3>(points_[order_[i]]));
    }
    const int axis = bounds.longest_axis();
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
      const float ca = points_[a][axis];
      const float cb = points_[b][axis];
      return ca != cb ? ca < cb : a < b;
    };
    std::nth_element(order_.begin() + range.begin, order_.begin() + middle,
                     order_.begin() + range.end, before);
  }

  bool enclose_clusters() {
    tree_.spheres_.resize(tree_.sphere_count());
    tree_.blocks_.assign(tree_.block_count() * simd::kClusterBlockFloats, 0.0f);
    std::size_t first_block = 0;
    // The depths of levels (0, 2, 4, ...) and of the walk (..., depth - 3, depth), each once.
    for (int depth = 0; depth <= tree_.depth_; ++depth) {
      const bool is_level = depth % 2 == 0 && depth / 2 < tree_.level_count_;
      const bool is_walked = (tree_.depth_ - depth) % 3 == 0 && (depth > 0 || tree_.depth_ == 0);
      if (!is_level && !is_walked) continue;
      const std::size_t clusters = std::size_t{1} << depth;
      const std::size_t first_sphere = is_level ? (clusters - 1) / 3 : 0;
      // Many small clusters a task, or one large one.
      const std::size_t tasks = std::min<std::size_t>(clusters, 256);
      const std::size_t padded = is_walked ? (clusters + 7) / 8 * 8 : clusters;
      const auto enclose = [&](std::size_t task) {
        const std::size_t end = task + 1 == tasks ? padded : clusters * (task + 1) / tasks;
        for (std::size_t i = clusters * task / tasks; i < end; ++i) {
          Sphere sphere{{}, simd::kNoSphere};
          Slab slab;
          if (i < clusters) {
            const PointRange range = tree_.points_between(depth, i);
            if (range.size() > 0) {
              sphere = compute_enclosing_sphere(
                  points_, std::span(order_).subspan(range.begin, range.size()));
              if (is_walked) slab = compute_slab(range, sphere);
            }
          }
          if (is_level && i < clusters) tree_.spheres_[first_sphere + i] = sphere;
          if (is_walked) put(first_block, i, sphere, slab);
        }
      };
      const double fraction = 0.7 / (tree_.depth_ + 1);
      if (!parallel_for(tasks, threads_, kStage, scaled(0.3 + fraction * depth, fraction),
                        enclose)) {
        return false;
      }
      if (is_walked) first_block += padded / 8;
    }
    return true;
  }

  /// The points about a plane through their sphere's center.
  struct Slab {
    Vec3f normal{};
    float half_thickness = 0.0f;
  };

  Slab compute_slab(const PointRange& range, const Sphere& sphere) const {
    if (normals_.empty()) return {{}, sphere.radius};
    Vec3 sum{};
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      sum += static_cast<Vec3>(normals_[order_[i]]);
    }
    const auto normal = static_cast<Vec3f>(normalized(sum));
    double half_thickness = 0.0;
    for (std::uint32_t i = range.begin; i < range.end; ++i) {
      const Vec3 off_center =
          static_cast<Vec3>(points_[order_[i]]) - static_cast<Vec3>(sphere.center);
      half_thickness =
          std::max(half_thickness, std::abs(dot(static_cast<Vec3>(normal), off_center)));
    }
    constexpr double kRoundUp = 1.0 + 1e-6;
    return {normal, static_cast<float>(half_thickness * kRoundUp)};
  }

  void put(std::size_t first_block, std::size_t index, const Sphere& sphere, const Slab& slab) {
    float* block = &tree_.blocks_[(first_block + index / 8) * simd::kClusterBlockFloats];
    block[index % 8] = sphere.center.x;
    block[8 + index % 8] = sphere.center.y;
    block[16 + index % 8] = sphere.center.z;
    block[24 + index % 8] = sphere.radius;
    block += simd::kSlabFloats;
    block[index % 8] = slab.normal.x;
    block[8 + index % 8] = slab.normal.y;
    block[16 + index % 8] = slab.normal.z;
    block[24 + index % 8] = slab.half_thickness;
  }

  /// Progress of one part of the build.
  Progress scaled(double from, double fraction) const {
    if (!progress_) return {};
    return [this, from, fraction](std::string_view stage, double done) {
      return progress_(stage, std::min(1.0, from + fraction * done));
    };
  }

  static constexpr const char* kStage = "point-sphere tree";

  std::span<const Vec3f> points_;
  std::span<const Vec3f> normals_;  ///< may be empty
  std::vector<std::uint32_t>& order_;
  const Progress& progress_;
  unsigned threads_;
  PointSphereTree tree_;
};

PointSphereTree PointSphereTree::build(std::span<const Vec3f> points,
                                       std::vector<std::uint32_t>& order, const Progress& progress,
                                       unsigned threads, std::span<const Vec3f> normals) {
  return TreeBuilder(points, normals, order, progress, threads).build();
}

PointSphereTree::PointSphereTree(std::uint32_t point_count)
    : serial_(next_serial()),
      point_count_(point_count),
      bucket_count_(point_count / kBucketPoints + (point_count % kBucketPoints == 0 ? 0 : 1)),
      level_count_(1) {
  while (level_count_ < kMaxLevel && cluster_count(level_count_ + 1) <= bucket_count_) {
    ++level_count_;
  }
  // Between 3/4 and 3/2 buckets a slot: neither many empty ones nor many that hold two.
  while (2 * std::uint64_t{bucket_count_} > 3 * (std::uint64_t{1} << depth_)) ++depth_;
}

int PointSphereTree::walk_level_count() const { return std::max(1, (depth_ + 2) / 3); }

std::size_t PointSphereTree::block_count() const {
  std::size_t blocks = 0;
  for (int level = 0; level < walk_level_count(); ++level) {
    blocks += ((std::size_t{1} << walk_depth(level)) + 7) / 8;
  }
  return blocks;
}

void PointSphereTree::fill_buckets(std::span<const Vec3f> points) {
  bucket_points_.assign(std::size_t{bucket_count_} * simd::kBucketFloats,
                        std::numeric_limits<float>::quiet_NaN());
  for (std::size_t i = 0; i < points.size(); ++i) {
    float* bucket = &bucket_points_[i / 8 * simd::kBucketFloats];
    for (int axis = 0; axis < 3; ++axis) {
      bucket[8 * static_cast<std::size_t>(axis) + i % 8] = points[i][axis];
    }
  }
}

std::size_t PointSphereTree::nbytes() const {
  return spheres_.size() * sizeof(Sphere) +
         (blocks_.size() + bucket_points_.size()) * sizeof(float);
}

simd::TreeView PointSphereTree::view() const {
  simd::TreeView view{};
  view.serial = serial_;
  view.blocks = blocks_.data();
  view.buckets = bucket_points_.data();
  view.depth = depth_;
  view.level_count = walk_level_count();
  view.point_count = point_count_;
  view.bucket_count = bucket_count_;
  std::uint32_t block = 0;
  for (int level = 0; level < view.level_count; ++level) {
    view.first_block[level] = block;
    block += ((1u << walk_depth(level)) + 7) / 8;
  }
  return view;
}

}  // namespace voxshell
