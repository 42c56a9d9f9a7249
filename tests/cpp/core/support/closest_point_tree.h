#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "mesh/closest_point.h"
#include "voxshell/triangle_mesh.h"

namespace voxshell::test_support {

struct ClosestPoint {
  Vec3 point;
  double squared_distance;
  std::uint32_t triangle;
};

/// Answers closest-point queries on a mesh by a tree of bounding boxes, in double precision.
class ClosestPointTree {
 public:
  explicit ClosestPointTree(const TriangleMesh& mesh);

  /// The closest point of the mesh. `guess` is any triangle; a near one, such as the answer for a
  /// neighboring point, makes the search short and does not change the distance found.
  ClosestPoint find_closest(const Vec3& p, std::uint32_t guess = 0) const;

 private:
  static constexpr std::uint32_t kLeafTriangles = 4;
  static constexpr int kMaxDepth = 64;  ///< median splits of at most 2^32 triangles stay far below

  struct Node {
    Bounds bounds;
    std::uint32_t first;  ///< a leaf's first triangle in order_; an inner node's right child
    std::uint32_t count;  ///< a leaf's triangles; 0 for an inner node, whose left child is next
  };

  void build_node(std::uint32_t begin, std::uint32_t end, std::vector<Bounds>& triangle_bounds);

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_;          ///< triangle indices, leaf by leaf
  std::vector<std::array<Vec3, 3>> corners_;  ///< in the same order
  std::vector<std::uint32_t> place_;          ///< where order_ holds a triangle
};

inline ClosestPointTree::ClosestPointTree(const TriangleMesh& mesh) {
  const auto count = static_cast<std::uint32_t>(mesh.triangles().size());
  order_.resize(count);
  std::iota(order_.begin(), order_.end(), 0u);
  std::vector<Bounds> triangle_bounds(count);
  for (std::uint32_t i = 0; i < count; ++i) {
    for (const Vec3& corner : mesh.corners(i)) triangle_bounds[i].extend(corner);
  }
  build_node(0, count, triangle_bounds);
  corners_.reserve(count);
  for (const std::uint32_t triangle : order_) corners_.push_back(mesh.corners(triangle));
  place_.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) place_[order_[i]] = i;
}

inline void ClosestPointTree::build_node(std::uint32_t begin, std::uint32_t end,
                                         std::vector<Bounds>& triangle_bounds) {
  const std::size_t self = nodes_.size();
  nodes_.push_back({{}, begin, end - begin});
  Bounds centers;
  for (std::uint32_t i = begin; i < end; ++i) {
    nodes_[self].bounds.extend(triangle_bounds[order_[i]]);
    centers.extend(triangle_bounds[order_[i]].center());
  }
  if (end - begin <= kLeafTriangles) return;

  const int axis = centers.longest_axis();
  const std::uint32_t middle = begin + (end - begin) / 2;
  const auto before = [&](std::uint32_t a, std::uint32_t b) {
    const double ca = triangle_bounds[a].center()[axis];
    const double cb = triangle_bounds[b].center()[axis];
    return ca != cb ? ca < cb : a < b;
  };
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, before);
  nodes_[self].count = 0;
  build_node(begin, middle, triangle_bounds);
  nodes_[self].first = static_cast<std::uint32_t>(nodes_.size());
  build_node(middle, end, triangle_bounds);
}

inline ClosestPoint ClosestPointTree::find_closest(const Vec3& p, std::uint32_t guess) const {
  const Vec3 guessed = closest_point_on_triangle(p, corners_[place_[guess]]);
  ClosestPoint best{guessed, squared_length(p - guessed), guess};

  struct Waiting {
    std::uint32_t node;
    double squared_distance;
  };
  std::array<Waiting, kMaxDepth> stack;
  std::size_t waiting = 0;
  stack[waiting++] = {0, squared_distance(nodes_[0].bounds, p)};
  while (waiting > 0) {
    const Waiting next = stack[--waiting];
    if (next.squared_distance >= best.squared_distance) continue;
    const Node& node = nodes_[next.node];
    if (node.count > 0) {
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        const Vec3 candidate = closest_point_on_triangle(p, corners_[i]);
        const double squared = squared_length(p - candidate);
        if (squared < best.squared_distance) best = {candidate, squared, order_[i]};
      }
      continue;
    }
    Waiting near{next.node + 1, squared_distance(nodes_[next.node + 1].bounds, p)};
    Waiting far{node.first, squared_distance(nodes_[node.first].bounds, p)};
    if (far.squared_distance < near.squared_distance) std::swap(near, far);
    if (far.squared_distance < best.squared_distance) stack[waiting++] = far;
    if (near.squared_distance < best.squared_distance) stack[waiting++] = near;
  }
  return best;
}

}  // namespace voxshell::test_support
