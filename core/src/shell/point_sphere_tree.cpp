#include "voxshell/point_sphere_tree.h"

#include <algorithm>

#include "base/stage.h"
#include "shell/enclosing_sphere.h"
#include "voxshell/bounds.h"

namespace voxshell {
namespace {

/// Splits order[begin, end), which is cluster `index` of 2^depth, down to 2^max_depth clusters, at
/// the medians along the longest axis. Ids settle ties, so the order is the same everywhere.
void split(std::span<const Vec3f> points, std::vector<std::uint32_t>& order, std::uint64_t index,
           int depth, int max_depth, Stage& stage) {
  stage.report(0.0);
  if (stage.stopped()) return;
  const std::uint64_t n = order.size();
  const auto boundary = [&](std::uint64_t i, int level) {
    return order.begin() + static_cast<std::ptrdiff_t>((n * i) >> level);
  };
  const auto begin = boundary(index, depth);
  const auto end = boundary(index + 1, depth);
  if (depth == max_depth) {
    std::sort(begin, end);
    return;
  }
  Bounds bounds;
  for (auto id = begin; id != end; ++id) bounds.extend(static_cast<Vec3>(points[*id]));
  const int axis = bounds.longest_axis();
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    const float ca = points[a][axis];
    const float cb = points[b][axis];
    return ca != cb ? ca < cb : a < b;
  };
  std::nth_element(begin, boundary(2 * index + 1, depth + 1), end, before);
  split(points, order, 2 * index, depth + 1, max_depth, stage);
  split(points, order, 2 * index + 1, depth + 1, max_depth, stage);
}

}  // namespace

PointSphereTree PointSphereTree::build(std::span<const Vec3f> points,
                                       std::vector<std::uint32_t>& order,
                                       const Progress& progress) {
  Stage stage(progress, "point-sphere tree");
  PointSphereTree tree;
  tree.point_count_ = static_cast<std::uint32_t>(order.size());
  tree.level_count_ = 1;
  while (tree.level_count_ < kMaxLevel &&
         tree.point_count_ > kLeafPoints * cluster_count(tree.level_count_)) {
    ++tree.level_count_;
  }
  split(points, order, 0, 0, 2 * (tree.level_count_ - 1), stage);

  tree.spheres_.reserve(first_sphere(tree.level_count_ + 1));
  for (int level = 1; level <= tree.level_count_; ++level) {
    const auto clusters = static_cast<double>(cluster_count(level));
    for (std::uint64_t i = 0; i < cluster_count(level); ++i) {
      const PointRange range = tree.cluster_points(level, i);
      tree.spheres_.push_back(
          compute_enclosing_sphere(points, std::span(order).subspan(range.begin, range.size())));
      stage.report((level - 1 + static_cast<double>(i + 1) / clusters) / tree.level_count_);
      if (stage.stopped()) return {};
    }
  }
  return tree;
}

}  // namespace voxshell
