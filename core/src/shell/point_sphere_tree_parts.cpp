#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/text.h"
#include "simd/tree_view.h"
#include "voxshell/point_sphere_tree.h"

namespace voxshell {
namespace {

Error invalid(std::string message) { return {ErrorCode::kInvalidArgument, std::move(message)}; }

Sphere read_sphere(std::span<const float> blocks, std::size_t block, std::size_t place) {
  const auto numbers = blocks.subspan(block * simd::kClusterBlockFloats + place);
  return {{numbers[0], numbers[8], numbers[16]}, numbers[24]};
}

/// Whether the slab at a place of a block, about the sphere's center, is around the points.
bool slab_encloses(std::span<const float> blocks, std::size_t block, std::size_t place,
                   const Sphere& sphere, std::span<const Vec3f> points) {
  const auto numbers =
      blocks.subspan(block * simd::kClusterBlockFloats + simd::kSlabFloats + place);
  const Vec3f normal{numbers[0], numbers[8], numbers[16]};
  const auto half_thickness = static_cast<double>(numbers[24]);
  constexpr float kRounding = 1e-6f;
  if (!is_finite(normal) || !std::isfinite(half_thickness)) return false;
  if (!(std::abs(length(normal) - 1.0f) <= kRounding) && normal != Vec3f{}) return false;
  double farthest = 0.0;
  for (const Vec3f& p : points) {
    const Vec3 off_center = static_cast<Vec3>(p) - static_cast<Vec3>(sphere.center);
    farthest = std::max(farthest, std::abs(dot(static_cast<Vec3>(normal), off_center)));
  }
  return farthest <= half_thickness;
}

bool encloses(const Sphere& sphere, std::span<const Vec3f> points) {
  if (!is_finite(sphere.center) || !std::isfinite(sphere.radius) || !(sphere.radius >= 0.0f)) {
    return false;
  }
  // Of the float64 arithmetic here; the radius itself is rounded up.
  constexpr double kRounding = 1e-12;
  const auto center = static_cast<Vec3>(sphere.center);
  const auto radius = static_cast<double>(sphere.radius);
  const double limit = radius * radius * (1.0 + kRounding);
  double farthest = 0.0;
  for (const Vec3f& p : points) {
    const double squared = squared_length(static_cast<Vec3>(p) - center);
    farthest = squared > farthest ? squared : farthest;
  }
  return farthest <= limit;
}

}  // namespace

Result<PointSphereTree> PointSphereTree::from_parts(std::span<const Vec3f> points,
                                                    std::vector<Sphere> spheres,
                                                    std::vector<float> blocks) {
  constexpr std::size_t kMostPoints = std::size_t{1} << 28;  // a walk's levels hold more
  if (points.empty() || points.size() > kMostPoints) {
    return invalid(format_text("it is of %zu points", points.size()));
  }
  PointSphereTree tree(static_cast<std::uint32_t>(points.size()));
  if (spheres.size() != tree.sphere_count() ||
      blocks.size() != tree.block_count() * simd::kClusterBlockFloats) {
    return invalid(
        format_text("a tree of %zu points has %zu spheres and %zu numbers in blocks, "
                    "not %zu and %zu",
                    points.size(), tree.sphere_count(),
                    tree.block_count() * simd::kClusterBlockFloats, spheres.size(), blocks.size()));
  }
  tree.spheres_ = std::move(spheres);
  tree.blocks_.assign(blocks.begin(), blocks.end());
  const auto points_in = [&](int depth, std::uint64_t index) {
    const PointRange range = tree.points_between(depth, index);
    return points.subspan(range.begin, range.size());
  };
  for (int level = 1; level <= tree.level_count_; ++level) {
    for (std::uint64_t i = 0; i < cluster_count(level); ++i) {
      if (!encloses(tree.spheres(level)[i], points_in(2 * (level - 1), i))) {
        return invalid(
            format_text("the sphere of cluster %llu on level %d is not around its points",
                        static_cast<unsigned long long>(i), level));
      }
    }
  }
  std::size_t first_block = 0;
  for (int level = 0; level < tree.walk_level_count(); ++level) {
    const std::size_t clusters = std::size_t{1} << tree.walk_depth(level);
    const std::size_t slots = (clusters + 7) / 8 * 8;
    for (std::size_t i = 0; i < slots; ++i) {
      const Sphere sphere = read_sphere(tree.blocks_, first_block + i / 8, i % 8);
      const auto below =
          i < clusters ? points_in(tree.walk_depth(level), i) : std::span<const Vec3f>{};
      if (below.empty()
              ? sphere.radius != simd::kNoSphere || !is_finite(sphere.center)
              : !encloses(sphere, below) ||
                    !slab_encloses(tree.blocks_, first_block + i / 8, i % 8, sphere, below)) {
        return invalid(
            format_text("sphere %zu on level %d of the walk is not around its points", i, level));
      }
    }
    first_block += slots / 8;
  }
  tree.fill_buckets(points);
  return tree;
}

}  // namespace voxshell
