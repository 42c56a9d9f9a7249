#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "mesh/box_hierarchy.h"
#include "voxshell/bounds.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell {

inline bool do_meet(const Bounds& a, const Bounds& b) {
  return a.lower.x <= b.upper.x && b.lower.x <= a.upper.x && a.lower.y <= b.upper.y &&
         b.lower.y <= a.upper.y && a.lower.z <= b.upper.z && b.lower.z <= a.upper.z;
}

inline Bounds widen(const Bounds& box, double by) {
  const Vec3 margin{by, by, by};
  return {box.lower - margin, box.upper + margin};
}

inline Bounds bound_triangle(const std::array<Vec3, 3>& corners) {
  Bounds box;
  for (const Vec3& corner : corners) box.extend(corner);
  return box;
}

/// Finds boxes that meet a box.
class BoxFinder {
 public:
  explicit BoxFinder(std::vector<Bounds> boxes)
      : boxes_(std::move(boxes)), order_(order(boxes_)), hierarchy_(sort(boxes_, order_), 0.0) {}

  /// Calls `visit(i)` for the boxes that meet `box`. The order does not depend on it: boxes that
  /// meet two boxes come in the same order for both.
  template <class Visit>
  void visit(const Bounds& box, const Visit& visit_box) const {
    search(box, [&](std::size_t begin, std::size_t end, float& /*limit*/) {
      for (std::size_t i = begin; i < end; ++i) {
        if (do_meet(box, boxes_[order_[i]])) visit_box(order_[i]);
      }
    });
  }

  /// Finds the boxes that meet `box`, in the order of visit(). False, with some of them, where it
  /// would have to look at more than about `most`.
  bool find(const Bounds& box, std::size_t most, std::vector<std::uint32_t>& found) const {
    std::size_t looked_at = 0;
    found.clear();
    search(box, [&](std::size_t begin, std::size_t end, float& limit) {
      for (std::size_t i = begin; i < end; ++i) {
        if (do_meet(box, boxes_[order_[i]])) found.push_back(order_[i]);
      }
      looked_at += end - begin;
      if (looked_at > most) limit = -1.0f;  // nothing is as near
    });
    return looked_at <= most;
  }

  const Bounds& box(std::uint32_t i) const { return boxes_[i]; }

 private:
  /// Calls `visit_run(begin, end, limit)` for runs of the order that may hold boxes which meet
  /// `box`. Those that do hold some come in descending order: all the boxes around them meet it
  /// after the rounding, too, and of what is equally near the hierarchy takes the last first.
  template <class VisitRun>
  void search(const Bounds& box, const VisitRun& visit_run) const {
    const auto lower = static_cast<Vec3f>(box.lower);
    const auto upper = static_cast<Vec3f>(box.upper);
    const auto measure = [&](const BoxHierarchy::Node& node) {
      using namespace simd::portable;
      F8 gap{};
      for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        gap = maximum(gap, maximum(node.lower[a] - upper[axis], lower[axis] - node.upper[a]));
      }
      return gap;
    };
    // Rounding of the box itself to float32.
    float limit = 1e-6f * static_cast<float>(length(box.lower) + length(box.upper));
    hierarchy_.search(limit, measure, [&](std::size_t run) {
      const std::size_t begin = run * BoxHierarchy::kEach;
      visit_run(begin, std::min(begin + BoxHierarchy::kEach, order_.size()), limit);
    });
  }

  static std::vector<std::uint32_t> order(const std::vector<Bounds>& boxes) {
    std::vector<Vec3> middles;
    middles.reserve(boxes.size());
    for (const Bounds& box : boxes) middles.push_back(box.center());
    return order_by_place(middles);
  }

  static std::vector<Bounds> sort(const std::vector<Bounds>& boxes,
                                  const std::vector<std::uint32_t>& order) {
    std::vector<Bounds> sorted;
    sorted.reserve(order.size());
    for (const std::uint32_t i : order) sorted.push_back(boxes[i]);
    return sorted;
  }

  std::vector<Bounds> boxes_;
  std::vector<std::uint32_t> order_;  ///< boxes, near ones together
  BoxHierarchy hierarchy_;            ///< in that order
};

inline std::vector<Bounds> bound_triangles(const TriangleMesh& mesh) {
  std::vector<Bounds> boxes;
  boxes.reserve(mesh.triangles().size());
  for (std::size_t i = 0; i < mesh.triangles().size(); ++i)
    boxes.push_back(bound_triangle(mesh.corners(i)));
  return boxes;
}

}  // namespace voxshell
