#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "voxshell/progress.h"
#include "voxshell/vector.h"

namespace voxshell {

struct Sphere {
  Vec3f centre{};
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
/// so level L has 4^(L-1) clusters.
///
/// The points lie in tree order, which makes a cluster a range of ids that a formula gives: of n
/// points, cluster i of m on a level covers [floor(n i / m), floor(n (i + 1) / m)).
class PointSphereTree {
 public:
  static constexpr std::uint32_t kBranching = 4;
  /// Leaves hold at most this many points, unless there are more than kMaxLevel levels could hold.
  static constexpr std::uint32_t kLeafPoints = 8;
  static constexpr int kMaxLevel = 12;  ///< 4^11 = 4,194,304 clusters

  PointSphereTree() = default;

  /// Puts `order` (point indices) into tree order and encloses each cluster. Deterministic.
  /// A tree without points where `progress` asked to stop.
  static PointSphereTree build(std::span<const Vec3f> points, std::vector<std::uint32_t>& order,
                               const Progress& progress = {});

  /// Levels with spheres; the last one holds the leaves.
  int level_count() const { return level_count_; }
  std::uint32_t point_count() const { return point_count_; }

  static std::uint64_t cluster_count(int level) { return std::uint64_t{1} << (2 * (level - 1)); }

  /// Points of cluster `index` on `level`; defined to kMaxLevel, beyond the last sphere, too.
  PointRange cluster_points(int level, std::uint64_t index) const {
    const auto n = std::uint64_t{point_count_};
    const int shift = 2 * (level - 1);
    return {static_cast<std::uint32_t>((n * index) >> shift),
            static_cast<std::uint32_t>((n * (index + 1)) >> shift)};
  }

  /// The cluster on `level` that holds point `id`: the segment of a contact.
  std::uint32_t segment(std::uint32_t id, int level) const {
    const std::uint64_t scaled = (std::uint64_t{id} + 1) << (2 * (level - 1));
    return static_cast<std::uint32_t>((scaled - 1) / point_count_);
  }

  /// One sphere a cluster; level 1 to level_count().
  std::span<const Sphere> spheres(int level) const {
    return std::span(spheres_).subspan(first_sphere(level), cluster_count(level));
  }

 private:
  static std::size_t first_sphere(int level) { return (cluster_count(level) - 1) / 3; }

  std::uint32_t point_count_ = 0;
  int level_count_ = 0;
  std::vector<Sphere> spheres_;  ///< level by level
};

}  // namespace voxshell
